#pragma once
// StereoSource: where stereo pairs come from (recorded data, the synthetic world, cameras). Thread-bound: one
// thread calls next(). Bad input is an Error that names file, line or frame; a lost pair is a gap in seq.

#include <cstdint>
#include <optional>
#include <string>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/base/time.h"
#include "core/geometry/stereo_calibration.h"

namespace pelorus {

// A captured pair, raw (as the calibration describes it: rectified already for KITTI and synthetic data).
struct SourcePair {
  std::uint64_t seq = 0;  // counts what the cameras captured; a missing pair leaves a gap
  Timestamp capture_time;
  Image left;
  Image right;
};

// Pairs that a recording lacks.
struct MissingPairs {
  std::uint64_t count = 0;
  Timestamp first;  // capture time of the first, exact where one of its images is there; when count > 0
};

class StereoSource {
 public:
  virtual ~StereoSource() = default;
  // Read from the data set itself, or given by the user.
  [[nodiscard]] virtual const StereoCalibration& calibration() const = 0;
  // Pairs still to come at opening, or 0 when unknown (live). For progress bars.
  [[nodiscard]] virtual std::size_t pair_count() const = 0;
  // Fills `pair` (its storage is reused) and returns true; false at the end of the data.
  [[nodiscard]] virtual Result<bool> next(SourcePair& pair) = 0;
  // Lacking before the last pair that next() gave; after the last of all, at the end of the recording too.
  [[nodiscard]] virtual MissingPairs missing_pairs() const { return {}; }
  // One line per fact a user must know: calibration origin, pairs dropped at opening and why.
  [[nodiscard]] virtual std::string description() const = 0;
};

// "1 pair", "2 pairs".
[[nodiscard]] inline std::string pairs_text(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " pair" : " pairs");
}

}  // namespace pelorus
