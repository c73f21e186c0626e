#pragma once
// Rectifier: from a calibrated pair to rows that match: one focal length, right camera at +baseline_m along x.
// Bouguet's split (half of the relative rotation to each camera, then the least turn that lays the baseline along
// x; cf. Fusiello, Trucco, Verri 2000), distortion removed by table. Raw pixels in, rectified pixels out.
// A pair that is rectified already passes through with its intrinsics unchanged, bit for bit.
// Building costs two projections a pixel; apply_* is bilinear, may run on two threads, and allocates only when
// the output's size changes.

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/geometry/remap_table.h"
#include "core/geometry/stereo_calibration.h"
#include "core/geometry/stereo_rig.h"

namespace pelorus {

struct RectifierConfig {
  // 0: the largest view without black borders; 1: every raw pixel is kept, with black borders.
  double alpha = 0.0;
  // A flat image cannot follow a fisheye: directions further from the axis are cut off.
  double max_half_view_deg = 60.0;
};

class Rectifier {
 public:
  // Errors: what check_calibration refuses, an unknown image size, cameras without a common view.
  [[nodiscard]] static Result<Rectifier> create(const StereoCalibration& calibration, const std::string& place,
                                                const RectifierConfig& config = {});

  void apply_left(const ImageView& raw, Image& out) const;
  void apply_right(const ImageView& raw, Image& out) const;

  [[nodiscard]] const StereoRig& rig() const { return rig_; }
  [[nodiscard]] bool is_pass_through() const { return pass_through_; }
  // Rectified left camera from raw left camera, and the same on the right: pure rotations.
  [[nodiscard]] const Eigen::Matrix3d& R_cam_left() const { return R_cam_left_; }
  [[nodiscard]] const Eigen::Matrix3d& R_cam_r_right() const { return R_cam_r_right_; }
  // Body from rectified left camera, for truth and navigation given in the body frame.
  [[nodiscard]] const Rigid3& T_body_cam() const { return T_body_cam_; }
  // Empty when is_pass_through().
  [[nodiscard]] const RemapTable& left_table() const { return left_table_; }
  [[nodiscard]] const RemapTable& right_table() const { return right_table_; }

 private:
  Rectifier() = default;

  StereoRig rig_;
  Eigen::Matrix3d R_cam_left_ = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d R_cam_r_right_ = Eigen::Matrix3d::Identity();
  Rigid3 T_body_cam_ = Rigid3::Identity();
  bool pass_through_ = false;
  RemapTable left_table_;
  RemapTable right_table_;
};

}  // namespace pelorus
