#include "drivers/synthetic/strict_yaml.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace pelorus::synthetic {
namespace {

std::string shown(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

}  // namespace

void Problems::add(const YAML::Mark& mark, const std::string& what) {
  lines_.push_back(file_ + ":" + std::to_string(std::max(0, mark.line) + 1) + ": " + what);
}

std::string Problems::text() const {
  std::string all;
  for (const std::string& line : lines_) all += (all.empty() ? "" : "\n") + line;
  return all;
}

// Built by appending: GCC 12 sees a false overlap in "text" + string (its bug 105651).
std::string StrictMap::quoted(const std::string& key) const {
  std::string text("'");
  text += name_of(key);
  text += "'";
  return text;
}

StrictMap::StrictMap(YAML::Node node, std::string where, Problems& problems)
    : node_(std::move(node)), where_(std::move(where)), problems_(problems) {
  if (node_.IsMap()) return;
  problems_.add(node_.Mark(),
                (where_.empty() ? std::string("the file") : where_) + " has to be a list of 'key: value'");
  node_ = YAML::Node(YAML::NodeType::Map);
}

StrictMap::~StrictMap() {
  std::vector<std::string> seen;
  for (const auto& entry : node_) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "?";
    if (std::find(seen.begin(), seen.end(), key) != seen.end()) {
      problems_.add(entry.first.Mark(), quoted(key) + " is given twice: remove one");
    }
    seen.push_back(key);
    if (std::find(asked_.begin(), asked_.end(), key) != asked_.end()) continue;
    std::string known;
    for (const std::string& name : asked_) known += (known.empty() ? "" : ", ") + name;
    problems_.add(entry.first.Mark(), std::string("unknown key ") + quoted(key) + "; known here: " + known);
  }
}

YAML::Node StrictMap::take(const std::string& key) {
  if (std::find(asked_.begin(), asked_.end(), key) == asked_.end()) asked_.push_back(key);
  const YAML::Node& fixed = node_;  // operator[] of a non-const node would add the key
  return fixed[key];
}

bool StrictMap::has(const std::string& key) const {
  const YAML::Node& fixed = node_;
  return fixed[key].IsDefined();
}

void StrictMap::require(const std::string& key) {
  if (!has(key)) problems_.add(node_.Mark(), quoted(key) + " is missing: add it");
}

void StrictMap::problem(const std::string& key, const std::string& what) {
  problems_.add(has(key) ? take(key).Mark() : node_.Mark(), quoted(key) + " " + what);
}

bool StrictMap::read_number(const YAML::Node& node, const std::string& key, Limits limits, double& value) {
  double number = 0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, number) || !std::isfinite(number)) {
    problems_.add(node.Mark(), quoted(key) + " has to be a number");
    return false;
  }
  if (number < limits.low || number > limits.high) {
    problems_.add(node.Mark(), quoted(key) + " is " + shown(number) + ": give a value from " + shown(limits.low) +
                                   " to " + shown(limits.high));
    return false;
  }
  value = number;
  return true;
}

void StrictMap::number(const std::string& key, Limits limits, double& value) {
  const YAML::Node node = take(key);
  if (node.IsDefined()) static_cast<void>(read_number(node, key, limits, value));
}

void StrictMap::integer(const std::string& key, Limits limits, int& value) {
  const YAML::Node node = take(key);
  double number = value;
  if (!node.IsDefined() || !read_number(node, key, limits, number)) return;
  if (number != std::floor(number)) {
    problems_.add(node.Mark(), quoted(key) + " has to be a whole number");
    return;
  }
  value = static_cast<int>(number);
}

void StrictMap::seed(const std::string& key, std::uint64_t& value) {
  const YAML::Node node = take(key);
  if (!node.IsDefined()) return;
  if (!node.IsScalar() || node.Scalar().starts_with('-') || !YAML::convert<std::uint64_t>::decode(node, value))
    problems_.add(node.Mark(), quoted(key) + " has to be a whole number from 0 to 2^64 - 1");
}

void StrictMap::text(const std::string& key, std::string& value) {
  const YAML::Node node = take(key);
  if (!node.IsDefined()) return;
  if (node.IsScalar()) {
    value = node.Scalar();
  } else {
    problems_.add(node.Mark(), quoted(key) + " has to be a word");
  }
}

bool StrictMap::read_vector3(const YAML::Node& node, const std::string& key, Limits limits, Eigen::Vector3d& value) {
  if (!node.IsSequence() || node.size() != 3) {
    problems_.add(node.Mark(), quoted(key) + " has to be three numbers in brackets, as [1.0, 0.0, 2.5]");
    return false;
  }
  bool good = true;
  for (std::size_t i = 0; i < 3; ++i)
    good = read_number(node[i], key, limits, value[static_cast<Eigen::Index>(i)]) && good;
  return good;
}

void StrictMap::vector3(const std::string& key, Limits limits, Eigen::Vector3d& value) {
  const YAML::Node node = take(key);
  if (node.IsDefined()) static_cast<void>(read_vector3(node, key, limits, value));
}

void StrictMap::vectors3(const std::string& key, Limits limits, std::vector<Eigen::Vector3d>& values) {
  const YAML::Node node = take(key);
  if (!node.IsDefined()) return;
  std::vector<Eigen::Vector3d> read;
  const bool nested = node.IsSequence() && node.size() > 0 && node[0].IsSequence();
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  if (!nested) {
    if (read_vector3(node, key, limits, value)) values = {value};
    return;
  }
  for (std::size_t i = 0; i < node.size(); ++i) {
    if (!read_vector3(node[i], key + "[" + std::to_string(i) + "]", limits, value)) return;
    read.push_back(value);
  }
  values = read;
}

void StrictMap::map(const std::string& key, const std::function<void(StrictMap&)>& read) {
  const YAML::Node node = take(key);
  if (!node.IsDefined()) return;
  StrictMap inner(node, name_of(key), problems_);
  read(inner);
}

void StrictMap::list(const std::string& key, const std::function<void(StrictMap&, std::size_t)>& read) {
  const YAML::Node node = take(key);
  if (!node.IsDefined()) return;
  if (!node.IsSequence()) {
    problems_.add(node.Mark(), quoted(key) + " has to be a list, each entry starting with '- '");
    return;
  }
  for (std::size_t i = 0; i < node.size(); ++i) {
    StrictMap inner(node[i], name_of(key) + "[" + std::to_string(i) + "]", problems_);
    read(inner, i);
  }
}

}  // namespace pelorus::synthetic
