#include "firmware-host/pelorus/report/scene_view.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

namespace pelorus {
namespace {

// A cloud is a plane when its thickness is below this part of its lesser width.
constexpr double kPlaneRatio = 0.35;
constexpr std::size_t kFewestPlanePoints = 20;

struct Plane {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

std::optional<Plane> plane_of(const std::vector<ScenePoint>& points) {
  Plane plane;
  std::size_t count = 0;
  for (const ScenePoint& point : points) {
    if (point.body != kWorldBody) continue;
    plane.center += point.p_body;
    ++count;
  }
  if (count < kFewestPlanePoints) return std::nullopt;
  plane.center /= static_cast<double>(count);
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const ScenePoint& point : points) {
    if (point.body != kWorldBody) continue;
    const Eigen::Vector3d d = point.p_body - plane.center;
    scatter += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);  // ascending
  const Eigen::Vector3d width = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  if (width(0) > kPlaneRatio * width(1)) return std::nullopt;
  plane.normal = solver.eigenvectors().col(0);
  return plane;
}

}  // namespace

ViewAxes view_axes(const EstimatedRun& run, const std::vector<ScenePoint>& points) {
  std::vector<Eigen::Vector3d> path;
  for (const EstimatedFrame& frame : run) {
    if (frame.T_world_cam) path.push_back(frame.T_world_cam->translation());
  }
  ViewAxes axes;
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();
  if (const std::optional<Plane> plane = plane_of(points)) {
    axes.from_plane = true;
    up = plane->normal;
    const Eigen::Vector3d vehicle = path.empty() ? Eigen::Vector3d::Zero() : path.front();
    if (up.dot(vehicle - plane->center) < 0) up = -up;
  }
  const auto level = [&up](const Eigen::Vector3d& v) { return Eigen::Vector3d(v - up * up.dot(v)); };
  constexpr double kTooShort_m = 1e-3;
  Eigen::Vector3d along = path.empty() ? Eigen::Vector3d::Zero() : level(path.back() - path.front());
  // A closed or level-less path: the way to its farthest point, else the camera's own x.
  for (const Eigen::Vector3d& p : path) {
    const Eigen::Vector3d candidate = level(p - path.front());
    if (along.norm() < 0.5 * candidate.norm()) along = candidate;
  }
  if (along.norm() < kTooShort_m) along = level(Eigen::Vector3d::UnitX());
  if (along.norm() < kTooShort_m) along = level(Eigen::Vector3d::UnitZ());
  along.normalize();
  axes.R_view_world.row(0) = along;
  axes.R_view_world.row(1) = up.cross(along);
  axes.R_view_world.row(2) = up;
  return axes;
}

std::vector<ScenePoint> thinned(const std::vector<ScenePoint>& points, std::size_t limit) {
  if (points.size() <= limit) return points;
  constexpr double kFirstCube_m = 0.01;
  for (double cube_m = kFirstCube_m;; cube_m *= 1.5) {
    std::map<std::array<std::int64_t, 3>, std::size_t> best;
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::array<std::int64_t, 3> cube{};
      for (int axis = 0; axis < 3; ++axis) {
        // Clamped: a point at infinity must not leave the range of the integers.
        cube[static_cast<std::size_t>(axis)] =
            std::llround(std::clamp(std::floor(points[i].p_body(axis) / cube_m), -1e15, 1e15));
      }
      const auto [entry, is_new] = best.try_emplace(cube, i);
      if (!is_new && points[i].views > points[entry->second].views) entry->second = i;
    }
    if (best.size() > std::max<std::size_t>(limit, 8)) continue;  // 8: the cubes that meet at the origin
    std::vector<ScenePoint> kept;
    for (const auto& [cube, index] : best) {
      if (kept.size() < limit) kept.push_back(points[index]);
    }
    return kept;
  }
}

}  // namespace pelorus
