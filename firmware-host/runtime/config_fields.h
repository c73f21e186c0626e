#pragma once
// The table of configuration keys: section and key in the file, the setting it fills, the range it may have. Sections
// follow the stages; keys carry their unit (_px, _m, _s, _deg, ...), none means a count, a ratio or a chi-square.
// Adding a setting = its default in the stage's Config struct, one line in config_fields.cpp (pipeline) or
// service_fields.cpp (service), one in config/pelorus.yaml; a test compares the three. Pure.

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/pipeline/config.h"
#include "firmware-host/runtime/service_config.h"

namespace pelorus {

struct ConfigField {
  std::string_view section;
  std::string_view key;
  std::variant<bool*, int*, float*, double*, std::string*> value;  // into the settings given to ..._fields
  double low = 0;  // inclusive, in the unit of the key; unused for switches and text
  double high = 0;
  std::vector<std::string_view> words = {};  // of a text: what it may be; empty = anything
};

// Every setting of `config`, in the order of config/pelorus.yaml. Valid while `config` lives.
[[nodiscard]] std::vector<ConfigField> config_fields(PipelineConfig& config);

// The settings of the service around it (source, timing, buses), in the order of config/pelorus.yaml, without those of
// the pipeline. Valid while `config` lives.
[[nodiscard]] std::vector<ConfigField> service_fields(ServiceConfig& config);

// A rule between settings that does not hold.
struct ConfigConflict {
  std::vector<std::string> keys;  // "section.key", the one to look at first
  std::string rule;               // a sentence
  std::string cure;
};

// The rules that `config` breaks; empty when all hold.
[[nodiscard]] std::vector<ConfigConflict> config_conflicts(const PipelineConfig& config);
[[nodiscard]] std::vector<ConfigConflict> service_conflicts(const ServiceConfig& config);

}  // namespace pelorus
