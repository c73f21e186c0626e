#pragma once
// The parts of page_data that are curves, bars and counts over time. A curve longer than the budget is cut into equal
// pieces of which the worst (errors) or the mean (counts) is shown. Pure.

#include <string>

#include "firmware-host/pelorus/report/page_data.h"

namespace pelorus {

// Runs of frames of the same state.
[[nodiscard]] std::string states_json(const EstimatedRun& run);
[[nodiscard]] std::string errors_json(const ReportInput& input, const PageBudget& budget);
[[nodiscard]] std::string point_counts_json(const ReportInput& input, const PageBudget& budget);
[[nodiscard]] std::string stages_json(const StageRecord& stages);
[[nodiscard]] std::string latency_json(const StageRecord& stages);
[[nodiscard]] std::string pictures_json(const ReportInput& input, const PageBudget& budget);

}  // namespace pelorus
