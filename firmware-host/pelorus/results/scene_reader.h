#pragma once
// read_points, read_outlines: the reconstructed scene of a run (scene_writer.h) back from points.csv and outlines.csv.
// Points of the static scene are in `world`, points and outlines of a body in that body's frame `obj`. A run without
// the files (made before they existed, or by another system) has none. Errors name file and line. Thread-bound; holds
// the whole file.

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "core/base/ids.h"
#include "core/base/result.h"
#include "core/base/time.h"

namespace pelorus {

struct ScenePoint {
  BodyId body = kWorldBody;
  TrackId track;
  Eigen::Vector3d p_body = Eigen::Vector3d::Zero();  // world for the static scene, else obj
  double spread_m = 0;                               // deviation of the single views from p_body
  int views = 0;
  Timestamp first_seen;
  Timestamp last_seen;
  int gray = 0;  // mean brightness in the left image, 0..255
};

struct SceneOutline {
  Timestamp capture_time;
  BodyId body;
  std::vector<Eigen::Vector3d> corners_obj;  // in order around the outline
};

// In the order of the file: as the points ceased to be followed.
[[nodiscard]] Result<std::vector<ScenePoint>> read_points(const std::filesystem::path& folder);
// In order of time, then as published.
[[nodiscard]] Result<std::vector<SceneOutline>> read_outlines(const std::filesystem::path& folder);

}  // namespace pelorus
