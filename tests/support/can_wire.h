#pragma once
// A CAN bus of one wire: a socket pair that carries the kernel's CAN frames as a CAN socket does. The calls, their
// back-pressure and their errors are the kernel's own; what it cannot show (ENOBUFS, interfaces) needs a virtual
// machine: tests/hil/can_vm.sh.

#include <gtest/gtest.h>
#include <linux/can.h>
#include <sys/socket.h>

#include <utility>
#include <vector>

#include "drivers/can/can_socket.h"

namespace pelorus::test {

class CanWire {
 public:
  CanWire() {
    int ends[2];
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends), 0);
    near_ = UniqueFd(ends[0]);
    far_.emplace(CanSocket::adopt(UniqueFd(ends[1])));
  }

  // The end that the code under test gets; once.
  CanSocket near_end() { return CanSocket::adopt(std::move(near_)); }
  // Everything that is on the wire now.
  std::vector<CanFrame> take_all() {
    std::vector<CanFrame> frames;
    CanFrame frame;
    while (far_ && far_->receive(frame) == CanReceiveOutcome::frame) frames.push_back(frame);
    return frames;
  }
  // A frame with any identifier and flags, such as an error frame, to the near end.
  void inject(std::uint32_t id_and_flags, std::uint8_t byte1 = 0) {
    can_frame raw{};
    raw.can_id = id_and_flags;
    raw.can_dlc = 8;
    raw.data[1] = byte1;
    EXPECT_EQ(::send(far_->descriptor(), &raw, sizeof raw, 0), static_cast<ssize_t>(sizeof raw));
  }
  // The interface is pulled out.
  void cut() { far_.reset(); }

 private:
  UniqueFd near_;
  std::optional<CanSocket> far_;
};

}  // namespace pelorus::test
