#include "drivers/synthetic/pose_path.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "drivers/synthetic/seeded_hash.h"

namespace pelorus::synthetic {
namespace {

// Control point i, continued straight beyond both ends: the spline then meets its first and last point exactly.
Eigen::Vector3d control_point(const std::vector<Eigen::Vector3d>& points, std::ptrdiff_t i) {
  const auto last = static_cast<std::ptrdiff_t>(points.size()) - 1;
  if (last == 0) return points.front();
  const auto at = [&](std::ptrdiff_t k) { return points[static_cast<std::size_t>(k)]; };
  if (i < 0) return at(0) + static_cast<double>(i) * (at(1) - at(0));
  if (i > last) return at(last) + static_cast<double>(i - last) * (at(last) - at(last - 1));
  return at(i);
}

Eigen::Vector3d spline(const std::vector<Eigen::Vector3d>& points, double steps) {
  const double floor_steps = std::floor(steps);
  const auto i = static_cast<std::ptrdiff_t>(floor_steps);
  const double s = steps - floor_steps;
  const double r = 1.0 - s;
  const double w0 = r * r * r / 6.0;
  const double w1 = (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0;
  const double w3 = s * s * s / 6.0;
  // Differences to one point keep a standstill exact: equal points give exactly that point.
  const Eigen::Vector3d p2 = control_point(points, i + 1);
  return p2 + w0 * (control_point(points, i - 1) - p2) + w1 * (control_point(points, i) - p2) +
         w3 * (control_point(points, i + 2) - p2);
}

// Two incommensurate waves per coordinate, phases from the seed.
double wave(SeededHash& phases, double t_s, double period_s) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const double slow = std::sin(kTurn * (t_s / period_s + phases.uniform()));
  const double fast = std::sin(kTurn * (t_s * 2.618 / period_s + phases.uniform()));
  return 0.8 * slow + 0.2 * fast;
}

}  // namespace

Rigid3 PosePath::T_sea_b(double t_s) const {
  Eigen::Vector3d p = spline(p_sea, t_s / step_s);
  Eigen::Vector3d rpy = spline(rpy_rad, t_s / step_s);
  if (sway.amplitude_m > 0 || sway.amplitude_rad > 0) {
    SeededHash phases(sway_seed, Purpose::sway, 0);
    for (int axis = 0; axis < 3; ++axis) {
      p[axis] += sway.amplitude_m * wave(phases, t_s, sway.period_s);
      rpy[axis] += sway.amplitude_rad * wave(phases, t_s, sway.period_s);
    }
  }
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  Rigid3 T = Rigid3::Identity();
  T.linear() = (AngleAxisd(rpy.z(), Vector3d::UnitZ()) * AngleAxisd(rpy.y(), Vector3d::UnitY()) *
                AngleAxisd(rpy.x(), Vector3d::UnitX()))
                   .toRotationMatrix();
  T.translation() = p;
  return T;
}

double PosePath::duration_s() const { return step_s * static_cast<double>(p_sea.size() - 1); }

bool PosePath::stands_still() const {
  return p_sea.size() == 1 && rpy_rad.size() == 1 && sway.amplitude_m <= 0 && sway.amplitude_rad <= 0;
}

}  // namespace pelorus::synthetic
