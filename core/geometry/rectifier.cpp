#include "core/geometry/rectifier.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace pelorus {
namespace {

constexpr double kSame_px = 1e-6;   // intrinsics that differ by less are printed copies of one number
constexpr double kSame_rad = 1e-6;  // turns a point by under a thousandth of a pixel
constexpr int kEdgeSamples = 128;

// Rectangle on the unit plane of the rectified cameras.
struct PlaneBox {
  double x0 = 0, x1 = 0, y0 = 0, y1 = 0;
};

bool undistorted(const CameraIntrinsics& camera) {
  return camera.lens != LensKind::equidistant &&
         std::all_of(camera.distortion.begin(), camera.distortion.end(), [](double k) { return k == 0; });
}

// Rows match already and both cameras share one square-pixel intrinsics: nothing to compute.
bool needs_nothing(const StereoCalibration& c) {
  const auto same = [](double a, double b) { return std::abs(a - b) < kSame_px; };
  const bool square = same(c.left.fx_px, c.left.fy_px);
  const bool equal = same(c.left.fx_px, c.right.fx_px) && same(c.left.fy_px, c.right.fy_px) &&
                     same(c.left.cx_px, c.right.cx_px) && same(c.left.cy_px, c.right.cy_px);
  if (!square || !equal || !undistorted(c.left) || !undistorted(c.right)) return false;
  const Eigen::Vector3d t = c.T_right_left.translation();
  return rotation_angle_rad(c.T_right_left.linear()) < kSame_rad && t.tail<2>().norm() < kSame_rad * t.norm();
}

// Least rotation that turns unit vector `from` onto x.
Eigen::Matrix3d turn_onto_x(const Eigen::Vector3d& from) {
  return Eigen::Quaterniond::FromTwoVectors(from, Eigen::Vector3d::UnitX()).toRotationMatrix();
}

// Where a raw pixel lands on the rectified unit plane, cut at the limit.
Eigen::Vector2d onto_plane(const LensModel& lens, const Eigen::Matrix3d& R_cam_raw, const Eigen::Vector2d& raw_px,
                           double limit) {
  Eigen::Vector3d v_raw;
  if (!lens.unproject(raw_px, v_raw)) {
    // Beyond the model's range: outward from the centre, far enough to be cut.
    v_raw << raw_px.x() - lens.camera().cx_px, raw_px.y() - lens.camera().cy_px, 0;
    v_raw.normalize();
  }
  const Eigen::Vector3d v_cam = R_cam_raw * v_raw;
  const double z = std::max(v_cam.z(), 1e-3);
  return (v_cam.head<2>() / z).cwiseMax(-limit).cwiseMin(limit);
}

// Largest box inside the image's outline on the plane, and the least box around it.
void outline_boxes(const LensModel& lens, const Eigen::Matrix3d& R_cam_raw, double limit, PlaneBox& inner,
                   PlaneBox& outer) {
  const double w = lens.camera().width - 1;
  const double h = lens.camera().height - 1;
  inner = {-limit, limit, -limit, limit};
  outer = {limit, -limit, limit, -limit};
  for (int i = 0; i <= kEdgeSamples; ++i) {
    const double s = static_cast<double>(i) / kEdgeSamples;
    const Eigen::Vector2d left = onto_plane(lens, R_cam_raw, {0, s * h}, limit);
    const Eigen::Vector2d right = onto_plane(lens, R_cam_raw, {w, s * h}, limit);
    const Eigen::Vector2d top = onto_plane(lens, R_cam_raw, {s * w, 0}, limit);
    const Eigen::Vector2d bottom = onto_plane(lens, R_cam_raw, {s * w, h}, limit);
    inner.x0 = std::max(inner.x0, left.x());
    inner.x1 = std::min(inner.x1, right.x());
    inner.y0 = std::max(inner.y0, top.y());
    inner.y1 = std::min(inner.y1, bottom.y());
    outer.x0 = std::min(outer.x0, left.x());
    outer.x1 = std::max(outer.x1, right.x());
    outer.y0 = std::min(outer.y0, top.y());
    outer.y1 = std::max(outer.y1, bottom.y());
  }
}

PlaneBox blend(const PlaneBox& a, const PlaneBox& b, double share_b) {
  const auto mix = [share_b](double p, double q) { return p + share_b * (q - p); };
  return {mix(a.x0, b.x0), mix(a.x1, b.x1), mix(a.y0, b.y0), mix(a.y1, b.y1)};
}

// The view both cameras are drawn with: what both see (alpha 0) up to what either sees (alpha 1).
PlaneBox common_view(const LensModel lens[2], const Eigen::Matrix3d R_cam_raw[2], const RectifierConfig& config) {
  const double limit = std::tan(config.max_half_view_deg * std::numbers::pi / 180.0);
  PlaneBox in[2];
  PlaneBox out[2];
  for (int k = 0; k < 2; ++k) outline_boxes(lens[k], R_cam_raw[k], limit, in[k], out[k]);
  const PlaneBox inner{std::max(in[0].x0, in[1].x0), std::min(in[0].x1, in[1].x1), std::max(in[0].y0, in[1].y0),
                       std::min(in[0].y1, in[1].y1)};
  const PlaneBox outer{std::min(out[0].x0, out[1].x0), std::max(out[0].x1, out[1].x1), std::min(out[0].y0, out[1].y0),
                       std::max(out[0].y1, out[1].y1)};
  return blend(inner, outer, std::clamp(config.alpha, 0.0, 1.0));
}

RemapTable build_table(const LensModel& lens, const Eigen::Matrix3d& R_cam_raw, const StereoRig& rig) {
  RemapTable table(rig.width, rig.height, lens.camera().width, lens.camera().height);
  const Eigen::Matrix3d R_raw_cam = R_cam_raw.transpose();
  for (int v = 0; v < rig.height; ++v) {
    for (int u = 0; u < rig.width; ++u) {
      const Eigen::Vector3d v_cam((u - rig.cx_px) / rig.f_px, (v - rig.cy_px) / rig.f_px, 1.0);
      Eigen::Vector2d raw_px;
      if (lens.project(R_raw_cam * v_cam, raw_px)) table.set(u, v, raw_px);
    }
  }
  table.finish();
  return table;
}

}  // namespace

Result<Rectifier> Rectifier::create(const StereoCalibration& c, const std::string& place,
                                    const RectifierConfig& config) {
  if (auto checked = check_calibration(c, place); !checked) return checked.error();
  if (c.left.width < 2 || c.left.height < 2)
    return Error{ErrorCode::bad_calibration, place, "the image size is not known", "write it into the calibration"};
  Rectifier out;
  out.rig_ = {c.left.width, c.left.height, c.left.fx_px,
              c.left.cx_px, c.left.cy_px,  c.T_right_left.translation().norm()};
  out.T_body_cam_ = c.T_body_left;
  out.pass_through_ = needs_nothing(c);
  if (out.pass_through_) return out;

  // Half of the relative rotation to each camera brings both into one orientation `mid`.
  const Eigen::Matrix3d R_half = so3_exp(0.5 * so3_log(c.T_right_left.linear()));
  const Eigen::Vector3d baseline_mid = -(R_half.transpose() * c.T_right_left.translation());
  const Eigen::Matrix3d R_cam_mid = turn_onto_x(baseline_mid.normalized());
  out.R_cam_left_ = R_cam_mid * R_half;
  out.R_cam_r_right_ = R_cam_mid * R_half.transpose();
  out.T_body_cam_.linear() = c.T_body_left.linear() * out.R_cam_left_.transpose();

  const LensModel lens[2] = {LensModel(c.left), LensModel(c.right)};
  const Eigen::Matrix3d R_cam_raw[2] = {out.R_cam_left_, out.R_cam_r_right_};
  const PlaneBox view = common_view(lens, R_cam_raw, config);
  if (!(view.x1 - view.x0 > 1e-2 && view.y1 - view.y0 > 1e-2))
    return Error{ErrorCode::bad_calibration, place, "the two cameras have no common view",
                 "check the rotation between the cameras and the distortion coefficients"};
  const double w = out.rig_.width - 1;
  const double h = out.rig_.height - 1;
  const double f_across = w / (view.x1 - view.x0);
  const double f_down = h / (view.y1 - view.y0);
  // Alpha 0 fills the image (the larger focal length), alpha 1 keeps everything (the smaller one).
  const double f_fill = std::max(f_across, f_down);
  out.rig_.f_px = f_fill + std::clamp(config.alpha, 0.0, 1.0) * (std::min(f_across, f_down) - f_fill);
  out.rig_.cx_px = 0.5 * (w - out.rig_.f_px * (view.x0 + view.x1));
  out.rig_.cy_px = 0.5 * (h - out.rig_.f_px * (view.y0 + view.y1));
  out.left_table_ = build_table(lens[0], out.R_cam_left_, out.rig_);
  out.right_table_ = build_table(lens[1], out.R_cam_r_right_, out.rig_);
  return out;
}

void Rectifier::apply_left(const ImageView& raw, Image& out) const {
  pass_through_ ? out.assign(raw) : left_table_.apply(raw, out);
}

void Rectifier::apply_right(const ImageView& raw, Image& out) const {
  pass_through_ ? out.assign(raw) : right_table_.apply(raw, out);
}

}  // namespace pelorus
