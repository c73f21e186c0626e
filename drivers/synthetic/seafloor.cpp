#include "drivers/synthetic/seafloor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/synthetic/seeded_hash.h"
#include "drivers/synthetic/value_noise.h"

namespace pelorus::synthetic {
namespace {

constexpr float kQuinticSlope = 1.875F;  // largest derivative of the quintic fade

struct OctaveFloats {
  float inverse_spacing, amplitude, c, s;
  std::uint32_t seed;
};

PELORUS_WIDE_LOOPS void add_octave(const OctaveFloats& octave, const float* __restrict x, const float* __restrict y,
                                   float* __restrict z, float* __restrict dz_dx, float* __restrict dz_dy, int size) {
  const float c = octave.c * octave.inverse_spacing;
  const float s = octave.s * octave.inverse_spacing;
  for (int i = 0; i < size; ++i) {
    const NoiseGradient2 n = value_noise_2d(c * x[i] + s * y[i], c * y[i] - s * x[i], octave.seed);
    z[i] -= octave.amplitude * n.value;
    dz_dx[i] -= octave.amplitude * (c * n.d_dx - s * n.d_dy);
    dz_dy[i] -= octave.amplitude * (s * n.d_dx + c * n.d_dy);
  }
}

}  // namespace

Seafloor::Seafloor(const Seabed& seabed, std::uint64_t scene_seed)
    : depth_m_(static_cast<float>(seabed.depth_m)),
      contrast_(static_cast<float>(seabed.contrast)),
      brightness_(static_cast<float>(seabed.brightness)) {
  SeededHash random(scene_seed, Purpose::terrain, 0);
  texture_seed_ = random.bits32();
  double spacing_m = 0.5 * seabed.relief_wavelength_m;
  double amplitude_m = 0.5 * seabed.relief_m;
  for (int i = 0; i < seabed.relief_octaves && seabed.relief_m > 0; ++i) {
    const double turn = random.uniform(0, 2.0 * std::numbers::pi);
    octaves_.push_back({static_cast<float>(1.0 / spacing_m),
                        static_cast<float>(amplitude_m),
                        {static_cast<float>(std::cos(turn)), static_cast<float>(std::sin(turn))},
                        random.bits32()});
    slope_bound_ += static_cast<float>(2.0 * std::numbers::sqrt2 * amplitude_m / spacing_m) * kQuinticSlope;
    // The amplitude falls a little faster than the spacing, so that short waves do not make cliffs.
    spacing_m *= 0.5;
    amplitude_m *= 0.42;
  }
}

void Seafloor::evaluate(const BatchFloats& x, const BatchFloats& y, int size, Heights& heights) const {
  heights.z.fill(depth_m_);
  heights.dz_dx.fill(0);
  heights.dz_dy.fill(0);
  for (const Octave& octave : octaves_) {
    add_octave({octave.inverse_spacing, octave.amplitude, octave.direction[0], octave.direction[1], octave.seed},
               x.data(), y.data(), heights.z.data(), heights.dz_dx.data(), heights.dz_dy.data(), size);
  }
}

float Seafloor::z_at(float x, float y) const {
  BatchFloats xs{};
  BatchFloats ys{};
  xs[0] = x;
  ys[0] = y;
  Heights heights;
  evaluate(xs, ys, 1, heights);
  return heights.z[0];
}

namespace {

void points_on_rays(const RayBatch& batch, BatchFloats& x, BatchFloats& y) {
  for (int i = 0; i < kBatch; ++i) {
    x[i] = batch.origin[0] + batch.t[i] * batch.dx[i];
    y[i] = batch.origin[1] + batch.t[i] * batch.dy[i];
  }
}

}  // namespace

void Seafloor::march(RayBatch& batch) const {
  constexpr int kMaxSteps = 96;
  constexpr float kNearEnoughM = 2e-3F;  // from here Newton settles
  BatchFloats approach;                  // largest rate at which a ray can close in on the seabed
  for (int i = 0; i < kBatch; ++i) {
    const float across = std::sqrt(batch.dx[i] * batch.dx[i] + batch.dy[i] * batch.dy[i]);
    approach[i] = batch.dz[i] + slope_bound_ * across;
    batch.t[i] = approach[i] > 0 ? 0.05F : kFarM;
  }
  BatchFloats x;
  BatchFloats y;
  Heights heights;
  bool moving = true;
  for (int step = 0; moving && step < kMaxSteps; ++step) {
    points_on_rays(batch, x, y);
    evaluate(x, y, batch.size, heights);
    moving = false;
    for (int i = 0; i < batch.size; ++i) {
      const float gap = heights.z[i] - (batch.origin[2] + batch.t[i] * batch.dz[i]);
      if (batch.t[i] >= kFarM || gap < kNearEnoughM) continue;
      batch.t[i] = std::min(kFarM, batch.t[i] + gap / approach[i]);
      moving = true;
    }
  }
  static_cast<void>(polish(batch));
}

bool Seafloor::polish(RayBatch& batch) const {
  constexpr int kSteps = 2;
  constexpr float kSettledM = 2e-5F;
  BatchFloats x;
  BatchFloats y;
  Heights heights;
  float worst = 0;
  for (int step = 0; step < kSteps; ++step) {
    points_on_rays(batch, x, y);
    evaluate(x, y, batch.size, heights);
    worst = 0;
    for (int i = 0; i < batch.size; ++i) {
      if (batch.t[i] >= kFarM) continue;
      const float gap = heights.z[i] - (batch.origin[2] + batch.t[i] * batch.dz[i]);
      const float rate = heights.dz_dx[i] * batch.dx[i] + heights.dz_dy[i] * batch.dy[i] - batch.dz[i];
      const float correction = std::clamp(gap / rate, -0.05F, 0.05F);
      batch.t[i] = std::max(0.0F, batch.t[i] - correction);
      worst = std::max(worst, std::abs(correction));
    }
  }
  // Newton squares the error: a last correction of kSettledM * 100 leaves less than kSettledM.
  return worst < 100.0F * kSettledM;
}

void Seafloor::describe_hits(RayBatch& batch) const {
  BatchFloats x;
  BatchFloats y;
  Heights heights;
  points_on_rays(batch, x, y);
  evaluate(x, y, batch.size, heights);
  for (int i = 0; i < batch.size; ++i) {
    const float scale =
        1.0F / std::sqrt(1.0F + heights.dz_dx[i] * heights.dz_dx[i] + heights.dz_dy[i] * heights.dz_dy[i]);
    batch.px[i] = x[i];
    batch.py[i] = y[i];
    batch.pz[i] = batch.origin[2] + batch.t[i] * batch.dz[i];
    batch.nx[i] = heights.dz_dx[i] * scale;
    batch.ny[i] = heights.dz_dy[i] * scale;
    batch.nz[i] = -scale;
    batch.seed[i] = texture_seed_;
    batch.contrast[i] = contrast_;
    batch.brightness[i] = brightness_;
    batch.key[i] = batch.t[i] >= kFarM ? kKeyWater : 0;
  }
}

void SeafloorView::resize(int width, int height) {
  // One node before and two after the picture: samples lie up to half a pixel outside.
  columns_ = width / kSpacing + 3;
  rows_ = height / kSpacing + 3;
  depth_.resize(static_cast<std::size_t>(node_count()));
  rough_.resize(depth_.size());
}

void SeafloorView::fill_positions(int first, RayBatch& batch) const {
  batch.size = std::min(kBatch, node_count() - first);
  for (int i = 0; i < kBatch; ++i) {
    const int node = std::min(first + i, node_count() - 1);
    batch.u[i] = static_cast<float>((node % columns_ - 1) * kSpacing);
    batch.v[i] = static_cast<float>((node / columns_ - 1) * kSpacing);
  }
}

void SeafloorView::store(int first, const RayBatch& batch) {
  std::copy_n(batch.t.begin(), batch.size, depth_.begin() + first);
}

void SeafloorView::find_rough_cells() {
  constexpr float kSmooth = 0.004F;  // second difference over depth; relief gives 0.002, a crest far more
  const auto depth = [&](int c, int r) {
    return depth_[static_cast<std::size_t>(std::clamp(r, 0, rows_ - 1) * columns_ + std::clamp(c, 0, columns_ - 1))];
  };
  const auto bent = [&](int c, int r) {
    const float t = depth(c, r);
    const float along_u = c > 0 && c < columns_ - 1 ? depth(c - 1, r) - 2.0F * t + depth(c + 1, r) : 0;
    const float along_v = r > 0 && r < rows_ - 1 ? depth(c, r - 1) - 2.0F * t + depth(c, r + 1) : 0;
    return t >= kFarM || std::max(std::abs(along_u), std::abs(along_v)) > kSmooth * t;
  };
  for (int r = 0; r < rows_; ++r) {
    for (int c = 0; c < columns_; ++c) {
      const bool rough = bent(c, r) || bent(c + 1, r) || bent(c, r + 1) || bent(c + 1, r + 1);
      rough_[static_cast<std::size_t>(r * columns_ + c)] = rough ? 1 : 0;
    }
  }
}

void SeafloorView::intersect(const Seafloor& floor, RayBatch& batch) const {
  bool rough = false;
  for (int i = 0; i < batch.size; ++i) {
    const float c = batch.u[i] / kSpacing + 1.0F;
    const float r = batch.v[i] / kSpacing + 1.0F;
    const int c0 = std::clamp(static_cast<int>(c), 0, columns_ - 2);
    const int r0 = std::clamp(static_cast<int>(r), 0, rows_ - 2);
    const float a = c - static_cast<float>(c0);
    const float b = r - static_cast<float>(r0);
    const std::size_t node = static_cast<std::size_t>(r0 * columns_ + c0);
    const float* row0 = &depth_[node];
    const float* row1 = row0 + columns_;
    batch.t[i] = (1.0F - b) * ((1.0F - a) * row0[0] + a * row0[1]) + b * ((1.0F - a) * row1[0] + a * row1[1]);
    rough = rough || rough_[node] != 0;
  }
  if (rough || !floor.polish(batch)) floor.march(batch);
}

}  // namespace pelorus::synthetic
