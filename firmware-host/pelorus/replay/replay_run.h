#pragma once
// run_replay: recorded (or rendered) pairs -> rectification -> Pipeline::step -> files and pictures, in the calling
// thread. The one loop behind `pelorus replay`, `ablate` and `demo`. Reads clocks only to measure and, in real-time
// mode, to feed; stepped mode gives the same bytes every time. Thread-bound.

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/model/stage_data.h"
#include "core/pipeline/config.h"
#include "drivers/stereo_source.h"
#include "firmware-host/pelorus/results/lost_pairs.h"

namespace pelorus {

struct ReplayOptions {
  PipelineConfig pipeline;
  std::filesystem::path out_folder;        // made by prepare_output_folder
  std::uint64_t max_frames = 0;            // pairs taken from the source; 0 = all
  bool threads = true;                     // share a step among threads; off: the same bytes, later
  bool realtime = false;                   // feed at the recorded times; the newest pair wins, the others are counted
  int overlay_every = 0;                   // annotated picture of every n-th frame; 0 = none
  std::function<void(const Error&)> warn;  // told of each pair that cannot be read and is bridged; may be empty
  std::function<bool()> stop;              // asked before each pair; may be empty
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;  // total 0 = unknown; may be empty
};

struct ReplaySummary {
  std::uint64_t frames = 0;               // steps made
  LostPairs lost;                         // pairs of the recording that were not stepped
  Timestamp first_missing;                // capture time, when lost.missing > 0
  std::uint64_t without_pose = 0;         // frames that camera.tum lacks
  std::array<std::uint64_t, 7> states{};  // frames per VisionState
  int resets = 0;                         // reset_counter of the last frame
  int objects_confirmed = 0;              // different ids that were ever confirmed
  double median_step_ms = 0;
  double p99_step_ms = 0;
  bool interrupted = false;  // stop() said so
  bool ended_early = false;  // by the failure below
  bool broke_off = false;    // ended_early, because the source gave nothing more that can be used
  // Why the run ended early, or else the first pair that could not be read; files hold everything that could.
  std::optional<Error> failure;
};

// Of a recording that broke off: more pairs in a row cannot be read than are bridged. What was processed is good.
inline constexpr int kBrokeOffExitCode = 8;

// What ReplayOptions::warn has to say of a pair.
[[nodiscard]] std::string skipped_text(const Error& error);
// The run went to its end without some of the pairs.
[[nodiscard]] bool is_incomplete(const ReplaySummary& summary);
// The line for people about such a run.
[[nodiscard]] std::string incomplete_text(const ReplaySummary& summary);

// An Error here means that nothing could be started (calibration, output); later failures are in the summary.
[[nodiscard]] Result<ReplaySummary> run_replay(StereoSource& source, const ReplayOptions& options);

// The lines that end a run, for people.
[[nodiscard]] std::string to_text(const ReplaySummary& summary);

}  // namespace pelorus
