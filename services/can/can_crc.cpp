#include "services/can/can_crc.h"

namespace pelorus {

std::uint8_t crc8_2f(std::uint8_t crc, std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    crc = static_cast<std::uint8_t>(crc ^ byte);
    for (int bit = 0; bit < 8; ++bit) {
      const int shifted = crc << 1;
      crc = static_cast<std::uint8_t>((crc & 0x80) != 0 ? shifted ^ 0x2F : shifted);
    }
  }
  return crc;
}

std::uint16_t crc16_ccitt(std::uint16_t crc, std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ (byte << 8));
    for (int bit = 0; bit < 8; ++bit) {
      const int shifted = crc << 1;
      crc = static_cast<std::uint16_t>((crc & 0x8000) != 0 ? shifted ^ 0x1021 : shifted);
    }
  }
  return crc;
}

}  // namespace pelorus
