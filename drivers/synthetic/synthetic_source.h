#pragma once
// The synthetic dive as a stereo source with exact truth. World: left camera of frame 0. Objects: the scene's moving
// bodies, in the order of the scene, counted from 0 here. Already rectified. Thread-bound.

#include <cstddef>
#include <string>
#include <vector>

#include "drivers/stereo_source.h"
#include "drivers/synthetic/renderer.h"
#include "drivers/synthetic/scene.h"

namespace pelorus::synthetic {

class SyntheticSource final : public StereoSource {
 public:
  // threads 0: as many as the hardware has.
  explicit SyntheticSource(Scene scene, int threads = 0);

  [[nodiscard]] const StereoCalibration& calibration() const override { return calibration_; }
  [[nodiscard]] std::size_t pair_count() const override { return static_cast<std::size_t>(scene_.frames); }
  [[nodiscard]] Result<bool> next(SourcePair& pair) override;
  [[nodiscard]] std::string description() const override;

  // Any frame at any time; does not move next().
  void render(int frame, SourcePair& pair);

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] Timestamp capture_time(int frame) const;
  [[nodiscard]] int object_count() const { return static_cast<int>(moving_.size()); }
  [[nodiscard]] const Body& object_body(int object) const;
  [[nodiscard]] Rigid3 T_world_cam(int frame) const;
  // Origin at the body's centre, axes along its edges.
  [[nodiscard]] Rigid3 T_world_obj(int object, int frame) const;
  // Pixels of the left image that show the object, in the frame rendered last.
  [[nodiscard]] int visible_px(int object) const;
  [[nodiscard]] const Film& left_film() const { return renderer_.left_film(); }

 private:
  Scene scene_;
  Renderer renderer_;
  StereoCalibration calibration_;
  std::vector<std::size_t> moving_;  // indices of the bodies that move
  int next_frame_ = 0;
};

}  // namespace pelorus::synthetic
