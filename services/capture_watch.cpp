#include "services/capture_watch.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

namespace pelorus {
namespace {

constexpr int kRowStep = 4;                            // every 4th row decides whether two pictures are the same
constexpr Duration kOldest = std::chrono::seconds(1);  // a stamp further back than this is no transport delay

struct Light {
  std::uint64_t print = 1469598103934665603U;  // FNV-1a on words
  double mean = 0;
  double deviation = 0;
};

Light look_at(const ImageView& image) {
  Light light;
  std::uint64_t sum = 0, squares = 0, count = 0;
  for (int v = 0; v < image.height; v += kRowStep) {
    const std::uint8_t* row = image.row(v);
    for (int u = 0; u + 8 <= image.width; u += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, row + u, sizeof word);
      light.print = (light.print ^ word) * 1099511628211U;
      sum += row[u];
      squares += std::uint64_t{row[u]} * row[u];
      ++count;
    }
  }
  if (count == 0) return light;
  light.mean = static_cast<double>(sum) / static_cast<double>(count);
  const double variance = static_cast<double>(squares) / static_cast<double>(count) - light.mean * light.mean;
  light.deviation = std::sqrt(std::max(0.0, variance));
  return light;
}

}  // namespace

CaptureVerdict CaptureWatch::look(Timestamp stamp, Timestamp arrival, const ImageView& left, const ImageView& right) {
  CaptureVerdict verdict;
  look_at_time(stamp, arrival, verdict);
  look_at_pictures(left, right, verdict);
  any_ = true;
  return verdict;
}

bool CaptureWatch::believable(Timestamp time, Timestamp arrival) const {
  const Duration future(static_cast<std::int64_t>(config_.time_jump_ms * 1e6));
  return time <= arrival + future && arrival - time <= kOldest && (!any_ || last_time_ < time);
}

void CaptureWatch::look_at_time(Timestamp stamp, Timestamp arrival, CaptureVerdict& verdict) {
  if (believable(stamp, arrival)) {
    // Back from a jump is a jump as well.
    verdict.time_jumped = correction_ != Duration::zero();
    correction_ = Duration::zero();
  } else if (!believable(stamp + correction_, arrival) || correction_ == Duration::zero()) {
    verdict.time_jumped = true;
    const Timestamp expected = any_ ? last_time_ + std::max(arrival - last_arrival_, Duration(1)) : arrival;
    correction_ = std::min(expected, arrival) - stamp;
    if (any_ && stamp + correction_ <= last_time_) correction_ = last_time_ + Duration(1) - stamp;
  }
  verdict.capture_time = stamp + correction_;
  last_time_ = verdict.capture_time;
  last_arrival_ = arrival;
}

void CaptureWatch::look_at_pictures(const ImageView& left, const ImageView& right, CaptureVerdict& verdict) {
  const Light of_left = look_at(left);
  const Light of_right = look_at(right);
  const bool same = any_ && (of_left.print == left_print_ || of_right.print == right_print_);
  left_print_ = of_left.print;
  right_print_ = of_right.print;
  repeats_ = same && config_.frozen_pairs > 0 ? repeats_ + 1 : 0;
  verdict.repeats = repeats_;
  verdict.frozen = config_.frozen_pairs > 0 && repeats_ >= config_.frozen_pairs;
  verdict.froze = verdict.frozen && repeats_ == config_.frozen_pairs;
  verdict.mean_grey = of_left.mean;
  verdict.contrast_grey = of_left.deviation;
}

}  // namespace pelorus
