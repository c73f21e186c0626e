#pragma once
// `pelorus can dump`: what the frames of a bus or of a candump log say. Each frame by the contract's table, whole sets
// by the autopilot's own receiver, so that what is shown is what the autopilot sees. Thread-bound.

#include <cstdint>
#include <cstdio>
#include <string>

#include "core/base/result.h"
#include "firmware-host/autopilot/pelorus_can.h"
#include "services/can/can_codec.h"

namespace pelorus {

struct CanDumpOptions {
  std::string source;  // interface, candump log, or - for a log on standard input
  std::uint32_t base_id = kCanDefaultBaseId;
  bool sets = false;        // one line per set in place of one per frame
  bool json = false;        // one JSON object per line
  double seconds = 0;       // live: end after so long; 0 = at Ctrl-C
  std::uint64_t count = 0;  // end after so many lines; 0 = no limit
};

struct CanDumpCounts {
  std::uint64_t frames = 0;   // of the contract and right
  std::uint64_t foreign = 0;  // other identifiers
  std::uint64_t bad = 0;      // wrong length or CRC
  std::uint64_t error_frames = 0;
  std::uint64_t bad_lines = 0;  // of the log
};

// Prints frames or sets as they come.
class CanDump {
 public:
  CanDump(const CanDumpOptions& options, std::FILE* out);

  void take(const CanFrame& frame);
  [[nodiscard]] const CanDumpCounts& counts() const { return counts_; }
  [[nodiscard]] std::uint64_t lines() const { return lines_; }
  [[nodiscard]] std::string summary() const;
  void note_bad_line() { ++counts_.bad_lines; }

 private:
  void print(const std::string& line);
  void feed(pelorus_can_receiver& receiver, const CanFrame& frame);

  CanDumpOptions options_;
  std::FILE* out_;
  pelorus_can_receiver classic_{};
  pelorus_can_receiver fd_{};
  CanDumpCounts counts_;
  std::uint64_t lines_ = 0;
};

// One frame in words or as JSON; names and units of the contract, SI.
[[nodiscard]] std::string frame_text(const CanFrame& frame, std::uint32_t base_id, bool json);
// One set as the receiver handed it out.
[[nodiscard]] std::string set_text(const pelorus_can_estimate& estimate, pelorus_can_link link, bool json);

// Reads the source to its end, Ctrl-C or a limit; prints to standard output, the summary to standard error. Returns 0,
// or 3 when a log had lines that are none. Errors: device (no interface), io (no file), bad_input (no frame in a log,
// or none whole).
[[nodiscard]] Result<int> run_can_dump(const CanDumpOptions& options);

}  // namespace pelorus
