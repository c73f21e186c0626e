#include "drivers/synthetic/solids.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "drivers/synthetic/seeded_hash.h"
#include "drivers/synthetic/value_noise.h"

namespace pelorus::synthetic {
namespace {

// A solid seen from one camera position: ray origin in its own coordinates and the rotation into them.
struct LocalView {
  float ox, oy, oz;  // camera centre
  float hx, hy, hz;  // half sizes
  float r[9];        // R_sea_obj, row by row
  float contrast, brightness;
  std::uint32_t seed;
  std::int32_t key;
};

LocalView local_view(const Solid& solid, int index, const RayBatch& batch) {
  const Eigen::Vector3f o =
      solid.R_sea_obj.transpose() * (Eigen::Vector3f(batch.origin[0], batch.origin[1], batch.origin[2]) - solid.p_sea);
  LocalView view{o.x(),
                 o.y(),
                 o.z(),
                 solid.half_size_m.x(),
                 solid.half_size_m.y(),
                 solid.half_size_m.z(),
                 {},
                 solid.contrast,
                 solid.brightness,
                 solid.seed,
                 surface_key(index, 0)};
  for (int row = 0; row < 3; ++row)
    for (int col = 0; col < 3; ++col) view.r[3 * row + col] = solid.R_sea_obj(row, col);
  return view;
}

struct LocalHit {
  float t;           // > kFarM when missed
  float nx, ny, nz;  // normal, own coordinates
  std::int32_t face;
};

PELORUS_ALWAYS_INLINE LocalHit hit_box(const LocalView& s, float dx, float dy, float dz) {
  const float ix = 1.0F / dx;
  const float iy = 1.0F / dy;
  const float iz = 1.0F / dz;
  const float ex = -s.ox * ix - s.hx * std::abs(ix);  // entry into each slab
  const float ey = -s.oy * iy - s.hy * std::abs(iy);
  const float ez = -s.oz * iz - s.hz * std::abs(iz);
  const float lx = -s.ox * ix + s.hx * std::abs(ix);  // leaving it
  const float ly = -s.oy * iy + s.hy * std::abs(iy);
  const float lz = -s.oz * iz + s.hz * std::abs(iz);
  const float exy = ex > ey ? ex : ey;
  const float enter = exy > ez ? exy : ez;
  const float lxy = lx < ly ? lx : ly;
  const float leave = lxy < lz ? lxy : lz;
  const bool through_z = ez >= exy;
  const bool through_x = !through_z & (ex >= ey);
  const bool through_y = !through_z & !through_x;
  LocalHit hit;
  hit.t = choose(mask_of(enter < leave), enter, 2.0F * kFarM);
  hit.nx = choose(mask_of(through_x), choose(mask_of(dx > 0), -1.0F, 1.0F), 0.0F);
  hit.ny = choose(mask_of(through_y), choose(mask_of(dy > 0), -1.0F, 1.0F), 0.0F);
  hit.nz = choose(mask_of(through_z), choose(mask_of(dz > 0), -1.0F, 1.0F), 0.0F);
  const auto axis = static_cast<std::int32_t>(through_y) * 2 + static_cast<std::int32_t>(through_z) * 4;
  hit.face = axis + static_cast<std::int32_t>(hit.nx + hit.ny + hit.nz < 0);
  return hit;
}

PELORUS_ALWAYS_INLINE LocalHit hit_ellipsoid(const LocalView& s, float dx, float dy, float dz) {
  const float kx = 1.0F / s.hx;
  const float ky = 1.0F / s.hy;
  const float kz = 1.0F / s.hz;
  const float ax = dx * kx;
  const float ay = dy * ky;
  const float az = dz * kz;
  const float bx = s.ox * kx;
  const float by = s.oy * ky;
  const float bz = s.oz * kz;
  const float a = ax * ax + ay * ay + az * az;
  const float b = ax * bx + ay * by + az * bz;
  // Nearest point of the ray to the centre first: the textbook discriminant cancels for far, small ellipsoids.
  const float t_near = -b / a;
  const float cx = bx + t_near * ax;
  const float cy = by + t_near * ay;
  const float cz = bz + t_near * az;
  const float inside = 1.0F - (cx * cx + cy * cy + cz * cz);
  LocalHit hit;
  const std::uint32_t met = mask_of(inside > 0);
  hit.t = choose(met, t_near - std::sqrt(choose(met, inside, 0.0F) / a), 2.0F * kFarM);
  const float gx = (s.ox + hit.t * dx) * kx * kx;
  const float gy = (s.oy + hit.t * dy) * ky * ky;
  const float gz = (s.oz + hit.t * dz) * kz * kz;
  const float scale = 1.0F / std::sqrt(gx * gx + gy * gy + gz * gz);
  hit.nx = gx * scale;
  hit.ny = gy * scale;
  hit.nz = gz * scale;
  hit.face = 0;
  return hit;
}

template <class HitShape>
PELORUS_ALWAYS_INLINE void intersect_shape(const LocalView& view, RayBatch& __restrict batch,
                                           const HitShape& hit_shape) {
  const LocalView s = view;  // a copy that no store to the batch can change
  for (int i = 0; i < kBatch; ++i) {
    const float dx = s.r[0] * batch.dx[i] + s.r[3] * batch.dy[i] + s.r[6] * batch.dz[i];
    const float dy = s.r[1] * batch.dx[i] + s.r[4] * batch.dy[i] + s.r[7] * batch.dz[i];
    const float dz = s.r[2] * batch.dx[i] + s.r[5] * batch.dy[i] + s.r[8] * batch.dz[i];
    const LocalHit hit = hit_shape(s, dx, dy, dz);
    const std::uint32_t nearer = mask_of((hit.t < batch.t[i]) & (hit.t > 0.0F));
    batch.t[i] = choose(nearer, hit.t, batch.t[i]);
    batch.px[i] = choose(nearer, s.ox + hit.t * dx, batch.px[i]);
    batch.py[i] = choose(nearer, s.oy + hit.t * dy, batch.py[i]);
    batch.pz[i] = choose(nearer, s.oz + hit.t * dz, batch.pz[i]);
    batch.nx[i] = choose(nearer, s.r[0] * hit.nx + s.r[1] * hit.ny + s.r[2] * hit.nz, batch.nx[i]);
    batch.ny[i] = choose(nearer, s.r[3] * hit.nx + s.r[4] * hit.ny + s.r[5] * hit.nz, batch.ny[i]);
    batch.nz[i] = choose(nearer, s.r[6] * hit.nx + s.r[7] * hit.ny + s.r[8] * hit.nz, batch.nz[i]);
    batch.contrast[i] = choose(nearer, s.contrast, batch.contrast[i]);
    batch.brightness[i] = choose(nearer, s.brightness, batch.brightness[i]);
    batch.seed[i] = choose(nearer, s.seed, batch.seed[i]);
    batch.key[i] = static_cast<std::int32_t>(
        choose(nearer, static_cast<std::uint32_t>(s.key + hit.face), static_cast<std::uint32_t>(batch.key[i])));
  }
}

PELORUS_WIDE_LOOPS void intersect_box(const LocalView& view, RayBatch& batch) {
  intersect_shape(
      view, batch, [](const LocalView& s, float dx, float dy, float dz) __attribute__((always_inline)) {
        return hit_box(s, dx, dy, dz);
      });
}

PELORUS_WIDE_LOOPS void intersect_ellipsoid(const LocalView& view, RayBatch& batch) {
  intersect_shape(
      view, batch, [](const LocalView& s, float dx, float dy, float dz) __attribute__((always_inline)) {
        return hit_ellipsoid(s, dx, dy, dz);
      });
}

}  // namespace

void intersect(const Solid& solid, int index, RayBatch& batch) {
  const LocalView view = local_view(solid, index, batch);
  if (solid.shape == Shape::box) {
    intersect_box(view, batch);
  } else {
    intersect_ellipsoid(view, batch);
  }
}

ImageBounds image_bounds(const Solid& solid, const Eigen::Vector3f& p_sea_cam, const Eigen::Matrix3f& R_cam_sea,
                         const SceneCamera& camera) {
  constexpr float kNearM = 0.02F;
  const auto f = static_cast<float>(camera.f_px);
  const float infinity = std::numeric_limits<float>::infinity();
  ImageBounds bounds{infinity, -infinity, infinity, -infinity};
  int behind = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3f sign(corner & 1 ? 1.0F : -1.0F, corner & 2 ? 1.0F : -1.0F, corner & 4 ? 1.0F : -1.0F);
    const Eigen::Vector3f p_obj = sign.cwiseProduct(solid.half_size_m);
    const Eigen::Vector3f p_cam = R_cam_sea * (solid.R_sea_obj * p_obj + solid.p_sea - p_sea_cam);
    if (p_cam.z() < kNearM) {
      ++behind;
      continue;
    }
    const float u = f * p_cam.x() / p_cam.z() + static_cast<float>(camera.cx_px());
    const float v = f * p_cam.y() / p_cam.z() + static_cast<float>(camera.cy_px());
    bounds = {std::min(bounds.u_min, u - 1), std::max(bounds.u_max, u + 1), std::min(bounds.v_min, v - 1),
              std::max(bounds.v_max, v + 1)};
  }
  if (behind == 8) return {};
  if (behind > 0) return {-infinity, infinity, -infinity, infinity};
  return bounds;
}

std::vector<Solid> place_bodies(const Scene& scene, double t_s) {
  std::vector<Solid> solids;
  for (const Body& body : scene.bodies) {
    const Rigid3 T_sea_obj = body.path.T_sea_b(t_s);
    Solid solid;
    solid.shape = body.shape;
    solid.half_size_m = (0.5 * body.size_m).cast<float>();
    solid.R_sea_obj = T_sea_obj.linear().cast<float>();
    solid.p_sea = T_sea_obj.translation().cast<float>();
    solid.contrast = static_cast<float>(body.contrast);
    solid.brightness = static_cast<float>(body.brightness);
    solid.seed = SeededHash(scene.seed, Purpose::texture, solids.size()).bits32();
    solids.push_back(solid);
  }
  return solids;
}

namespace {

Solid rock_at(SeededHash& random, double x, double y, const Seabed& seabed, const Seafloor& floor) {
  // Many small stones, few large ones.
  const double share = random.uniform();
  const double size =
      seabed.rock_size_min_m + (seabed.rock_size_max_m - seabed.rock_size_min_m) * share * share * share;
  Solid rock;
  rock.shape = Shape::ellipsoid;
  for (int axis = 0; axis < 3; ++axis)
    rock.half_size_m[axis] = static_cast<float>(0.5 * size * random.uniform(0.6, 1.3));
  rock.half_size_m.z() *= 0.7F;
  const auto angle = [&](double limit) { return static_cast<float>(random.uniform(-limit, limit)); };
  rock.R_sea_obj = (Eigen::AngleAxisf(angle(3.14159), Eigen::Vector3f::UnitZ()) *
                    Eigen::AngleAxisf(angle(0.4), Eigen::Vector3f::UnitY()))
                       .toRotationMatrix();
  const auto fx = static_cast<float>(x);
  const auto fy = static_cast<float>(y);
  rock.p_sea = {fx, fy, floor.z_at(fx, fy) + 0.2F * rock.half_size_m.z()};
  rock.contrast = static_cast<float>(seabed.contrast * random.uniform(0.7, 1.2));
  rock.brightness = static_cast<float>(seabed.brightness * random.uniform(0.65, 1.25));
  rock.seed = random.bits32();
  rock.casts_shadow = false;
  return rock;
}

}  // namespace

std::vector<Solid> place_rocks(const Scene& scene, const Seafloor& floor) {
  std::vector<Solid> rocks;
  if (scene.seabed.rocks_per_m2 <= 0) return rocks;
  Eigen::AlignedBox2d area;
  for (int frame = 0; frame < scene.frames; ++frame) area.extend(scene.T_sea_cam(frame).translation().head<2>().eval());
  const double margin_m = 3.0 * scene.seabed.depth_m;
  // One stone at most per cell of a fixed lattice: the same stones whatever the path and the number of frames.
  const double cell_m = 1.0 / std::sqrt(scene.seabed.rocks_per_m2);
  const auto cell = [&](double x) { return static_cast<std::int32_t>(std::floor(x / cell_m)); };
  for (std::int32_t iy = cell(area.min().y() - margin_m); iy <= cell(area.max().y() + margin_m); ++iy) {
    for (std::int32_t ix = cell(area.min().x() - margin_m); ix <= cell(area.max().x() + margin_m); ++ix) {
      const auto owner = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(iy)) << 32) |
                         static_cast<std::uint64_t>(static_cast<std::uint32_t>(ix));
      SeededHash random(scene.seed, Purpose::rock, owner);
      const double x = (ix + random.uniform()) * cell_m;
      const double y = (iy + random.uniform()) * cell_m;
      rocks.push_back(rock_at(random, x, y, scene.seabed, floor));
    }
  }
  return rocks;
}

void shade_by(const Solid& solid, const Eigen::Vector3f& light, bool directional, const RayBatch& batch,
              const std::vector<Eigen::Vector3f>& p_sea_hits, BatchFloats& lit) {
  const Eigen::Vector3f scale = solid.half_size_m.cwiseInverse() * 0.85F;
  for (int i = 0; i < batch.size; ++i) {
    const Eigen::Vector3f& hit = p_sea_hits[static_cast<std::size_t>(i)];
    const Eigen::Vector3f to_light = directional ? light : Eigen::Vector3f(light - hit);
    const Eigen::Vector3f d = (solid.R_sea_obj.transpose() * to_light).cwiseProduct(scale);
    const Eigen::Vector3f o = (solid.R_sea_obj.transpose() * (hit - solid.p_sea)).cwiseProduct(scale);
    const float along = -o.dot(d) / d.squaredNorm();
    if (along <= 0 || (!directional && along >= 1)) continue;
    const float miss = (o + along * d).norm();  // 1 at the outline
    const float s = std::clamp((miss - 0.7F) / 0.6F, 0.0F, 1.0F);
    lit[i] *= s * s * (3.0F - 2.0F * s);
  }
}

}  // namespace pelorus::synthetic
