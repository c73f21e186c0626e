// The tables of docs/can.md.

#include <cmath>
#include <cstdio>
#include <string>

#include "services/can/contract_text.h"

namespace pelorus {
namespace {

std::string hex_bytes(std::span<const std::uint8_t> bytes) {
  std::string out;
  char text[4];
  for (const std::uint8_t byte : bytes) {
    std::snprintf(text, sizeof text, "%02X", byte);
    out += text;
  }
  return out;
}

std::string hex_id(unsigned id) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%03X", id);
  return text;
}

std::string place_text(const CanSignal& signal) {
  const int first = signal.start_bit / 8;
  const int last = (signal.start_bit + signal.bits - 1) / 8;
  if (signal.bits < 8) return std::to_string(first) + (signal.start_bit % 8 == 0 ? " low" : " high");
  return first == last ? std::to_string(first) : std::to_string(first) + "-" + std::to_string(last);
}

std::string frame_section(const CanFrameSpec& spec) {
  std::string out = "\n### " + std::string(spec.name) + ", " + hex_id(kCanDefaultBaseId + spec.id_offset) + "\n\n";
  out += std::string(spec.meaning) + ". " + std::to_string(spec.size) + " bytes, " +
         (spec.cadence == CanCadence::slow ? "slow" : "every estimate") + ", data id " + hex_id(spec.data_id) + ".\n\n";
  out += "| byte | signal | coding | invalid | meaning |\n|---|---|---|---|---|\n";
  for (const CanSignal& signal : spec.signals) {
    out += "| " + place_text(signal) + " | " + signal.name + " | " + signal_range_text(signal) + " | " +
           signal_invalid_text(signal) + " | " + signal.meaning + " |\n";
  }
  return out;
}

// The physical values that the frames of a vector carry, as a receiver has to find them.
std::string vector_section(const ContractVector& vector, CanTransport transport) {
  std::string out = "\n" + vector.name + ":\n\n| frame | bytes | values |\n|---|---|---|\n";
  const CanSet set = encode_set(vector.estimate, {transport, kCanDefaultBaseId, vector.counter, vector.with_slow});
  for (const CanFrame& frame : set) {
    CanEstimate seen;
    const CanDecoded decoded = decode_frame(frame, kCanDefaultBaseId, seen);
    out += "| " + std::string(decoded.spec->name) + " | `" + hex_bytes(frame.payload()) + "` |";
    for (const CanSignal& signal : decoded.spec->signals) {
      if (signal.field == nullptr) continue;
      const double value = seen.*signal.field;
      out += " " + std::string(signal.name) + " " + (std::isnan(value) ? "-" : number_text(value));
    }
    out += " |\n";
  }
  return out;
}

}  // namespace

std::string page_tables_text() {
  std::string out = std::string(kPageBegin) + "\n\n## Frames\n\n| identifier | frame | bytes | sent | says |\n" +
                    "|---|---|---|---|---|\n";
  for (const CanFrameSpec& spec : can_contract()) {
    out += "| base + " + std::to_string(spec.id_offset) + " = " + hex_id(kCanDefaultBaseId + spec.id_offset) + " | " +
           spec.name + " | " + std::to_string(spec.size) + (spec.fd ? " (FD)" : "") + " | " +
           (spec.cadence == CanCadence::slow ? "slow" : "every estimate") + " | " + spec.meaning + " |\n";
  }
  for (const CanFrameSpec& spec : can_contract()) out += frame_section(spec);
  out +=
      "\n## Test vectors\n\n`-` is invalid. The same frames in candump format: `firmware-host/autopilot/"
      "vectors_classic.log` and `vectors_fd.log`.\n";
  for (const ContractVector& vector : contract_vectors()) out += vector_section(vector, CanTransport::classic);
  out += "\nThe same estimates over FD:\n";
  for (const ContractVector& vector : contract_vectors()) out += vector_section(vector, CanTransport::fd);
  return out + "\n" + kPageEnd + "\n";
}

}  // namespace pelorus
