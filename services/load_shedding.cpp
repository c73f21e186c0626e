#include "services/load_shedding.h"

#include <algorithm>

namespace pelorus {
namespace {

constexpr int kFading = 50;       // steps in which a peak loses most of itself unless it is confirmed
constexpr double kReserve = 1.1;  // steps vary

Duration scaled(Duration duration, double by) {
  return Duration(static_cast<std::int64_t>(static_cast<double>(duration.count()) * by));
}

}  // namespace

Shed LoadShedding::choose(Duration left) const {
  if (left < scaled(without_refill_, kReserve)) return Shed::object_window;
  if (left < scaled(std::max(with_refill_, without_refill_), kReserve)) return Shed::refill;
  return Shed::nothing;
}

void LoadShedding::learn(Shed shed, bool refilled, Duration took) {
  with_refill_ -= with_refill_ / kFading;
  without_refill_ -= without_refill_ / kFading;
  if (refilled) {
    with_refill_ = std::max(with_refill_, took);
  } else if (shed < Shed::object_window) {
    without_refill_ = std::max(without_refill_, took);
  }
}

}  // namespace pelorus
