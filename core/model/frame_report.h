#pragma once
// What each stage did in one frame: outcomes, counts, microseconds. Replaces log lines on the per-frame path.

#include <array>
#include <cstddef>
#include <cstdint>

namespace pelorus {

// Ordinary outcomes of a stage (CONVENTIONS, errors): a value with a reason, never an exception or a log line.
enum class StageOutcome : std::uint8_t {
  not_run,
  ok,
  too_few_points,
  no_agreement,
  degenerate,
  not_converged,
  skipped
};
[[nodiscard]] const char* to_text(StageOutcome outcome);

// What a step leaves out when its time is short; each includes those before it.
enum class Shed : std::uint8_t { nothing, refill, object_window };

enum class Stage : std::uint8_t {
  front_end,
  partition,
  ego_motion,
  static_filters,
  static_window,
  objects,
  refill,
  count
};
inline constexpr std::size_t kStageCount = static_cast<std::size_t>(Stage::count);
[[nodiscard]] const char* to_text(Stage stage);

struct StageReport {
  StageOutcome outcome = StageOutcome::not_run;
  std::int32_t microseconds = 0;  // wall time; never part of a deterministic file
};

struct FrameReport {
  std::array<StageReport, kStageCount> stages{};
  std::int32_t step_microseconds = 0;
  std::int32_t points_tracked = 0;
  std::int32_t points_started = 0;
  std::int32_t points_static = 0;
  std::int32_t points_moving = 0;
  std::int32_t points_outlier = 0;
  std::int32_t births_refused = 0;  // bodies found while the table of kMaxObjects was full
  std::int32_t groups = 0;
  std::int32_t frames_missed = 0;  // gap in seq before this frame, bridged
  Shed shed = Shed::nothing;       // optional work left out for lack of time
  bool refilled = false;           // new points were looked for
  double sigma_px = 0;             // learned pixel deviation

  StageReport& operator[](Stage stage) { return stages[static_cast<std::size_t>(stage)]; }
  const StageReport& operator[](Stage stage) const { return stages[static_cast<std::size_t>(stage)]; }
};

}  // namespace pelorus
