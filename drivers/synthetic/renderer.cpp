#include "drivers/synthetic/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <thread>

#include "drivers/synthetic/lighting.h"
#include "drivers/synthetic/marine_snow.h"
#include "drivers/synthetic/row_workers.h"

namespace pelorus::synthetic {
namespace {

// Sub-pixel positions of the edge samples: eight rooks, so that no two share a row or a column.
constexpr int kEdgeSamples = 8;
constexpr std::array<float, kEdgeSamples> kEdgeU{-0.4375F, 0.1875F,  -0.1875F, 0.4375F,
                                                 0.0625F,  -0.3125F, 0.3125F,  -0.0625F};
constexpr std::array<float, kEdgeSamples> kEdgeV{-0.1875F, -0.4375F, 0.3125F, -0.0625F,
                                                 0.0625F,  0.1875F,  0.4375F, -0.3125F};
static_assert(kBatch % kEdgeSamples == 0);

}  // namespace

// One camera at one instant.
struct Renderer::View {
  const SceneCamera* camera = nullptr;
  Eigen::Vector3f p_sea_cam;
  Eigen::Matrix3f R_sea_cam;
  const std::vector<Solid>* solids = nullptr;
  std::vector<ImageBounds> bounds;
  SeafloorView seafloor;
  const Lighting* lighting = nullptr;

  void set_rays(RayBatch& batch) const {
    const auto inverse_f = static_cast<float>(1.0 / camera->f_px);
    const auto cx = static_cast<float>(camera->cx_px());
    const auto cy = static_cast<float>(camera->cy_px());
    const Eigen::Matrix3f& R = R_sea_cam;
    batch.origin = {p_sea_cam.x(), p_sea_cam.y(), p_sea_cam.z()};
    for (int i = 0; i < kBatch; ++i) {
      const float x = (batch.u[i] - cx) * inverse_f;
      const float y = (batch.v[i] - cy) * inverse_f;
      batch.dx[i] = R(0, 0) * x + R(0, 1) * y + R(0, 2);
      batch.dy[i] = R(1, 0) * x + R(1, 1) * y + R(1, 2);
      batch.dz[i] = R(2, 0) * x + R(2, 1) * y + R(2, 2);
    }
  }
};

Renderer::Renderer(const Scene& scene, int threads)
    : scene_(scene),
      threads_(threads > 0 ? threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()))),
      floor_(scene.seabed, scene.seed),
      texture_(scene.seed),
      rocks_(place_rocks(scene, floor_)) {}

void Renderer::render(int frame, Image& left, Image& right) {
  const Rigid3 T_sea_cam = scene_.T_sea_cam(frame);
  std::vector<Solid> solids = place_bodies(scene_, scene_.time_s(frame));
  solids.insert(solids.end(), rocks_.begin(), rocks_.end());
  const Lighting lighting(scene_, scene_.time_s(frame), T_sea_cam, solids);
  const std::vector<Flake> flakes = drifting_flakes(scene_, scene_.time_s(frame), T_sea_cam);
  for (int side = 0; side < 2; ++side) {
    const Eigen::Vector3d p_cam(side * scene_.camera.baseline_m, 0, 0);
    View view;
    view.camera = &scene_.camera;
    view.p_sea_cam = (T_sea_cam * p_cam).cast<float>();
    view.R_sea_cam = T_sea_cam.linear().cast<float>();
    view.solids = &solids;
    view.lighting = &lighting;
    for (const Solid& solid : solids)
      view.bounds.push_back(image_bounds(solid, view.p_sea_cam, view.R_sea_cam.transpose(), scene_.camera));
    view.seafloor.trace(floor_, scene_.camera.width_px, scene_.camera.height_px,
                        [&](RayBatch& batch) { view.set_rays(batch); });
    render_view(view, film_[side]);
    if (scene_.water.blur_px_per_m > 0) blur_by_depth(scene_.water.blur_px_per_m, threads_, film_[side]);
    draw_flakes(flakes, scene_.camera, view.p_sea_cam, view.R_sea_cam, lighting, film_[side]);
    const auto shot = 2 * static_cast<std::uint64_t>(frame) + static_cast<std::uint64_t>(side);
    expose(film_[side], scene_.sensor, scene_.seed, shot, threads_, side == 0 ? left : right);
  }
  count_visible();
}

void Renderer::render_view(const View& view, Film& film) {
  film.resize(scene_.camera.width_px, scene_.camera.height_px);
  for_each_row(film.height, threads_, [&](int v) { trace_row(view, v, film); });
  // Edges read their neighbours' keys and depths but write radiance only: rows stay independent.
  for_each_row(film.height, threads_, [&](int v) { smooth_edges(view, v, film); });
}

void Renderer::shade(const View& view, RayBatch& batch) const {
  for (int i = batch.size; i < kBatch; ++i) {  // vector loops run over whole batches
    batch.u[i] = batch.u[batch.size - 1];
    batch.v[i] = batch.v[batch.size - 1];
  }
  const int used = batch.size;
  batch.size = kBatch;
  view.set_rays(batch);
  view.seafloor.intersect(floor_, batch);
  floor_.describe_hits(batch);
  const auto [u_min, u_max] = std::minmax_element(batch.u.begin(), batch.u.end());
  const auto [v_min, v_max] = std::minmax_element(batch.v.begin(), batch.v.end());
  for (std::size_t k = 0; k < view.bounds.size(); ++k) {
    const ImageBounds& b = view.bounds[k];
    if (*u_max < b.u_min || *u_min > b.u_max || *v_max < b.v_min || *v_min > b.v_max) continue;
    intersect((*view.solids)[k], static_cast<int>(k), batch);
  }
  const auto per_px = static_cast<float>(1.0 / scene_.camera.f_px);
  for (int i = 0; i < kBatch; ++i) {
    const float across = batch.dx[i] * batch.nx[i] + batch.dy[i] * batch.ny[i] + batch.dz[i] * batch.nz[i];
    const float ray2 = batch.dx[i] * batch.dx[i] + batch.dy[i] * batch.dy[i] + batch.dz[i] * batch.dz[i];
    const float slant = std::max(std::abs(across), 0.1F * std::sqrt(ray2));
    // Between the shorter and the longer axis of what the pixel covers: the longer one alone smears slanted faces.
    const float shorter = batch.t[i] * per_px * std::sqrt(ray2);
    batch.footprint[i] = shorter * std::sqrt(std::sqrt(ray2) / slant);
  }
  texture_.paint(batch);
  view.lighting->illuminate(batch);
  batch.size = used;
}

void Renderer::trace_row(const View& view, int v, Film& film) const {
  RayBatch batch;
  for (int first = 0; first < film.width; first += kBatch) {
    batch.size = std::min(kBatch, film.width - first);
    for (int i = 0; i < batch.size; ++i) {
      batch.u[i] = static_cast<float>(first + i);
      batch.v[i] = static_cast<float>(v);
    }
    shade(view, batch);
    const auto at = static_cast<std::ptrdiff_t>(film.at(first, v));
    std::copy_n(batch.radiance.begin(), batch.size, film.radiance.begin() + at);
    std::copy_n(batch.t.begin(), batch.size, film.depth.begin() + at);
    std::copy_n(batch.key.begin(), batch.size, film.keys.begin() + at);
  }
}

namespace {

// Surfaces meet at this pixel, or the seabed hides itself.
bool is_edge(const Film& film, int u, int v) {
  const std::size_t here = film.at(u, v);
  const std::int32_t key = film.keys[here];
  const float depth = film.depth[here];
  const auto differs = [&](int du, int dv) {
    const int un = u + du;
    const int vn = v + dv;
    if (un < 0 || un >= film.width || vn < 0 || vn >= film.height) return false;
    const std::size_t there = film.at(un, vn);
    return film.keys[there] != key || std::abs(film.depth[there] - depth) > 0.02F * depth;
  };
  return differs(-1, 0) || differs(1, 0) || differs(0, -1) || differs(0, 1);
}

}  // namespace

void Renderer::smooth_edges(const View& view, int v, Film& film) const {
  constexpr int kPixels = kBatch / kEdgeSamples;
  RayBatch batch;
  std::array<int, kPixels> columns{};
  int pixels = 0;
  const auto flush = [&] {
    batch.size = pixels * kEdgeSamples;
    if (pixels > 0) shade(view, batch);
    for (int p = 0; p < pixels; ++p) {
      float sum = 0;
      for (int s = 0; s < kEdgeSamples; ++s) sum += batch.radiance[p * kEdgeSamples + s];
      film.radiance[film.at(columns[static_cast<std::size_t>(p)], v)] = sum / kEdgeSamples;
    }
    pixels = 0;
  };
  for (int u = 0; u < film.width; ++u) {
    if (!is_edge(film, u, v)) continue;
    columns[static_cast<std::size_t>(pixels)] = u;
    for (std::size_t s = 0; s < kEdgeSamples; ++s) {
      const std::size_t i = static_cast<std::size_t>(pixels * kEdgeSamples) + s;
      batch.u[i] = static_cast<float>(u) + kEdgeU[s];
      batch.v[i] = static_cast<float>(v) + kEdgeV[s];
    }
    if (++pixels == kPixels) flush();
  }
  flush();
}

void Renderer::count_visible() {
  visible_px_.assign(scene_.bodies.size(), 0);
  const int bodies = static_cast<int>(scene_.bodies.size());
  for (const std::int32_t key : film_[0].keys) {
    const int solid = key == kKeyWater ? -1 : solid_of_key(key);
    if (solid >= 0 && solid < bodies) ++visible_px_[static_cast<std::size_t>(solid)];
  }
}

}  // namespace pelorus::synthetic
