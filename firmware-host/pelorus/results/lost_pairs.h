#pragma once
// lost_pairs.csv: which of the recording's pairs are not in a run's results, so that every verb tells the numbers that
// `replay` told. The gaps in frames.csv are no substitute: they do not tell a damaged pair from one that was never
// recorded, and a pair lost at an end of the recording leaves none. Thread-bound.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/base/result.h"

namespace pelorus {

struct LostPairs {
  std::uint64_t missing = 0;     // the recording lacks them
  std::uint64_t unreadable = 0;  // damaged
  std::uint64_t dropped = 0;     // real-time mode: skipped because the step was late
};

// "1 missing in the recording, 2 unreadable, 0 dropped".
[[nodiscard]] std::string to_text(const LostPairs& lost);

[[nodiscard]] Result<> write_lost_pairs(const std::filesystem::path& folder, const LostPairs& lost);
// Absent for a run that was killed, or that is not ours.
[[nodiscard]] Result<std::optional<LostPairs>> read_lost_pairs(const std::filesystem::path& folder);

}  // namespace pelorus
