#pragma once
// A YAML map read key by key: every problem is noted with file and line, reading goes on, and keys nobody asked for are
// problems too. Keeps the key that a value was read from in one place. Thread-bound.

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

namespace pelorus::synthetic {

class Problems {
 public:
  explicit Problems(std::string file) : file_(std::move(file)) {}
  void add(const YAML::Mark& mark, const std::string& what);
  [[nodiscard]] bool none() const { return lines_.empty(); }
  // One "file:line: what" per line.
  [[nodiscard]] std::string text() const;

 private:
  std::string file_;
  std::vector<std::string> lines_;
};

struct Limits {
  double low;
  double high;
};

class StrictMap {
 public:
  // `where` names the map in messages, as "seabed" or "bodies[2].path".
  StrictMap(YAML::Node node, std::string where, Problems& problems);
  StrictMap(const StrictMap&) = delete;
  StrictMap& operator=(const StrictMap&) = delete;
  // Notes the keys that were never read.
  ~StrictMap();

  // Each leaves the value as it is when the key is absent or bad.
  void number(const std::string& key, Limits limits, double& value);
  void integer(const std::string& key, Limits limits, int& value);
  void seed(const std::string& key, std::uint64_t& value);
  void text(const std::string& key, std::string& value);
  // [x, y, z]; every part within the limits.
  void vector3(const std::string& key, Limits limits, Eigen::Vector3d& value);
  // [x, y, z] or a list of such.
  void vectors3(const std::string& key, Limits limits, std::vector<Eigen::Vector3d>& values);
  // Calls read(map) if the key is present.
  void map(const std::string& key, const std::function<void(StrictMap&)>& read);
  // Calls read(map, index) for every entry of a list.
  void list(const std::string& key, const std::function<void(StrictMap&, std::size_t)>& read);

  [[nodiscard]] bool has(const std::string& key) const;
  void require(const std::string& key);
  // A problem at the place of a key, or of the map if the key is absent.
  void problem(const std::string& key, const std::string& what);

 private:
  [[nodiscard]] YAML::Node take(const std::string& key);
  [[nodiscard]] bool read_number(const YAML::Node& node, const std::string& key, Limits limits, double& value);
  [[nodiscard]] bool read_vector3(const YAML::Node& node, const std::string& key, Limits limits,
                                  Eigen::Vector3d& value);
  [[nodiscard]] std::string name_of(const std::string& key) const { return where_.empty() ? key : where_ + "." + key; }
  [[nodiscard]] std::string quoted(const std::string& key) const;

  YAML::Node node_;
  std::string where_;
  Problems& problems_;
  std::vector<std::string> asked_;
};

}  // namespace pelorus::synthetic
