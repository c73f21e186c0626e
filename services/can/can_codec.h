#pragma once
// CanEstimate <-> frames, by the rows of can_contract.h. Encoding gives one set: all frames of an estimate with one
// counter, closed by QUAL (classic) or VIS_FD. Decoding checks length and CRC and tells what each field said; it keeps
// no state: counters and timeouts are the receiver's business (firmware-host/autopilot). Pure; no allocation.

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/can/can_frame.h"
#include "services/can/can_contract.h"

namespace pelorus {

enum class CanTransport : std::uint8_t { classic, fd };

struct CanSet {
  std::array<CanFrame, kCanIdsUsed> frames{};
  int size = 0;

  [[nodiscard]] std::span<const CanFrame> view() const& { return {frames.data(), static_cast<std::size_t>(size)}; }
  std::span<const CanFrame> view() && = delete;  // would outlive its set; iterate over the set itself
  [[nodiscard]] const CanFrame* begin() const { return frames.data(); }
  [[nodiscard]] const CanFrame* end() const { return frames.data() + size; }
};

struct CanSetOptions {
  CanTransport transport = CanTransport::classic;
  std::uint32_t base_id = kCanDefaultBaseId;
  unsigned counter = 0;    // of the estimate; each transport takes it modulo its own field
  bool with_slow = false;  // add the slow frames
};

[[nodiscard]] CanSet encode_set(const CanEstimate& estimate, const CanSetOptions& options);

// One frame; what encode_set is made of.
[[nodiscard]] CanFrame encode_frame(const CanFrameSpec& spec, const CanEstimate& estimate, std::uint32_t base_id,
                                    unsigned counter);

enum class CanDecodeOutcome : std::uint8_t { ok, not_ours, bad_size, bad_crc };
[[nodiscard]] const char* to_text(CanDecodeOutcome outcome);

struct CanDecoded {
  CanDecodeOutcome outcome = CanDecodeOutcome::not_ours;
  const CanFrameSpec* spec = nullptr;  // null when not ours
  unsigned counter = 0;
  unsigned state = 0;  // raw: a newer sender may know more states
};

// Fills the fields of `estimate` that the frame carries (unknown where invalid); leaves it alone unless ok.
CanDecoded decode_frame(const CanFrame& frame, std::uint32_t base_id, CanEstimate& estimate);

// A signal by itself: the raw bits of a value (NaN = invalid) and back.
[[nodiscard]] std::uint64_t raw_of(const CanSignal& signal, double value);
[[nodiscard]] double value_of(const CanSignal& signal, std::uint64_t raw);
[[nodiscard]] std::uint64_t extract(const CanSignal& signal, std::span<const std::uint8_t> bytes);
// The raw bits that mean invalid; none for counts, codes and protection.
[[nodiscard]] std::optional<std::uint64_t> invalid_raw(const CanSignal& signal);
// CRC as it has to stand in the frame.
[[nodiscard]] std::uint16_t frame_crc(const CanFrameSpec& spec, std::span<const std::uint8_t> bytes);

}  // namespace pelorus
