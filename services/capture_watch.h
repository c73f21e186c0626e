#pragma once
// CaptureWatch: whether a pair tells the truth. Recognises the same picture delivered again (a frozen sensor or driver:
// real noise never repeats) and time stamps that leave the capture clock, which it replaces by believable ones; and
// measures the light. Remembers the previous pair. Thread-bound; no allocation; O(pixels / 4).

#include <cstdint>

#include "core/base/image.h"
#include "core/base/time.h"
#include "services/service_settings.h"

namespace pelorus {

struct CaptureVerdict {
  Timestamp capture_time;    // of the stamp, or of the clock when the stamp cannot be
  bool time_jumped = false;  // the stamps changed their offset to the clock at this pair
  int repeats = 0;           // pairs in a row that equal their predecessor; of either camera
  bool frozen = false;       // ... enough of them
  bool froze = false;        // this is the pair at which that was decided
  double mean_grey = 0;      // of the left picture
  double contrast_grey = 0;  // standard deviation
};

class CaptureWatch {
 public:
  explicit CaptureWatch(const CaptureWatchConfig& config) : config_(config) {}

  [[nodiscard]] CaptureVerdict look(Timestamp stamp, Timestamp arrival, const ImageView& left, const ImageView& right);

 private:
  [[nodiscard]] bool believable(Timestamp time, Timestamp arrival) const;
  void look_at_time(Timestamp stamp, Timestamp arrival, CaptureVerdict& verdict);
  void look_at_pictures(const ImageView& left, const ImageView& right, CaptureVerdict& verdict);

  CaptureWatchConfig config_;
  bool any_ = false;
  Timestamp last_time_;  // believed
  Timestamp last_arrival_;
  Duration correction_{};  // believed - stamp
  std::uint64_t left_print_ = 0;
  std::uint64_t right_print_ = 0;
  int repeats_ = 0;
};

}  // namespace pelorus
