#include "firmware-host/pelorus/bench/preloaded_source.h"

#include <algorithm>
#include <chrono>

namespace pelorus {
namespace {

constexpr std::size_t kFewest = 3;
constexpr Duration kPeriod = std::chrono::milliseconds(50);  // of the stamps; the pace is the camera's

void copy(const Image& from, Image& to) {
  if (to.width() != from.width() || to.height() != from.height()) to = Image(from.width(), from.height());
  for (int v = 0; v < from.height(); ++v) std::copy_n(from.row(v), from.width(), to.row(v));
}

}  // namespace

std::size_t PreloadedPairs::bytes() const {
  std::size_t sum = 0;
  for (const SourcePair& pair : pairs) {
    sum +=
        static_cast<std::size_t>(pair.left.stride() * pair.left.height() + pair.right.stride() * pair.right.height());
  }
  return sum;
}

Result<std::shared_ptr<const PreloadedPairs>> preload(StereoSource& source, std::size_t count) {
  auto held = std::make_shared<PreloadedPairs>();
  held->calibration = source.calibration();
  held->description = source.description();
  for (SourcePair pair; held->pairs.size() < count;) {
    const Result<bool> more = source.next(pair);
    if (!more) return more.error();
    if (!more.value()) break;
    held->pairs.push_back(std::move(pair));
    pair = SourcePair{};
  }
  if (held->pairs.size() < kFewest) {
    return Error{ErrorCode::bad_input, "recording", "has only " + pairs_text(held->pairs.size()),
                 "give one of three pairs or more"};
  }
  return std::shared_ptr<const PreloadedPairs>(std::move(held));
}

Result<bool> PreloadedSource::next(SourcePair& pair) {
  const std::size_t last = held_->pairs.size() - 1;
  const std::size_t place = shown_ % (2 * last);
  const SourcePair& from = held_->pairs[place <= last ? place : 2 * last - place];
  pair.seq = shown_;
  pair.capture_time = Timestamp{} + static_cast<std::int64_t>(shown_) * kPeriod;
  copy(from.left, pair.left);
  copy(from.right, pair.right);
  ++shown_;
  return true;
}

}  // namespace pelorus
