#include "drivers/synthetic/marine_snow.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/synthetic/seeded_hash.h"

namespace pelorus::synthetic {
namespace {

constexpr double kCellM = 0.5;
constexpr double kReachM = 3.0;  // farther flakes are below a pixel and part of the veil
constexpr double kNearM = 0.2;

std::uint64_t cell_owner(const Eigen::Vector3i& cell) {
  std::uint64_t owner = 0;
  for (int axis = 0; axis < 3; ++axis) owner = owner << 21 | (static_cast<std::uint64_t>(cell[axis]) & 0x1fffff);
  return owner;
}

void add_cell(const Scene& scene, const Eigen::Vector3i& cell, double t_s, const Eigen::Vector3d& drift_m,
              std::vector<Flake>& flakes) {
  SeededHash random(scene.seed, Purpose::marine_snow, cell_owner(cell));
  const double expected = scene.water.snow_per_m3 * kCellM * kCellM * kCellM;
  const int count = static_cast<int>(expected + random.uniform());
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d part(random.uniform(), random.uniform(), random.uniform());
    const double share = random.uniform();
    // Each flake also wobbles in the eddies.
    const double turn = 2.0 * std::numbers::pi * (random.uniform() + t_s * random.uniform(0.1, 0.5));
    const Eigen::Vector3d wobble_m(0.02 * std::sin(turn), 0.02 * std::cos(turn), 0.01 * std::sin(2 * turn));
    Flake flake;
    flake.p_sea = ((cell.cast<double>() + part) * kCellM + drift_m + wobble_m).cast<float>();
    flake.size_m = static_cast<float>(scene.water.snow_size_m * (0.3 + 0.7 * share * share * share));
    flakes.push_back(flake);
  }
}

}  // namespace

std::vector<Flake> drifting_flakes(const Scene& scene, double t_s, const Rigid3& T_sea_cam) {
  std::vector<Flake> flakes;
  if (scene.water.snow_per_m3 <= 0) return flakes;
  const Eigen::Vector3d drift_m = scene.water.snow_drift_m_per_s * t_s * Eigen::Vector3d(0.75, 0.62, 0.22);
  Eigen::AlignedBox3d view(T_sea_cam.translation());
  for (int corner = 0; corner < 4; ++corner) {
    const double x = (corner & 1 ? 1 : -1) * 0.5 * scene.camera.width_px / scene.camera.f_px;
    const double y = (corner & 2 ? 1 : -1) * 0.5 * scene.camera.height_px / scene.camera.f_px;
    view.extend(T_sea_cam * (kReachM * Eigen::Vector3d(x, y, 1)));
  }
  const auto cell_of = [&](const Eigen::Vector3d& p) {
    return Eigen::Vector3i(((p - drift_m) / kCellM).array().floor().cast<int>());
  };
  const Eigen::Vector3i low = cell_of(view.min());
  const Eigen::Vector3i high = cell_of(view.max());
  Eigen::Vector3i cell;
  for (cell.z() = low.z(); cell.z() <= high.z(); ++cell.z())
    for (cell.y() = low.y(); cell.y() <= high.y(); ++cell.y())
      for (cell.x() = low.x(); cell.x() <= high.x(); ++cell.x()) add_cell(scene, cell, t_s, drift_m, flakes);
  return flakes;
}

namespace {

struct Spot {
  float u, v, depth_m;
  float sigma_px;
  float opacity;   // in the middle
  float radiance;  // of the flake
};

void draw_spot(const Spot& spot, Film& film) {
  const int reach = static_cast<int>(std::ceil(3.0F * spot.sigma_px));
  const int u_first = std::max(0, static_cast<int>(spot.u) - reach);
  const int u_last = std::min(film.width - 1, static_cast<int>(spot.u) + reach + 1);
  const int v_first = std::max(0, static_cast<int>(spot.v) - reach);
  const int v_last = std::min(film.height - 1, static_cast<int>(spot.v) + reach + 1);
  const float fall = -0.5F / (spot.sigma_px * spot.sigma_px);
  for (int v = v_first; v <= v_last; ++v) {
    for (int u = u_first; u <= u_last; ++u) {
      const std::size_t at = film.at(u, v);
      if (film.depth[at] < spot.depth_m) continue;
      const float du = static_cast<float>(u) - spot.u;
      const float dv = static_cast<float>(v) - spot.v;
      const float cover = spot.opacity * decay(fall * (du * du + dv * dv));
      film.radiance[at] += cover * (spot.radiance - film.radiance[at]);
    }
  }
}

}  // namespace

void draw_flakes(const std::vector<Flake>& flakes, const SceneCamera& camera, const Eigen::Vector3f& p_sea_cam,
                 const Eigen::Matrix3f& R_sea_cam, const Lighting& lighting, Film& film) {
  const auto f = static_cast<float>(camera.f_px);
  for (const Flake& flake : flakes) {
    const Eigen::Vector3f p_cam = R_sea_cam.transpose() * (flake.p_sea - p_sea_cam);
    if (p_cam.z() < static_cast<float>(kNearM) || p_cam.z() > static_cast<float>(kReachM)) continue;
    Spot spot{};
    spot.u = f * p_cam.x() / p_cam.z() + static_cast<float>(camera.cx_px());
    spot.v = f * p_cam.y() / p_cam.z() + static_cast<float>(camera.cy_px());
    spot.depth_m = p_cam.z();
    const float size_px = f * flake.size_m / p_cam.z();
    // Flakes close to the lens are out of focus.
    spot.sigma_px = 0.5F + 0.4F * size_px + 0.4F / p_cam.z();
    const float margin = 3.0F * spot.sigma_px;
    if (spot.u < -margin || spot.u > static_cast<float>(film.width) + margin || spot.v < -margin ||
        spot.v > static_cast<float>(film.height) + margin)
      continue;
    const float filled = size_px / (2.0F * spot.sigma_px);
    spot.opacity = 0.9F * std::min(1.0F, filled * filled);
    spot.radiance = std::min(1.5F, 0.9F * lighting.light_on_flake(flake.p_sea));
    draw_spot(spot, film);
  }
}

}  // namespace pelorus::synthetic
