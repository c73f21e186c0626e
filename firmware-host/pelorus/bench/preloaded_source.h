#pragma once
// PreloadedSource: the first pairs of a recording held in memory and shown there and back again, for as long as one
// likes: what is timed is the service, not the decoding of files. Thread rule of StereoSource.

#include <memory>
#include <vector>

#include "drivers/stereo_source.h"

namespace pelorus {

struct PreloadedPairs {
  StereoCalibration calibration;
  std::string description;
  std::vector<SourcePair> pairs;

  [[nodiscard]] std::size_t bytes() const;
};

// Errors: those of the source; bad_input for fewer than three pairs.
[[nodiscard]] Result<std::shared_ptr<const PreloadedPairs>> preload(StereoSource& source, std::size_t count);

class PreloadedSource final : public StereoSource {
 public:
  explicit PreloadedSource(std::shared_ptr<const PreloadedPairs> held) : held_(std::move(held)) {}

  [[nodiscard]] const StereoCalibration& calibration() const override { return held_->calibration; }
  [[nodiscard]] std::size_t pair_count() const override { return 0; }
  [[nodiscard]] Result<bool> next(SourcePair& pair) override;
  [[nodiscard]] std::string description() const override { return held_->description; }

 private:
  std::shared_ptr<const PreloadedPairs> held_;
  std::uint64_t shown_ = 0;
};

}  // namespace pelorus
