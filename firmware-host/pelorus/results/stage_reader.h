#pragma once
// read_stages: what each stage did (frames.csv) and how long it took (timing.csv), frame by frame, for the report.
// A run without these files has none. Errors name file and line. Thread-bound.

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/base/result.h"
#include "core/base/time.h"
#include "core/model/frame_report.h"

namespace pelorus {

inline constexpr std::size_t kOutcomeCount = static_cast<std::size_t>(StageOutcome::skipped) + 1;

struct PointCounts {
  Timestamp capture_time;
  int tracked = 0;
  int fixed = 0;
  int moving = 0;
  int outlier = 0;
};

struct StageRecord {
  std::array<std::array<std::int64_t, kOutcomeCount>, kStageCount> outcomes{};  // frames per stage and outcome
  std::vector<PointCounts> points;                                              // one per frame
  std::array<std::vector<double>, kStageCount> stage_ms;                        // one per frame
  std::vector<double> latency_ms;  // rectification and step: from the pair in memory to the result
};

[[nodiscard]] Result<StageRecord> read_stages(const std::filesystem::path& folder);

}  // namespace pelorus
