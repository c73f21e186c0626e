#include "services/result_ring.h"

#include <optional>

namespace pelorus {

ResultRing::ResultRing(int slots, Wake& wake)
    : slots_(static_cast<std::size_t>(slots)), free_(slots_.size()), ready_(slots_.size()), wake_(wake) {
  PELORUS_CHECK(slots >= 3, "a result ring needs a slot to fill, one ready and one to read");
  for (std::uint32_t i = 1; i < slots_.size(); ++i) PELORUS_CHECK(free_.try_push(i), "ring of all slots is full");
}

bool ResultRing::post() {
  const std::optional<std::uint32_t> next = free_.try_pop();
  if (!next) {
    dropped_.add();
    return false;
  }
  PELORUS_CHECK(ready_.try_push(filling_), "ring of all slots is full");
  filling_ = *next;
  wake_.ring();
  return true;
}

Publication* ResultRing::front() {
  if (!reading_valid_) {
    const std::optional<std::uint32_t> slot = ready_.try_pop();
    if (!slot) return nullptr;
    reading_ = *slot;
    reading_valid_ = true;
  }
  return &slots_[reading_];
}

void ResultRing::release() {
  PELORUS_CHECK(reading_valid_, "no result is being read");
  reading_valid_ = false;
  PELORUS_CHECK(free_.try_push(reading_), "ring of all slots is full");
}

}  // namespace pelorus
