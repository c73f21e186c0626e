#include "firmware-host/runtime/config_loader.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "firmware-host/runtime/config_fields.h"

namespace pelorus {
namespace {

// A line of one of the files.
struct Place {
  std::size_t file = 0;
  int line = 0;  // from 1; 0 = the file as a whole
};

struct Problem {
  Place place;
  std::string what;
  std::string cure;
};

int line_of(const YAML::Node& node) { return node.Mark().line + 1; }

// Number of single-character changes between two words (Levenshtein 1966).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

// A missing unit suffix is the commonest slip: max_range means max_range_m.
bool likely_meant(std::string_view given, std::string_view known) {
  return known.starts_with(given) || edit_distance(given, known) <= 1 + given.size() / 5;
}

std::string listed(const std::set<std::string_view>& words) {
  std::string text;
  for (std::string_view word : words) text.append(text.empty() ? "" : ", ").append(word);
  return text;
}

std::string suggestion(std::string_view given, const std::set<std::string_view>& known) {
  const auto meant = std::find_if(known.begin(), known.end(), [&](auto word) { return likely_meant(given, word); });
  if (meant != known.end()) return "did you mean '" + std::string(*meant) + "'?";
  return "known here: " + listed(known);
}

std::string number_text(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

template <class Number>
std::optional<Number> parse_number(const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// One after the other, each on top of those before it.
class FilesReader {
 public:
  explicit FilesReader(ServiceConfig& config) : fields_(service_fields(config)) {
    for (ConfigField& field : config_fields(config.pipeline)) fields_.push_back(std::move(field));
  }

  void read(std::size_t file, const std::string& path) {
    file_ = file;
    std::error_code ignored;
    try {
      // yaml-cpp would read a folder as an empty file.
      if (std::filesystem::is_directory(path, ignored)) return report_unreadable();
      read_documents(YAML::LoadAllFromFile(path));
    } catch (const YAML::BadFile&) {
      report_unreadable();
    } catch (const YAML::Exception& e) {
      all_known_ = false;
      problems_.push_back({{file_, e.mark.line + 1}, "not valid YAML: " + e.msg, "check indentation, colons and tabs"});
    }
  }

  // Between settings as all files make them. A setting that could not be read has nothing to contradict.
  void report_conflicts(const std::vector<ConfigConflict>& conflicts) {
    for (const ConfigConflict& conflict : conflicts) {
      Place place{file_, 0};  // no file names any of the keys
      bool all_read = all_known_;
      for (const std::string& key : conflict.keys) {
        all_read = all_read && !unread_.contains(key);
        if (const auto found = places_.find(key); place.line == 0 && found != places_.end()) place = found->second;
      }
      if (all_read) problems_.push_back({place, conflict.rule, conflict.cure});
    }
  }

  [[nodiscard]] bool unreadable() const { return unreadable_; }
  [[nodiscard]] const std::vector<Problem>& problems() const { return problems_; }

 private:
  void read_documents(const std::vector<YAML::Node>& documents) {
    if (documents.empty()) return;
    if (documents.size() > 1) report(documents[1], "a second document begins", "remove the '---' line");
    read_sections(documents[0]);
  }

  void report_unreadable() {
    unreadable_ = true;
    all_known_ = false;
    problems_.push_back({{file_, 0}, "cannot read the configuration file", "check path and rights"});
  }

  void report(const YAML::Node& where, std::string what, std::string cure) {
    problems_.push_back({{file_, line_of(where)}, std::move(what), std::move(cure)});
  }

  void read_sections(const YAML::Node& root) {
    if (root.IsNull()) return;  // every line commented out
    if (!root.IsMap()) return report(root, "the file is not a list of sections", "write 'section:' lines");
    std::set<std::string_view> sections;
    for (const ConfigField& field : fields_) sections.insert(field.section);
    std::set<std::string> seen;
    for (const auto& entry : root) {
      const std::string name = entry.first.Scalar();
      if (!seen.insert(name).second) report(entry.first, "section '" + name + "' is given twice", "keep one");
      if (!sections.contains(name)) {
        report(entry.first, "unknown section '" + name + "'", suggestion(name, sections));
      } else {
        read_section(name, entry.second);
      }
    }
  }

  void read_section(const std::string& section, const YAML::Node& entries) {
    if (entries.IsNull()) return;
    if (!entries.IsMap()) return report(entries, "section '" + section + "' holds no keys", "write 'key: value' lines");
    std::set<std::string> seen;
    for (const auto& entry : entries) {
      const std::string key = entry.first.Scalar();
      const auto field = std::find_if(fields_.begin(), fields_.end(), [&](const ConfigField& known) {
        return known.section == section && known.key == key;
      });
      if (!seen.insert(key).second) report(entry.first, "key '" + key + "' is given twice", "keep one");
      if (field == fields_.end()) {
        report_unknown_key(entry.first, section, key);
      } else {
        const std::size_t before = problems_.size();
        const std::string name = section + "." + key;
        places_.insert_or_assign(name, Place{file_, line_of(entry.first)});
        read_value(*field, entry.second);
        if (problems_.size() > before) {
          unread_.insert(name);
        } else {
          unread_.erase(name);
        }
      }
    }
  }

  void report_unknown_key(const YAML::Node& where, const std::string& section, const std::string& key) {
    std::set<std::string_view> known;
    for (const ConfigField& field : fields_) {
      if (field.section == section) known.insert(field.key);
      if (field.section != section && field.key == key) {
        return report(where, "unknown key '" + section + "." + key + "'",
                      "it belongs under '" + std::string(field.section) + "'");
      }
    }
    report(where, "unknown key '" + section + "." + key + "'", suggestion(key, known));
  }

  void read_value(const ConfigField& field, const YAML::Node& node) {
    const std::string name = std::string(field.section) + "." + std::string(field.key);
    // yaml-cpp marks text in quotes by the tag "!": a number in quotes is text.
    const bool plain = node.IsScalar() && node.Tag() != "!";
    const std::string text = node.IsScalar() ? node.Scalar() : "";
    if (bool* const* flag = std::get_if<bool*>(&field.value)) {
      if (plain && (text == "true" || text == "false")) {
        **flag = text == "true";
      } else {
        report(node, name + " is '" + text + "', not a switch", "write true or false");
      }
    } else if (std::string* const* words = std::get_if<std::string*>(&field.value)) {
      if (is_allowed_text(field, node, name, text)) **words = text;
    } else if (int* const* whole = std::get_if<int*>(&field.value)) {
      const std::optional<int> value = plain ? parse_number<int>(text) : std::nullopt;
      if (in_range(field, node, name, text, value, "a whole number")) **whole = *value;
    } else {
      const std::optional<double> value = plain ? parse_number<double>(text) : std::nullopt;
      if (in_range(field, node, name, text, value, "a number")) store(field, *value);
    }
  }

  bool is_allowed_text(const ConfigField& field, const YAML::Node& node, const std::string& name,
                       const std::string& text) {
    if (!node.IsScalar()) {
      report(node, name + " is not a text", "write one text, in quotes when it holds ': ' or ' #'");
      return false;
    }
    if (field.words.empty() || std::find(field.words.begin(), field.words.end(), text) != field.words.end())
      return true;
    report(node, name + " is '" + text + "'", suggestion(text, {field.words.begin(), field.words.end()}));
    return false;
  }

  static void store(const ConfigField& field, double value) {
    if (double* const* number = std::get_if<double*>(&field.value)) **number = value;
    if (float* const* number = std::get_if<float*>(&field.value)) **number = static_cast<float>(value);
  }

  template <class Number>
  bool in_range(const ConfigField& field, const YAML::Node& node, const std::string& name, const std::string& text,
                const std::optional<Number>& value, const std::string& kind) {
    const std::string range = number_text(field.low) + " to " + number_text(field.high);
    if (!value) {
      report(node, name + " is '" + text + "', not " + kind, "write " + kind + " from " + range + ", without quotes");
      return false;
    }
    const auto number = static_cast<double>(*value);
    if (number >= field.low && number <= field.high) return true;  // NaN is not
    report(node, name + " is " + text + ", out of range", "allowed: " + range);
    return false;
  }

  std::vector<ConfigField> fields_;
  std::vector<Problem> problems_;
  std::size_t file_ = 0;                 // being read
  std::map<std::string, Place> places_;  // of the keys, where they were given last
  std::set<std::string> unread_;         // keys whose last value is a problem
  bool all_known_ = true;                // no file is missing or broken as a whole
  bool unreadable_ = false;
};

Error to_error(const std::vector<std::string>& files, std::vector<Problem> problems, ErrorCode code) {
  std::stable_sort(problems.begin(), problems.end(), [](const Problem& a, const Problem& b) {
    return std::pair(a.place.file, a.place.line) < std::pair(b.place.file, b.place.line);
  });
  const auto place = [&](const Problem& p) {
    return p.place.line > 0 ? files[p.place.file] + ":" + std::to_string(p.place.line) : files[p.place.file];
  };
  if (problems.size() == 1) return {code, place(problems[0]), problems[0].what, problems[0].cure};
  std::string detail = std::to_string(problems.size()) + " problems";
  for (const Problem& p : problems) detail += "\n  " + place(p) + ": " + p.what + " (" + p.cure + ")";
  const bool of_one = problems.front().place.file == problems.back().place.file;
  return {code, of_one ? files[problems.front().place.file] : "configuration", detail, ""};
}

}  // namespace

Result<Ok> apply_config_files(const std::vector<std::string>& files, ServiceConfig& config, const ConfigRules& more) {
  if (files.empty()) return Ok{};
  ServiceConfig changed = config;
  FilesReader reader(changed);
  for (std::size_t i = 0; i < files.size(); ++i) reader.read(i, files[i]);
  reader.report_conflicts(config_conflicts(changed.pipeline));
  reader.report_conflicts(service_conflicts(changed));
  if (more && reader.problems().empty()) reader.report_conflicts(more(changed));
  if (!reader.problems().empty()) {
    return to_error(files, reader.problems(), reader.unreadable() ? ErrorCode::io : ErrorCode::bad_configuration);
  }
  config = changed;
  return Ok{};
}

Result<Ok> apply_config_files(const std::vector<std::string>& files, PipelineConfig& config) {
  ServiceConfig service;
  service.pipeline = config;
  if (Result<Ok> applied = apply_config_files(files, service); !applied) return applied;
  config = service.pipeline;
  return Ok{};
}

}  // namespace pelorus
