#pragma once
// A small clean dive for tests: a quarter of the usual picture in each direction, no sensor noise, one static and one
// moving body. Quick enough for every test to render its own frames.

#include <cmath>
#include <optional>

#include "drivers/synthetic/synthetic_source.h"

namespace pelorus::synthetic {

inline PosePath path_through(std::vector<Eigen::Vector3d> p_sea, std::vector<Eigen::Vector3d> rpy_rad) {
  PosePath path;
  path.p_sea = std::move(p_sea);
  path.rpy_rad = std::move(rpy_rad);
  return path;
}

inline Scene small_dive() {
  Scene scene;
  scene.name = "small_dive";
  scene.seed = 3;
  scene.frames = 20;
  scene.camera.width_px = 320;
  scene.camera.height_px = 240;
  scene.camera.f_px = 250;
  scene.sensor.read_noise_grey = 0;
  scene.sensor.shot_noise = 0;
  scene.vehicle = path_through({{0, 0, 0}, {0.5, 0.05, 0.05}, {1.0, 0, 0}}, {{0, 0, 0}, {0.02, 0.02, 0.1}, {0, 0, 0}});
  Body pillar;
  pillar.name = "pillar";
  pillar.size_m = {0.5, 0.5, 0.8};
  pillar.path = path_through({{1.6, -0.7, 2.6}}, {{0.1, 0.2, 0.3}});
  Body crate;
  crate.name = "crate";
  crate.size_m = {0.7, 0.6, 0.5};
  crate.path = path_through({{0.9, 0.5, 2.5}, {1.3, 0.35, 2.45}, {1.8, 0.4, 2.5}},
                            {{0.1, 0, 0}, {0.2, 0.1, 0.25}, {0.3, 0.15, 0.5}});
  scene.bodies = {pillar, crate};
  return scene;
}

// Point of the surface seen at a pixel of the left image of the frame rendered last.
inline Eigen::Vector3d p_cam_at(const SyntheticSource& source, int u, int v) {
  const SceneCamera& camera = source.scene().camera;
  const double z = static_cast<double>(source.left_film().depth[source.left_film().at(u, v)]);
  return {(u - camera.cx_px()) * z / camera.f_px, (v - camera.cy_px()) * z / camera.f_px, z};
}

inline Eigen::Vector2d project(const SceneCamera& camera, const Eigen::Vector3d& p_cam) {
  return {camera.f_px * p_cam.x() / p_cam.z() + camera.cx_px(), camera.f_px * p_cam.y() / p_cam.z() + camera.cy_px()};
}

// Grey value between pixels (Catmull-Rom in both directions); nothing near the border.
inline std::optional<double> grey_at(const Image& image, const Eigen::Vector2d& uv) {
  const int u = static_cast<int>(std::floor(uv.x()));
  const int v = static_cast<int>(std::floor(uv.y()));
  if (u < 1 || v < 1 || u + 2 >= image.width() || v + 2 >= image.height()) return std::nullopt;
  const auto cubic = [](double p0, double p1, double p2, double p3, double s) {
    return p1 + 0.5 * s * (p2 - p0 + s * (2 * p0 - 5 * p1 + 4 * p2 - p3 + s * (3 * (p1 - p2) + p3 - p0)));
  };
  double line[4];
  for (int i = 0; i < 4; ++i) {
    const std::uint8_t* row = image.row(v - 1 + i);
    line[i] = cubic(row[u - 1], row[u], row[u + 1], row[u + 2], uv.x() - u);
  }
  return cubic(line[0], line[1], line[2], line[3], uv.y() - v);
}

}  // namespace pelorus::synthetic
