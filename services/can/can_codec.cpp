#include "services/can/can_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "services/can/can_crc.h"
#include "services/can/half_float.h"

namespace pelorus {
namespace {

constexpr unsigned kUnknownState = 15;  // no VisionState has it

std::uint64_t mask_of(const CanSignal& signal) {
  return signal.bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << signal.bits) - 1;
}

std::uint64_t raw_log_sigma(const CanSignal& signal, double value) {
  constexpr double kMostSteps = 254;
  if (std::isnan(value) || value < 0) return mask_of(signal);
  if (value <= signal.scale) return 0;
  // The small allowance keeps a decoded value from climbing one step each time it is encoded again.
  const double steps = std::ceil(kCanLogStepsPerOctave * std::log2(value / signal.scale) - 1e-6);
  return static_cast<std::uint64_t>(std::min(steps, kMostSteps));
}

std::uint64_t raw_integer(const CanSignal& signal, double value) {
  const bool is_signed = signal.coding == CanCoding::signed_integer;
  const double most = is_signed ? std::ldexp(1.0, signal.bits - 1) - 1 : std::ldexp(1.0, signal.bits) - 2;
  const double least = is_signed ? -most : 0;
  const std::uint64_t invalid = is_signed ? std::uint64_t{1} << (signal.bits - 1) : mask_of(signal);
  if (std::isnan(value)) return invalid;
  double steps = std::round(value / signal.scale);
  if (steps > most) {
    if (signal.beyond != CanBeyond::saturate) return invalid;
    steps = most;
  }
  if (steps < least) return invalid;
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(steps)) & mask_of(signal);
}

std::uint64_t raw_count(const CanSignal& signal, double value) {
  if (!(value >= 0)) return 0;
  return static_cast<std::uint64_t>(value) & mask_of(signal);
}

void insert(const CanSignal& signal, std::uint64_t raw, std::span<std::uint8_t> bytes) {
  for (int bit = 0; bit < signal.bits; ++bit) {
    const int place = signal.start_bit + bit;
    std::uint8_t& byte = bytes[static_cast<std::size_t>(place / 8)];
    const auto one = static_cast<std::uint8_t>(1U << (place % 8));
    byte = static_cast<std::uint8_t>(((raw >> bit) & 1) != 0 ? byte | one : byte & ~one);
  }
}

}  // namespace

const char* to_text(CanDecodeOutcome outcome) {
  switch (outcome) {
    case CanDecodeOutcome::ok:
      return "ok";
    case CanDecodeOutcome::not_ours:
      return "not ours";
    case CanDecodeOutcome::bad_size:
      return "wrong length";
    case CanDecodeOutcome::bad_crc:
      return "wrong CRC";
  }
  return "?";
}

std::uint64_t raw_of(const CanSignal& signal, double value) {
  switch (signal.coding) {
    case CanCoding::signed_integer:
      return raw_integer(signal, value);
    case CanCoding::unsigned_integer:
      return signal.beyond == CanBeyond::wraps ? raw_count(signal, value) : raw_integer(signal, value);
    case CanCoding::log_sigma:
      return raw_log_sigma(signal, value);
    case CanCoding::float16:
      return half_from(value);
    case CanCoding::float32:
      return std::bit_cast<std::uint32_t>(std::isfinite(value) ? static_cast<float>(value)
                                                               : std::numeric_limits<float>::quiet_NaN());
    case CanCoding::crc:
    case CanCoding::counter:
    case CanCoding::state:
      return raw_count(signal, value);
  }
  return 0;
}

double value_of(const CanSignal& signal, std::uint64_t raw) {
  if (raw == invalid_raw(signal)) return kCanUnknown;
  switch (signal.coding) {
    case CanCoding::signed_integer: {
      const int unused = 64 - signal.bits;
      const auto extended = static_cast<std::int64_t>(raw << unused) >> unused;
      return static_cast<double>(extended) * signal.scale;
    }
    case CanCoding::log_sigma:
      return signal.scale * std::exp2(static_cast<double>(raw) / kCanLogStepsPerOctave);
    case CanCoding::float16:
      return half_value(static_cast<std::uint16_t>(raw));
    case CanCoding::float32:
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
    case CanCoding::unsigned_integer:
    case CanCoding::crc:
    case CanCoding::counter:
    case CanCoding::state:
      return static_cast<double>(raw) * signal.scale;
  }
  return kCanUnknown;
}

std::uint64_t extract(const CanSignal& signal, std::span<const std::uint8_t> bytes) {
  std::uint64_t raw = 0;
  for (int bit = 0; bit < signal.bits; ++bit) {
    const int place = signal.start_bit + bit;
    const std::uint64_t one = (bytes[static_cast<std::size_t>(place / 8)] >> (place % 8)) & 1U;
    raw |= one << bit;
  }
  return raw;
}

std::optional<std::uint64_t> invalid_raw(const CanSignal& signal) {
  if (signal.beyond == CanBeyond::wraps) return std::nullopt;
  switch (signal.coding) {
    case CanCoding::signed_integer:
      return std::uint64_t{1} << (signal.bits - 1);
    case CanCoding::unsigned_integer:
    case CanCoding::log_sigma:
      return mask_of(signal);
    case CanCoding::float16:
      return std::uint64_t{half_from(kCanUnknown)};
    case CanCoding::float32:
      return std::uint64_t{0x7FC00000};
    case CanCoding::crc:
    case CanCoding::counter:
    case CanCoding::state:
      break;
  }
  return std::nullopt;
}

std::uint16_t frame_crc(const CanFrameSpec& spec, std::span<const std::uint8_t> bytes) {
  if (spec.fd) {
    const std::array<std::uint8_t, 2> id{static_cast<std::uint8_t>(spec.data_id & 0xFF),
                                         static_cast<std::uint8_t>(spec.data_id >> 8)};
    return crc16_ccitt(crc16_ccitt(kCrc16Start, id), bytes.subspan(2));
  }
  const std::array<std::uint8_t, 1> id{static_cast<std::uint8_t>(spec.data_id)};
  return static_cast<std::uint8_t>(~crc8_2f(crc8_2f(kCrc8Start, id), bytes.subspan(1)));
}

CanFrame encode_frame(const CanFrameSpec& spec, const CanEstimate& estimate, std::uint32_t base_id, unsigned counter) {
  CanFrame frame;
  frame.id = base_id + spec.id_offset;
  frame.fd = spec.fd;
  frame.size = static_cast<std::uint8_t>(spec.size);
  const std::span<std::uint8_t> bytes(frame.bytes.data(), frame.size);
  for (const CanSignal& signal : spec.signals) {
    double value = 0;
    if (signal.coding == CanCoding::counter) value = counter;
    if (signal.coding == CanCoding::state) value = static_cast<double>(estimate.state);
    if (signal.field != nullptr) value = estimate.*signal.field;
    insert(signal, raw_of(signal, value), bytes);
  }
  const std::uint16_t crc = frame_crc(spec, bytes);
  bytes[0] = static_cast<std::uint8_t>(crc & 0xFF);
  if (spec.fd) bytes[1] = static_cast<std::uint8_t>(crc >> 8);
  return frame;
}

CanSet encode_set(const CanEstimate& estimate, const CanSetOptions& options) {
  CanSet set;
  for (const CanFrameSpec& spec : can_contract()) {
    if (spec.fd != (options.transport == CanTransport::fd)) continue;
    if (spec.cadence == CanCadence::slow && !options.with_slow) continue;
    set.frames[static_cast<std::size_t>(set.size++)] = encode_frame(spec, estimate, options.base_id, options.counter);
  }
  return set;
}

CanDecoded decode_frame(const CanFrame& frame, std::uint32_t base_id, CanEstimate& estimate) {
  CanDecoded decoded;
  const std::uint32_t offset = frame.id - base_id;
  if (frame.type != CanFrameType::data || frame.extended || offset >= can_contract().size()) return decoded;
  const CanFrameSpec& spec = can_contract()[offset];
  decoded.spec = &spec;
  if (frame.size != spec.size || frame.fd != spec.fd) {
    decoded.outcome = CanDecodeOutcome::bad_size;
    return decoded;
  }
  const auto bytes = frame.payload();
  const unsigned crc = spec.fd ? bytes[0] | static_cast<unsigned>(bytes[1]) << 8 : bytes[0];
  if (crc != frame_crc(spec, bytes)) {
    decoded.outcome = CanDecodeOutcome::bad_crc;
    return decoded;
  }
  decoded.outcome = CanDecodeOutcome::ok;
  decoded.state = kUnknownState;
  for (const CanSignal& signal : spec.signals) {
    const std::uint64_t raw = extract(signal, bytes);
    if (signal.coding == CanCoding::counter) decoded.counter = static_cast<unsigned>(raw);
    if (signal.coding == CanCoding::state) decoded.state = static_cast<unsigned>(raw);
    if (signal.field != nullptr) estimate.*signal.field = value_of(signal, raw);
  }
  if (decoded.state <= static_cast<unsigned>(VisionState::standby)) {
    estimate.state = static_cast<VisionState>(decoded.state);
  }
  return decoded;
}

}  // namespace pelorus
