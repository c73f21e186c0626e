#pragma once
// The two checks of the contract. CRC-8 0x2F finds every change of up to three bits in a classic frame (which J1850
// does not); AUTOSAR CRC library: CRC8H2F (start and final inversion 0xFF) and CRC16 CCITT-FALSE. Pure, table-free:
// seven bytes thirty times a second need no table.

#include <cstdint>
#include <span>

namespace pelorus {

inline constexpr std::uint8_t kCrc8Start = 0xFF;
inline constexpr std::uint16_t kCrc16Start = 0xFFFF;

// Continues from `crc`; start with kCrc8Start, invert the end.
[[nodiscard]] std::uint8_t crc8_2f(std::uint8_t crc, std::span<const std::uint8_t> bytes);
// Continues from `crc`; start with kCrc16Start.
[[nodiscard]] std::uint16_t crc16_ccitt(std::uint16_t crc, std::span<const std::uint8_t> bytes);

}  // namespace pelorus
