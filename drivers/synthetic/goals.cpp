#include "drivers/synthetic/goals.h"

#include <cstdio>
#include <fstream>
#include <sstream>

#include "drivers/synthetic/strict_yaml.h"

namespace pelorus::synthetic {

void read_goals(StrictMap& map, Goals& goals) {
  for (const GoalField& field : kGoalFields) {
    double value = -1;
    map.number(field.key, {0, 1e6}, value);
    if (value >= 0) goals.*field.member = value;
  }
}

Result<Goals> load_goals(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  if (!file) return Error{ErrorCode::io, path, "cannot be read", "give the path of a file with goals, a YAML text"};
  Goals goals;
  Problems problems(path);
  try {
    StrictMap map(YAML::Load(text.str()), "", problems);
    read_goals(map, goals);
  } catch (const YAML::Exception& e) {
    problems.add(e.mark, "not valid YAML: " + e.msg);
  }
  if (problems.none()) return goals;
  return Error{ErrorCode::bad_configuration, "", problems.text(), ""};
}

std::string goals_yaml(const Goals& goals) {
  std::string text;
  for (const GoalField& field : kGoalFields) {
    const std::optional<double>& value = goals.*field.member;
    if (!value) continue;
    std::array<char, 96> line{};
    std::snprintf(line.data(), line.size(), "%s: %.12g\n", field.key, *value);
    text += line.data();
  }
  return text;
}

}  // namespace pelorus::synthetic
