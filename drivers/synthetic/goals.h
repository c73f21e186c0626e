#pragma once
// Goals: the limits that errors on a recording are held to, each only where it is known. They belong to the recording:
// clear and turbid water, a street and a basin are not judged alike. In a scene file under `goals`, and as goals.yaml
// beside the truth of a data set; keys are the members' names. Pure, but for load_goals.

#include <array>
#include <optional>
#include <string>

#include "core/base/result.h"

namespace pelorus::synthetic {

class StrictMap;

struct Goals {
  std::optional<double> camera_step_m;           // mean error of a step
  std::optional<double> camera_step_rmse_m;      // RPE
  std::optional<double> camera_step_rmse_deg;    //
  std::optional<double> camera_absolute_m;       // mean absolute error
  std::optional<double> camera_absolute_path_m;  // longest path that camera_absolute_m was set for
  std::optional<double> camera_absolute_max_m;
  std::optional<double> camera_absolute_max_deg;
  std::optional<double> camera_drift_percent;  // final drift over the path, KITTI drift
  std::optional<double> body_step_m;           // median error of a body's step
  std::optional<double> body_step_deg;
  std::optional<double> body_since_birth_m;  // mean error since a body's birth
  std::optional<double> body_since_birth_deg;
  std::optional<double> body_coverage_percent;  // at least
  std::optional<double> right_count_percent;    // of motions, at least
  std::optional<double> false_objects;          // at most
  bool operator==(const Goals&) const = default;
};

struct GoalField {
  const char* key;
  std::optional<double> Goals::*member;
};

inline constexpr std::array<GoalField, 15> kGoalFields = {{
    {"camera_step_m", &Goals::camera_step_m},
    {"camera_step_rmse_m", &Goals::camera_step_rmse_m},
    {"camera_step_rmse_deg", &Goals::camera_step_rmse_deg},
    {"camera_absolute_m", &Goals::camera_absolute_m},
    {"camera_absolute_path_m", &Goals::camera_absolute_path_m},
    {"camera_absolute_max_m", &Goals::camera_absolute_max_m},
    {"camera_absolute_max_deg", &Goals::camera_absolute_max_deg},
    {"camera_drift_percent", &Goals::camera_drift_percent},
    {"body_step_m", &Goals::body_step_m},
    {"body_step_deg", &Goals::body_step_deg},
    {"body_since_birth_m", &Goals::body_since_birth_m},
    {"body_since_birth_deg", &Goals::body_since_birth_deg},
    {"body_coverage_percent", &Goals::body_coverage_percent},
    {"right_count_percent", &Goals::right_count_percent},
    {"false_objects", &Goals::false_objects},
}};

void read_goals(StrictMap& map, Goals& goals);
// A file that holds the keys alone.
[[nodiscard]] Result<Goals> load_goals(const std::string& path);
// What load_goals reads; empty without goals.
[[nodiscard]] std::string goals_yaml(const Goals& goals);

}  // namespace pelorus::synthetic
