#include "services/lcm_link.h"

#include <lcm/lcm-cpp.hpp>

namespace pelorus {
namespace {
constexpr std::chrono::seconds kRetry{1};
}

LcmLink::LcmLink(std::string url) : url_(std::move(url)) {}
LcmLink::~LcmLink() = default;

lcm::LCM* LcmLink::connection() {
  if (lcm_) return lcm_.get();
  const Clock::time_point now = Clock::now();
  if (now < next_try_) return nullptr;
  next_try_ = now + kRetry;
  auto fresh = std::make_unique<lcm::LCM>(url_);
  if (!fresh->good()) {
    errors_.add();
    return nullptr;
  }
  lcm_ = std::move(fresh);
  open_.set(1);
  if (was_open_) reconnects_.add();
  was_open_ = true;
  failing_ = false;
  return lcm_.get();
}

void LcmLink::note(bool success) {
  if (success) {
    failing_ = false;
    return;
  }
  errors_.add();
  const Clock::time_point now = Clock::now();
  if (!failing_) failing_since_ = now;
  failing_ = true;
  if (now - failing_since_ < kRetry) return;
  lcm_.reset();
  open_.set(0);
  next_try_ = now;
}

}  // namespace pelorus
