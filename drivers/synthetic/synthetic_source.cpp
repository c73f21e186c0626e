#include "drivers/synthetic/synthetic_source.h"

#include <cmath>

namespace pelorus::synthetic {
namespace {

constexpr std::int64_t kFirstCaptureNs = 1'600'000'000'000'000'000;

CameraIntrinsics intrinsics(const SceneCamera& camera) {
  CameraIntrinsics k;
  k.width = camera.width_px;
  k.height = camera.height_px;
  k.fx_px = camera.f_px;
  k.fy_px = camera.f_px;
  k.cx_px = camera.cx_px();
  k.cy_px = camera.cy_px();
  return k;
}

}  // namespace

SyntheticSource::SyntheticSource(Scene scene, int threads) : scene_(std::move(scene)), renderer_(scene_, threads) {
  calibration_.left = intrinsics(scene_.camera);
  calibration_.right = calibration_.left;
  calibration_.T_right_left.translation() = Eigen::Vector3d(-scene_.camera.baseline_m, 0, 0);
  calibration_.T_body_left = scene_.camera.T_body_cam();
  calibration_.body_known = true;
  calibration_.rectified = true;
  for (std::size_t k = 0; k < scene_.bodies.size(); ++k)
    if (!scene_.bodies[k].path.stands_still()) moving_.push_back(k);
}

Result<bool> SyntheticSource::next(SourcePair& pair) {
  if (next_frame_ >= scene_.frames) return false;
  render(next_frame_++, pair);
  return true;
}

std::string SyntheticSource::description() const {
  return "synthetic scene '" + scene_.name + "', seed " + std::to_string(scene_.seed) + ", " +
         pairs_text(static_cast<std::size_t>(scene_.frames)) + ", " + std::to_string(object_count()) + " moving bodies";
}

void SyntheticSource::render(int frame, SourcePair& pair) {
  pair.seq = static_cast<std::uint64_t>(frame);
  pair.capture_time = capture_time(frame);
  renderer_.render(frame, pair.left, pair.right);
}

Timestamp SyntheticSource::capture_time(int frame) const {
  return Timestamp{kFirstCaptureNs + std::llround(scene_.time_s(frame) * 1e9)};
}

const Body& SyntheticSource::object_body(int object) const {
  return scene_.bodies[moving_[static_cast<std::size_t>(object)]];
}

Rigid3 SyntheticSource::T_world_cam(int frame) const { return scene_.T_sea_cam(0).inverse() * scene_.T_sea_cam(frame); }

Rigid3 SyntheticSource::T_world_obj(int object, int frame) const {
  return scene_.T_sea_cam(0).inverse() * object_body(object).path.T_sea_b(scene_.time_s(frame));
}

int SyntheticSource::visible_px(int object) const {
  return renderer_.visible_px()[moving_[static_cast<std::size_t>(object)]];
}

}  // namespace pelorus::synthetic
