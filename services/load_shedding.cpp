#include "services/load_shedding.h"

#include <algorithm>

namespace pelorus {
namespace {

constexpr int kFading = 50;        // steps in which a peak loses most of what it exceeds the present by
constexpr double kReserve = 1.1;   // steps vary
constexpr double kHopeless = 0.7;  // of a step without refill: only the barest is left to try

Duration scaled(Duration duration, double by) {
  return Duration(static_cast<std::int64_t>(static_cast<double>(duration.count()) * by));
}

void follow(Duration& peak, Duration took) { peak = std::max(took, peak - (peak - took) / kFading); }

}  // namespace

Shed LoadShedding::choose(Duration left) const {
  if (left < scaled(without_refill_, kHopeless)) return Shed::object_window;
  if (left < scaled(without_refill_, kReserve)) return Shed::refinement;
  if (left < scaled(std::max(with_refill_, without_refill_), kReserve)) return Shed::refill;
  return Shed::nothing;
}

void LoadShedding::learn(Shed shed, bool refilled, Duration took) {
  if (refilled) {
    follow(with_refill_, took);
  } else if (shed < Shed::object_window) {
    follow(without_refill_, took);
  }
}

}  // namespace pelorus
