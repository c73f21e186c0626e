// DBC as the common tools read it: Intel byte order, float32 by SIG_VALTYPE_, FD by VFrameFormat. What DBC cannot say
// (binary16, logarithmic steps) stays a raw number with a comment.

#include <cmath>
#include <string>

#include "services/can/contract_text.h"

namespace pelorus {
namespace {

constexpr const char* kPreamble = "NS_ :\n\nBS_:\n\nBU_: PELORUS AUTOPILOT\n\n";

// Physical value = factor * raw, as far as the format can express the coding.
struct DbcScale {
  bool is_signed = false;
  double factor = 1;
  double low = 0;
  double high = 0;
  std::string unit;
};

DbcScale dbc_scale(const CanSignal& signal) {
  const double codes = std::ldexp(1.0, signal.bits);
  switch (signal.coding) {
    case CanCoding::signed_integer: {
      const double most = (codes / 2 - 1) * signal.scale;
      return {true, signal.scale, -most, most, signal.unit};
    }
    case CanCoding::float32:
      return {true, 1, 0, 0, signal.unit};  // 0|0: no limits
    case CanCoding::float16:
      return {false, 1, 0, codes - 1, "binary16"};
    case CanCoding::log_sigma:
      return {false, 1, 0, codes - 1, "log"};
    case CanCoding::unsigned_integer:
    case CanCoding::crc:
    case CanCoding::counter:
    case CanCoding::state:
      break;
  }
  return {false, signal.scale, 0, (codes - 1) * signal.scale, signal.unit};
}

std::string signal_line(const CanSignal& signal) {
  const DbcScale scale = dbc_scale(signal);
  return " SG_ " + std::string(signal.name) + " : " + std::to_string(signal.start_bit) + "|" +
         std::to_string(signal.bits) + "@1" + (scale.is_signed ? "-" : "+") + " (" + number_text(scale.factor) +
         ",0) [" + number_text(scale.low) + "|" + number_text(scale.high) + "] \"" + scale.unit + "\" AUTOPILOT\n";
}

std::string values_line(const std::string& place, const CanSignal& signal) {
  const std::string head = "VAL_ " + place;
  if (signal.coding == CanCoding::state) {
    std::string out = head;
    for (int state = 0; state <= static_cast<int>(VisionState::standby); ++state) {
      out += " " + std::to_string(state) + " \"" + to_text(static_cast<VisionState>(state)) + "\"";
    }
    return out + " ;\n";
  }
  const auto invalid = invalid_raw(signal);
  if (!invalid || signal.coding == CanCoding::float16 || signal.coding == CanCoding::float32) return "";
  const auto raw = static_cast<long long>(*invalid);
  const bool is_signed = signal.coding == CanCoding::signed_integer;
  std::string out = head;
  if (signal.field == &CanEstimate::object_phase) out += " 1 \"SEEN\" 2 \"COASTING\"";
  return out + " " + std::to_string(is_signed ? -raw : raw) + " \"INVALID\" ;\n";
}

}  // namespace

std::string dbc_text(std::uint32_t base_id) {
  std::string messages;
  std::string comments =
      "CM_ \"Pelorus: motion of the vehicle and nearest moving body from stereo vision. Contract version " +
      std::to_string(kCanContractVersion) +
      ". Axes of the body: x forward, y starboard, z down. Check CRC and counter before use: docs/can.md.\";\n";
  std::string attributes =
      "BA_DEF_ \"BusType\" STRING ;\n"
      "BA_DEF_ BO_ \"VFrameFormat\" ENUM \"StandardCAN\",\"ExtendedCAN\",\"reserved\",\"reserved\",\"reserved\","
      "\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\","
      "\"reserved\",\"StandardCAN_FD\",\"ExtendedCAN_FD\";\n"
      "BA_DEF_ BO_ \"DataId\" INT 0 65535;\n"
      "BA_DEF_DEF_ \"BusType\" \"CAN FD\";\n"
      "BA_DEF_DEF_ \"VFrameFormat\" \"StandardCAN\";\n"
      "BA_DEF_DEF_ \"DataId\" 0;\n"
      "BA_ \"BusType\" \"CAN FD\";\n";
  std::string values;
  std::string types;
  for (const CanFrameSpec& spec : can_contract()) {
    const std::string id = std::to_string(base_id + spec.id_offset);
    messages += "BO_ " + id + " " + spec.name + ": " + std::to_string(spec.size) + " PELORUS\n";
    comments += "CM_ BO_ " + id + " \"" + spec.meaning + "\";\n";
    if (spec.fd) attributes += "BA_ \"VFrameFormat\" BO_ " + id + " 14;\n";
    attributes += "BA_ \"DataId\" BO_ " + id + " " + std::to_string(spec.data_id) + ";\n";
    for (const CanSignal& signal : spec.signals) {
      const std::string place = id + " " + signal.name;
      messages += signal_line(signal);
      comments += "CM_ SG_ " + place + " \"" + signal.meaning + ". " + signal_range_text(signal) +
                  "; invalid: " + signal_invalid_text(signal) + ".\";\n";
      values += values_line(place, signal);
      if (signal.coding == CanCoding::float32) types += "SIG_VALTYPE_ " + place + " : 1;\n";
    }
    messages += "\n";
  }
  return "VERSION \"" + std::to_string(kCanContractVersion) + "\"\n\n" + kPreamble + messages + comments + attributes +
         values + types;
}

}  // namespace pelorus
