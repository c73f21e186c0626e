#include "services/lcm_link.h"

#include <lcm/lcm-cpp.hpp>

#include "services/lcm_address.h"

namespace pelorus {
namespace {
constexpr std::chrono::seconds kRetry{1};
}

bool lcm_can_open(const std::string& url) {
  const auto address = parse_lcm_url(url);
  return !address || find_multicast_route(*address).exists;
}

LcmLink::LcmLink(std::string url) : url_(std::move(url)) {}
LcmLink::~LcmLink() = default;

lcm::LCM* LcmLink::connection() {
  if (lcm_) return lcm_.get();
  const Clock::time_point now = Clock::now();
  if (now < next_try_) return nullptr;
  next_try_ = now + kRetry;
  attempts_.add();
  if (!lcm_can_open(url_)) return nullptr;
  auto fresh = std::make_unique<lcm::LCM>(url_);
  if (!fresh->good()) return nullptr;
  lcm_ = std::move(fresh);
  if (was_open_) reconnects_.add();
  was_open_ = true;
  failing_ = false;
  return lcm_.get();
}

void LcmLink::note(bool success) {
  works_.set(success ? 1 : 0);
  if (success) {
    failing_ = false;
    return;
  }
  errors_.add();
  if (!lcm_) return;
  const Clock::time_point now = Clock::now();
  if (!failing_) failing_since_ = now;
  failing_ = true;
  if (now - failing_since_ < kRetry || now < next_try_) return;
  next_try_ = now + kRetry;
  // Without a route a new connection would be worse than this one, which speaks again with the route.
  if (!lcm_can_open(url_)) return;
  lcm_.reset();
  next_try_ = now;
}

}  // namespace pelorus
