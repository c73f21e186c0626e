#pragma once
// One frame on a CAN bus, classic or FD, as it is sent, received or read from a log. Pure data.

#include <array>
#include <cstdint>
#include <span>

#include "core/base/time.h"

namespace pelorus {

inline constexpr int kMaxCanBytes = 64;

enum class CanFrameType : std::uint8_t {
  data,
  remote,
  error  // a report of the interface about the bus: drivers/can/bus_health.h
};

struct CanFrame {
  std::uint32_t id = 0;
  bool extended = false;  // 29-bit identifier
  bool fd = false;
  CanFrameType type = CanFrameType::data;
  std::uint8_t size = 0;  // bytes used: 0..8, FD also 12, 16, 20, 24, 32, 48, 64
  std::array<std::uint8_t, kMaxCanBytes> bytes{};
  Timestamp time;  // of reception (kernel, Unix epoch) or of the log; unused when sending

  [[nodiscard]] std::span<const std::uint8_t> payload() const { return {bytes.data(), size}; }
};

}  // namespace pelorus
