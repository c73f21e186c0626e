#pragma once
// A raw SocketCAN socket that never waits: sends and receives classic and FD frames, receives the bus' error frames.
// Kernel documentation: Documentation/networking/can.rst. The kernel queues what the bus cannot take yet and offers no
// way to take it back; unsent_bytes() tells whether it still holds something, so that a sender of fresh data can hold
// its own frames back instead. What a controller keeps in its mailboxes is seen by nobody. Thread-bound.

#include <optional>
#include <span>
#include <string>

#include "core/base/result.h"
#include "drivers/can/can_frame.h"
#include "drivers/unique_fd.h"

namespace pelorus {

enum class CanSendOutcome : std::uint8_t {
  sent,
  full,  // try again later: socket or interface queue
  down,  // interface there but not up
  gone   // interface or socket unusable: open anew
};

enum class CanReceiveOutcome : std::uint8_t { frame, none, down, gone };

struct CanSocketOptions {
  std::string interface = "can0";
  bool fd = false;              // send and receive FD frames; the interface has to offer them
  bool bit_rate_switch = true;  // FD: payload at the data bit rate
  bool receive_data = true;     // false: error frames only
  std::uint32_t first_id = 0;   // receive data frames with standard identifiers first_id .. last_id only
  std::uint32_t last_id = 0x7FF;
  int queue_bytes = 8192;  // socket memory for frames that wait for the bus
};

class CanSocket {
 public:
  // Errors: device (no such interface, no FD, no SocketCAN in the kernel, no permission).
  [[nodiscard]] static Result<CanSocket> open(const CanSocketOptions& options);
  // A socket opened and bound by someone else; made non-blocking. Any datagram socket that carries can_frame will do.
  [[nodiscard]] static CanSocket adopt(UniqueFd socket, bool bit_rate_switch = true);

  [[nodiscard]] CanSendOutcome send(const CanFrame& frame);
  // The next frame, with the kernel's time of reception where it tells one.
  [[nodiscard]] CanReceiveOutcome receive(CanFrame& frame);
  // Bytes of kernel memory that wait to be sent; none when the kernel does not tell.
  [[nodiscard]] std::optional<std::size_t> unsent_bytes() const;
  // For poll().
  [[nodiscard]] int descriptor() const { return socket_.get(); }

 private:
  CanSocket(UniqueFd socket, bool bit_rate_switch) : socket_(std::move(socket)), bit_rate_switch_(bit_rate_switch) {}

  UniqueFd socket_;
  bool bit_rate_switch_ = true;
};

}  // namespace pelorus
