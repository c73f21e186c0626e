#pragma once
// FieldList: how the tables of configuration keys are written down, section by section. Pure.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware-host/runtime/config_fields.h"

namespace pelorus {

class FieldList {
 public:
  void section(std::string_view name) { section_ = name; }
  void add(std::string_view key, bool& value) { fields_.push_back({section_, key, &value}); }
  template <class Number>
  void add(std::string_view key, Number& value, double low, double high) {
    fields_.push_back({section_, key, &value, low, high});
  }
  // A text; `words`: all it may be, none = anything.
  void add(std::string_view key, std::string& value, std::vector<std::string_view> words = {}) {
    fields_.push_back({section_, key, &value, 0, 0, std::move(words)});
  }
  std::vector<ConfigField> take() { return std::move(fields_); }

 private:
  std::string_view section_;
  std::vector<ConfigField> fields_;
};

}  // namespace pelorus
