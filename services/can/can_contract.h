#pragma once
// The CAN contract: the one table from which the encoder, the decoder, the DBC, the C header of the autopilot's
// receiver, the documentation page and the test vectors are made. Adding a signal = a member of CanEstimate and a row
// here; `pelorus can export` then writes the files again, and a test refuses a tree in which they differ.
// Bytes are little-endian (Intel). Pure data, constant.
// Protection follows AUTOSAR end-to-end profiles: classic as P2 (CRC-8 0x2F, 4-bit counter), FD as P5 (CRC-16, 8-bit).

#include <cstdint>
#include <span>

#include "services/can/can_estimate.h"

namespace pelorus {

inline constexpr std::uint32_t kCanDefaultBaseId = 0x120;
inline constexpr int kCanContractVersion = 1;
inline constexpr int kCanIdsUsed = 12;  // base .. base + 11
inline constexpr int kCanLogStepsPerOctave = 16;

enum class CanFrameKind : std::uint8_t {
  velocity,
  attitude,
  step,
  timing,
  object,
  object_rate,
  position_xy,
  position_z,
  node,
  quality,
  fd_slow,
  fd
};

enum class CanCoding : std::uint8_t {
  crc,
  counter,
  state,
  unsigned_integer,  // physical = raw * scale; invalid: all bits set
  signed_integer,    // physical = raw * scale; invalid: the most negative value, 0x8000 for 16 bits
  log_sigma,         // physical = scale * 2^(raw / 16), rounded up; invalid: 255
  float16,           // IEEE 754 binary16; invalid: NaN
  float32            // IEEE 754 binary32; invalid: NaN
};

// What becomes of a value that the field cannot hold.
enum class CanBeyond : std::uint8_t {
  invalid,   // sent as invalid: a clipped velocity would be a lie
  saturate,  // the last value means "this or more": deviations, ages
  wraps      // a count or a code, modulo the field; has no invalid value
};

struct CanSignal {
  const char* name;
  int start_bit;
  int bits;
  CanCoding coding;
  double scale;
  const char* unit;
  CanBeyond beyond;
  double CanEstimate::*field;  // null for crc, counter, state
  const char* meaning;         // sign convention and frame
};

// When a frame is sent.
enum class CanCadence : std::uint8_t { every_set, slow };

struct CanFrameSpec {
  CanFrameKind kind;
  const char* name;
  std::uint32_t id_offset;
  std::uint16_t data_id;  // goes into the CRC, so that a frame under a wrong identifier is refused
  int size;               // bytes
  bool fd;
  CanCadence cadence;
  const char* meaning;
  std::span<const CanSignal> signals;
};

// All frames by identifier, which is also the order in which a set is sent: QUAL (classic) and FD close it.
[[nodiscard]] std::span<const CanFrameSpec> can_contract();
[[nodiscard]] const CanFrameSpec& can_frame_spec(CanFrameKind kind);

}  // namespace pelorus
