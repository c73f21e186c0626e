#pragma once
// A run's trajectories as text: TUM (`timestamp_s tx ty tz qx qy qz qw`), KITTI (the top three rows of T_world_cam),
// and one CSV table of camera and bodies. Frames without a pose have no line: nothing is repeated or made up. Pure.

#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/records.h"

namespace pelorus {

struct TimedPose {
  Timestamp time;
  Rigid3 T_world_x;  // of the camera or of a body
};

// The camera's, or those of one body.
[[nodiscard]] std::vector<TimedPose> poses_of(const EstimatedRun& run, const std::optional<BodyId>& body);

[[nodiscard]] std::string tum_text(const std::vector<TimedPose>& poses);
[[nodiscard]] std::string kitti_text(const std::vector<TimedPose>& poses);
// Seconds since the first pose, one line each, as KITTI's times.txt: its poses carry no time.
[[nodiscard]] std::string kitti_times_text(const std::vector<TimedPose>& poses);
[[nodiscard]] std::string csv_text(const EstimatedRun& run);

}  // namespace pelorus
