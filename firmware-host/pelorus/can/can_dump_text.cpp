// Lines of `pelorus can dump`.

#include <cmath>
#include <cstdio>

#include "drivers/can/bus_health.h"
#include "drivers/can/candump_log.h"
#include "firmware-host/pelorus/can/can_dump.h"
#include "services/can/contract_text.h"

namespace pelorus {
namespace {

std::string time_text(Timestamp time) {
  char text[40];
  std::snprintf(text, sizeof text, "%lld.%06lld", static_cast<long long>(time.ns / 1'000'000'000),
                static_cast<long long>(time.ns / 1000 % 1'000'000));
  return text;
}

std::string hex_id(std::uint32_t id) {
  char text[16];
  std::snprintf(text, sizeof text, "%03X", id);
  return text;
}

std::string state_text(unsigned state) {
  if (state > static_cast<unsigned>(VisionState::standby)) return "state " + std::to_string(state);
  return to_text(static_cast<VisionState>(state));
}

// A finite number, or what stands for none.
std::string value_text(double value, const char* none) { return std::isfinite(value) ? number_text(value) : none; }

std::string trouble_text(const CanFrame& frame, const std::string& trouble, bool json) {
  if (json) {
    return "{\"time_s\":" + time_text(frame.time) + ",\"id\":" + std::to_string(frame.id) + ",\"error\":\"" + trouble +
           "\"}";
  }
  return time_text(frame.time) + "  " + hex_id(frame.id) + "  " + trouble;
}

std::string error_frame_text(const CanFrame& frame, bool json) {
  CanBusHealth health;
  health.state = CanBusState::active;
  note_error_frame(frame, health);
  return trouble_text(frame, std::string("error frame: bus ") + to_text(health.state), json);
}

std::string json_fields(const CanDecoded& decoded, const CanEstimate& seen) {
  std::string out;
  for (const CanSignal& signal : decoded.spec->signals) {
    if (signal.field != nullptr)
      out += ",\"" + std::string(signal.name) + "\":" + value_text(seen.*signal.field, "null");
  }
  return out;
}

std::string plain_fields(const CanDecoded& decoded, const CanEstimate& seen) {
  std::string out;
  for (const CanSignal& signal : decoded.spec->signals) {
    if (signal.field == nullptr) continue;
    const std::string value = value_text(seen.*signal.field, "-");
    const bool unit = value != "-" && *signal.unit != 0;
    out += "  " + std::string(signal.name) + " " + value + (unit ? std::string(" ") + signal.unit : "");
  }
  return out;
}

// One number of a set, in both forms.
class SetLine {
 public:
  explicit SetLine(bool json) : json_(json) {}
  void add(const char* name, const std::string& value) {
    text_ += json_ ? (text_.empty() ? "{\"" : ",\"") + std::string(name) + "\":" + value
                   : (text_.empty() ? "" : "  ") + std::string(name) + " " + value;
  }
  void add(const char* name, float value) { add(name, float_text(value)); }
  void add_word(const char* name, const std::string& word) { add(name, json_ ? "\"" + word + "\"" : word); }
  void add_3(const char* name, const float (&value)[3]) {
    std::string all;
    for (const float part : value) {
      if (!all.empty()) all += json_ ? "," : " ";
      all += float_text(part);
    }
    add(name, json_ ? "[" + all + "]" : all);
  }
  [[nodiscard]] std::string text() const { return json_ ? text_ + "}" : text_; }

 private:
  [[nodiscard]] std::string float_text(float value) const {
    if (!std::isfinite(value)) return json_ ? "null" : "-";
    char text[32];
    std::snprintf(text, sizeof text, "%.7g", static_cast<double>(value));
    return text;
  }

  bool json_;
  std::string text_;
};

const char* link_text(pelorus_can_link link) {
  switch (link) {
    case PELORUS_CAN_LINK_SILENT:
      return "silent";
    case PELORUS_CAN_LINK_STARTING:
      return "starting";
    case PELORUS_CAN_LINK_UP:
      return "up";
    case PELORUS_CAN_LINK_TIMEOUT:
      return "timeout";
  }
  return "?";
}

}  // namespace

std::string frame_text(const CanFrame& frame, std::uint32_t base_id, bool json) {
  if (frame.type == CanFrameType::error) return error_frame_text(frame, json);
  CanEstimate seen;
  const CanDecoded decoded = decode_frame(frame, base_id, seen);
  if (decoded.outcome != CanDecodeOutcome::ok) {
    const std::string name = decoded.spec == nullptr ? "" : std::string(decoded.spec->name) + ": ";
    return trouble_text(frame, name + to_text(decoded.outcome), json);
  }
  if (json) {
    return "{\"time_s\":" + time_text(frame.time) + ",\"frame\":\"" + decoded.spec->name +
           "\",\"counter\":" + std::to_string(decoded.counter) + ",\"state\":\"" + state_text(decoded.state) + "\"" +
           json_fields(decoded, seen) + "}";
  }
  return time_text(frame.time) + "  " + decoded.spec->name + "  #" + std::to_string(decoded.counter) + " " +
         state_text(decoded.state) + plain_fields(decoded, seen);
}

std::string set_text(const pelorus_can_estimate& e, pelorus_can_link link, bool json) {
  SetLine line(json);
  line.add("time_s", time_text(Timestamp{static_cast<std::int64_t>(e.received_us) * 1000}));
  line.add_word("link", link_text(link));
  line.add_word("state", state_text(e.state));
  line.add("counter", std::to_string(e.counter));
  line.add("quality", std::to_string(e.quality));
  line.add("resets", std::to_string(e.resets));
  const bool aged = (e.valid & PELORUS_CAN_AGE) != 0;
  line.add("age_ms", aged ? number_text(e.age_us * 1e-3) : (json ? "null" : "-"));
  line.add("interval_s", e.interval_s);
  line.add_3("velocity_mps", e.velocity_mps);
  line.add_3("step_m", e.step_m);
  line.add("roll_rad", e.roll_rad);
  line.add("pitch_rad", e.pitch_rad);
  line.add("yaw_rad", e.yaw_rad);
  line.add_3("position_m", e.position_m);
  line.add("bodies", e.bodies == 255 ? (json ? "null" : "-") : std::to_string(e.bodies));
  line.add("body_bearing_rad", e.body_bearing_rad);
  line.add("body_elevation_rad", e.body_elevation_rad);
  line.add("body_range_m", e.body_range_m);
  line.add("body_closing_mps", e.body_closing_mps);
  return line.text();
}

}  // namespace pelorus
