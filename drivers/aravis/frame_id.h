#pragma once
// FrameIdUnwrapper: GigE Vision frame ids turned into a growing count. Ids have 16 bits and skip 0 (65535 is followed
// by 1), or 64 bits (GigE Vision 2.0, extended ids). Pure.

#include <cstdint>

namespace pelorus {

class FrameIdUnwrapper {
 public:
  // Exposures since the previous id, normally 1. After restart() and for an id that went back (the camera started
  // anew) it is 1; the same id again is 0.
  [[nodiscard]] std::uint64_t advance(std::uint64_t id) {
    constexpr std::uint64_t kIds = 65535;         // 1 to 65535
    constexpr std::uint64_t kLongestGap = 30000;  // a longer one is a restart
    const std::uint64_t last = last_;
    const bool first = !known_;
    known_ = true;
    last_ = id;
    if (first) return 1;
    if (id >= last) return id - last <= kLongestGap ? id - last : 1;
    const bool wrapped = last <= kIds && id + kIds - last <= kLongestGap;
    return wrapped ? id + kIds - last : 1;
  }
  void restart() { known_ = false; }

 private:
  bool known_ = false;
  std::uint64_t last_ = 0;
};

}  // namespace pelorus
