#include "firmware-host/pelorus/eval/truth_doubt.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace pelorus {
namespace {

// A run that fits its truth this badly has failed, or is another's: on KITTI the camera is off by some percent of its
// path. Below the length, noise of a truth that rests would speak.
constexpr double kLargestShareOfPath = 0.1;
constexpr double kSmallestDoubted_m = 0.05;

std::string off_the_path(const TrajectoryError& camera) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(),
                "the camera is off by %.2f m on average, on a true path of %.2f m: the run failed, or is not one of "
                "this data set",
                camera.absolute_m.mean, camera.path_length_m);
  return text.data();
}

}  // namespace

std::optional<std::string> truth_doubt(const Evaluation& evaluation) {
  if (!evaluation.camera) return std::nullopt;
  const TrajectoryError& camera = *evaluation.camera;
  const std::size_t poses = evaluation.facts.frames_with_pose;
  if (2 * camera.poses < poses) {
    return "only " + std::to_string(camera.poses) + " of " + std::to_string(poses) +
           " poses have truth of the same time: the truth ends early, or the run is not one of this data set";
  }
  if (camera.absolute_m.mean > std::max(kSmallestDoubted_m, kLargestShareOfPath * camera.path_length_m)) {
    return off_the_path(camera);
  }
  return std::nullopt;
}

std::size_t frames_with_truth(const Truth& truth) {
  return static_cast<std::size_t>(std::count_if(truth.frames.begin(), truth.frames.end(),
                                                [](const TrueFrame& frame) { return frame.T_truth_cam.has_value(); }));
}

}  // namespace pelorus
