#pragma once
// ResultRing: results from the vision thread to the publish thread, in order, without lock, wait or allocation. Unlike
// a mailbox it keeps every result until its moment of release: with a declared latency of several periods several are
// under way at once. A fixed pool and two index rings, as in FrameRing. When the publish thread is stuck and no slot is
// free, the new result is dropped and counted. Thread-safe for one producer and one consumer; dropped() for all.

#include <cstdint>
#include <vector>

#include "core/base/counter.h"
#include "core/base/spsc_ring.h"
#include "services/publisher.h"
#include "services/wake.h"

namespace pelorus {

class ResultRing {
 public:
  // `wake` is rung with each result; borrowed.
  ResultRing(int slots, Wake& wake);

  // Producer: the slot to fill next; holds an old result until then.
  [[nodiscard]] Publication& draft() { return slots_[filling_]; }
  // Producer: hands the draft on. False: no slot free, dropped and counted.
  bool post();

  // Consumer: the oldest result, or nullptr. Valid until release().
  [[nodiscard]] Publication* front();
  // Consumer: gives the slot of front() back.
  void release();

  [[nodiscard]] std::uint64_t dropped() const { return dropped_.value(); }

 private:
  std::vector<Publication> slots_;
  SpscRing<std::uint32_t> free_;
  SpscRing<std::uint32_t> ready_;
  Wake& wake_;
  std::uint32_t filling_ = 0;   // producer's
  bool reading_valid_ = false;  // consumer's
  std::uint32_t reading_ = 0;
  Counter dropped_;
};

}  // namespace pelorus
