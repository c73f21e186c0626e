#pragma once
// The parts of page_data that the replay and the views from above and from the side draw. Pure.

#include <string>
#include <vector>

#include "firmware-host/pelorus/report/page_data.h"

namespace pelorus {

// The frames of the run that the page replays: every stride-th.
struct ShownFrames {
  std::size_t stride = 1;
  std::vector<std::size_t> frames;  // indices in the run
};
[[nodiscard]] ShownFrames shown_frames(const EstimatedRun& run, const PageBudget& budget);

[[nodiscard]] std::string frames_json(const ReportInput& input, const ShownFrames& shown);
// Objects that were ever confirmed.
[[nodiscard]] std::string objects_json(const ReportInput& input, const ShownFrames& shown, const PageBudget& budget);
// The true path of each moving body that an object was matched with: of the point that the object's origin is.
[[nodiscard]] std::string true_bodies_json(const ReportInput& input, const ShownFrames& shown);
[[nodiscard]] std::string static_points_json(const ReportInput& input, const PageBudget& budget);

}  // namespace pelorus
