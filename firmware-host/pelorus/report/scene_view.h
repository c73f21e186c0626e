#pragma once
// What of a reconstructed scene a page of bounded size shows: a plane to look down on, and evenly thinned points.
// Pure.

#include <Eigen/Core>
#include <vector>

#include "core/evaluation/records.h"
#include "firmware-host/pelorus/results/scene_reader.h"

namespace pelorus {

// Axes for pictures: x along the vehicle's way, z up. Up is the normal of the plane fitted to the static points, on the
// vehicle's side; without a plane (few points, or points as deep as wide) it is -y of the first camera.
struct ViewAxes {
  Eigen::Matrix3d R_view_world = Eigen::Matrix3d::Identity();
  bool from_plane = false;
};
[[nodiscard]] ViewAxes view_axes(const EstimatedRun& run, const std::vector<ScenePoint>& points);

// At most `limit` points, one per cube of a grid that is widened until they fit; of each cube the one seen most often.
[[nodiscard]] std::vector<ScenePoint> thinned(const std::vector<ScenePoint>& points, std::size_t limit);

}  // namespace pelorus
