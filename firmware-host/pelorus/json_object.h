#pragma once
// JSON for scripts, written by hand-sized pieces; numbers that do not exist are null. Pure.

#include <string>
#include <vector>

namespace pelorus {

// One JSON object under construction; keys in the order they are added.
class JsonObject {
 public:
  JsonObject& number(const std::string& key, double value);  // null when not finite
  JsonObject& integer(const std::string& key, long long value);
  JsonObject& flag(const std::string& key, bool value);
  JsonObject& text(const std::string& key, const std::string& value);
  JsonObject& raw(const std::string& key, const std::string& json);
  [[nodiscard]] std::string str() const { return "{" + members_ + "}"; }

 private:
  std::string members_;
};

[[nodiscard]] std::string json_number(double value);           // null when not finite
[[nodiscard]] std::string json_text(const std::string& text);  // quotes and escapes added
[[nodiscard]] std::string json_array(const std::vector<std::string>& elements);

}  // namespace pelorus
