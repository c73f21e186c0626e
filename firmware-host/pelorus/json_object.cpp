#include "firmware-host/pelorus/json_object.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace pelorus {

std::string json_text(const std::string& text) {
  std::string json = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') json += '\\';
    if (static_cast<unsigned char>(c) < 0x20) {
      std::array<char, 8> escape{};
      std::snprintf(escape.data(), escape.size(), "\\u%04x", static_cast<unsigned>(c));
      json += escape.data();
    } else {
      json += c;
    }
  }
  return json + "\"";
}

JsonObject& JsonObject::raw(const std::string& key, const std::string& json) {
  if (!members_.empty()) members_ += ",";
  members_ += json_text(key);
  members_ += ":";
  members_ += json;
  return *this;
}

std::string json_number(double value) {
  if (!std::isfinite(value)) return "null";
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return text.data();
}

JsonObject& JsonObject::number(const std::string& key, double value) { return raw(key, json_number(value)); }
JsonObject& JsonObject::integer(const std::string& key, long long value) { return raw(key, std::to_string(value)); }
JsonObject& JsonObject::flag(const std::string& key, bool value) { return raw(key, value ? "true" : "false"); }
JsonObject& JsonObject::text(const std::string& key, const std::string& value) { return raw(key, json_text(value)); }

std::string json_array(const std::vector<std::string>& elements) {
  std::string json = "[";
  for (const std::string& element : elements) {
    if (json.size() > 1) json += ",";
    json += element;
  }
  return json + "]";
}

}  // namespace pelorus
