#include "core/geometry/lens_model.h"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace pelorus {
namespace {

constexpr double kPlaneLimit = 11.4;   // tan(85 deg): no pinhole image is wider
constexpr int kLimitSteps = 4000;      // resolution of the search for the fold of the radial polynomial
constexpr int kBisectionSteps = 60;    // below double precision over either range
constexpr int kNewtonSteps = 10;       // the tangential part is small: converges in 3 to 4
constexpr double kNewtonDone = 1e-13;  // unit plane; 1e-10 px
constexpr double kDifferenceStep = 1e-6;

bool is_angular(LensKind lens) { return lens == LensKind::equidistant; }

}  // namespace

LensModel::LensModel(const CameraIntrinsics& camera) : camera_(camera) {
  const double range = is_angular(camera.lens) ? std::numbers::pi : kPlaneLimit;
  s_limit_ = range;
  double previous = 0;
  for (int i = 1; i <= kLimitSteps; ++i) {
    const double s = range * i / kLimitSteps;
    const double current = distorted_radius(s);
    if (!(current > previous)) {
      s_limit_ = range * (i - 1) / kLimitSteps;
      break;
    }
    previous = current;
  }
}

double LensModel::distorted_radius(double s) const {
  const auto& k = camera_.distortion;
  const double s2 = s * s;
  switch (camera_.lens) {
    case LensKind::none:
      return s;
    case LensKind::radtan:
      return s * (1 + s2 * (k[0] + s2 * (k[1] + s2 * k[4])));
    case LensKind::rational:
      return s * (1 + s2 * (k[0] + s2 * (k[1] + s2 * k[4]))) / (1 + s2 * (k[5] + s2 * (k[6] + s2 * k[7])));
    case LensKind::equidistant:
      return s * (1 + s2 * (k[0] + s2 * (k[1] + s2 * (k[2] + s2 * k[3]))));
  }
  return s;
}

Eigen::Vector2d LensModel::distort(const Eigen::Vector2d& x) const {
  const double r = x.norm();
  Eigen::Vector2d out = r > 1e-12 ? Eigen::Vector2d(x * (distorted_radius(r) / r)) : x;
  if (camera_.lens == LensKind::radtan || camera_.lens == LensKind::rational) {
    const double p1 = camera_.distortion[2];
    const double p2 = camera_.distortion[3];
    const double xy2 = 2 * x.x() * x.y();
    out.x() += p1 * xy2 + p2 * (r * r + 2 * x.x() * x.x());
    out.y() += p1 * (r * r + 2 * x.y() * x.y()) + p2 * xy2;
  }
  return out;
}

// Bisection cannot leave the growing range, unlike the usual fixed-point iteration on strong lenses.
double LensModel::undistorted_radius(double s_distorted) const {
  double low = 0;
  double high = s_limit_;
  for (int i = 0; i < kBisectionSteps; ++i) {
    const double middle = 0.5 * (low + high);
    (distorted_radius(middle) < s_distorted ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

bool LensModel::project(const Eigen::Vector3d& p_raw, Eigen::Vector2d& raw_px) const {
  Eigen::Vector2d d;
  if (is_angular(camera_.lens)) {
    const double rho = p_raw.head<2>().norm();
    const double theta_rad = std::atan2(rho, p_raw.z());
    if (!(theta_rad <= s_limit_)) return false;
    d = rho > 1e-12 ? Eigen::Vector2d(p_raw.head<2>() * (distorted_radius(theta_rad) / rho)) : Eigen::Vector2d::Zero();
  } else {
    if (!(p_raw.z() > 0)) return false;
    const Eigen::Vector2d x = p_raw.head<2>() / p_raw.z();
    if (!(x.norm() <= s_limit_)) return false;
    d = distort(x);
  }
  raw_px = {camera_.fx_px * d.x() + camera_.cx_px, camera_.fy_px * d.y() + camera_.cy_px};
  return true;
}

bool LensModel::unproject(const Eigen::Vector2d& raw_px, Eigen::Vector3d& v_raw) const {
  const Eigen::Vector2d d((raw_px.x() - camera_.cx_px) / camera_.fx_px, (raw_px.y() - camera_.cy_px) / camera_.fy_px);
  const double radius = d.norm();
  if (!(radius <= distorted_radius(s_limit_))) return false;
  const double s = undistorted_radius(radius);
  const Eigen::Vector2d axis = radius > 1e-12 ? Eigen::Vector2d(d / radius) : Eigen::Vector2d::Zero();
  if (is_angular(camera_.lens)) {
    v_raw << axis * std::sin(s), std::cos(s);
    return true;
  }
  // The radial part is exact; Newton with differences instead of a derivative adds the tangential part.
  Eigen::Vector2d x = axis * s;
  for (int i = 0; i < kNewtonSteps; ++i) {
    const Eigen::Vector2d residual = distort(x) - d;
    if (residual.norm() < kNewtonDone) break;
    Eigen::Matrix2d J;
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector2d step = Eigen::Vector2d::Unit(k) * kDifferenceStep;
      J.col(k) = (distort(x + step) - distort(x - step)) / (2 * kDifferenceStep);
    }
    x -= J.inverse() * residual;
  }
  if (!x.allFinite() || (distort(x) - d).norm() > 1e-9) return false;
  v_raw = Eigen::Vector3d(x.x(), x.y(), 1).normalized();
  return true;
}

}  // namespace pelorus
