#include "core/frontend/surf_scale_space.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/base/check.h"
#include "core/kernels/box_hessian.h"
#include "core/kernels/local_maxima.h"

namespace pelorus {
namespace {

constexpr int kRowSlack = 16;                // hessian_row may write past the row
constexpr float kScalePerFilter = 1.2F / 9;  // the 9x9 filter stands for sigma 1.2 (Bay, section 3.3)

constexpr float kLeastOfMedian = 1.0F / 3;  // at 10 grey levels^2, clear pictures have medians above 30
constexpr int kCellPx = 16;                 // of the search for twins
constexpr float kTwinScales = 1.23F;        // ratio of scales: neighbouring filters of two octaves, 27/21 and less

int filter_size(int octave, int interval) { return 3 * ((2 << octave) * (interval + 1) + 1); }

ResponseLayer make_layer(const SurfConfig& config, int octave, int interval, int width, int height) {
  ResponseLayer layer;
  layer.filter_size = filter_size(octave, interval);
  layer.step = config.sampling_step << octave;
  layer.width = (width - 1) / layer.step + 1;
  layer.height = (height - 1) / layer.step + 1;
  layer.stride = layer.width + kRowSlack;
  const int reach = hessian_reach(layer.filter_size);
  layer.first = (reach + layer.step - 1) / layer.step;
  layer.last_u = (width - 1 - reach) / layer.step;
  layer.last_v = (height - 1 - reach) / layer.step;
  if (width - 1 < reach) layer.last_u = -1;
  if (height - 1 < reach) layer.last_v = -1;
  layer.response.assign(static_cast<std::size_t>(layer.stride * layer.height), 0.0F);
  return layer;
}

void compute(const IntegralImage& integral, ResponseLayer& layer) {
  const int count = layer.last_u - layer.first + 1;
  if (count <= 0) return;
  for (int j = layer.first; j <= layer.last_v; ++j) {
    float* row = layer.row(j) + layer.first;
    hessian_row(integral, layer.filter_size, layer.first * layer.step, j * layer.step, layer.step, count, row);
    std::fill_n(row + count, kRowSlack, 0.0F);
  }
}

// Every second sample of the same filter's layer one octave finer.
void take(const ResponseLayer& finer, ResponseLayer& layer) {
  for (int j = 0; j < layer.height; ++j) {
    const float* from = finer.row(2 * j);
    float* to = layer.row(j);
    for (int i = 0; i < layer.width; ++i) to[i] = from[2 * i];
  }
}

struct Neighbourhood {
  LayerRows rows;  // [layer below, this, above][row]; element [i] is the middle column

  Neighbourhood(const ResponseLayer& below, const ResponseLayer& middle, const ResponseLayer& above, int j) {
    const ResponseLayer* layers[3] = {&below, &middle, &above};
    for (int s = 0; s < 3; ++s) {
      for (int r = 0; r < 3; ++r) rows[s][r] = layers[s]->row(j + r - 1);
    }
  }
  [[nodiscard]] float at(int s, int r, int i) const { return rows[s + 1][r + 1][i]; }
};

struct Peak {
  bool inside = false;  // of the cell around the sample
  float du = 0, dv = 0, ds = 0;
  float gain = 0;  // of the value over that of the sample
};

// Quadratic through the neighbourhood (Brown & Lowe 2002): offset = -H^-1 g.
Peak interpolate(const Neighbourhood& n, int i) {
  const float value = n.at(0, 0, i);
  const float gu = 0.5F * (n.at(0, 0, i + 1) - n.at(0, 0, i - 1));
  const float gv = 0.5F * (n.at(0, 1, i) - n.at(0, -1, i));
  const float gs = 0.5F * (n.at(1, 0, i) - n.at(-1, 0, i));
  const float uu = n.at(0, 0, i + 1) + n.at(0, 0, i - 1) - 2 * value;
  const float vv = n.at(0, 1, i) + n.at(0, -1, i) - 2 * value;
  const float ss = n.at(1, 0, i) + n.at(-1, 0, i) - 2 * value;
  const float uv = 0.25F * (n.at(0, 1, i + 1) - n.at(0, 1, i - 1) - n.at(0, -1, i + 1) + n.at(0, -1, i - 1));
  const float us = 0.25F * (n.at(1, 0, i + 1) - n.at(1, 0, i - 1) - n.at(-1, 0, i + 1) + n.at(-1, 0, i - 1));
  const float vs = 0.25F * (n.at(1, 1, i) - n.at(1, -1, i) - n.at(-1, 1, i) + n.at(-1, -1, i));
  const float c_uu = vv * ss - vs * vs;
  const float c_uv = us * vs - uv * ss;
  const float c_us = uv * vs - us * vv;
  const float determinant = uu * c_uu + uv * c_uv + us * c_us;
  if (!(std::abs(determinant) > 1e-20F)) return {};
  const float scale = -1.0F / determinant;
  Peak peak;
  peak.du = scale * (c_uu * gu + c_uv * gv + c_us * gs);
  peak.dv = scale * (c_uv * gu + (uu * ss - us * us) * gv + (uv * us - uu * vs) * gs);
  peak.ds = scale * (c_us * gu + (uv * us - uu * vs) * gv + (uu * vv - uv * uv) * gs);
  peak.gain = 0.5F * (gu * peak.du + gv * peak.dv + gs * peak.ds);
  constexpr float kCell = 0.6F;  // a little over a half: a maximum between two samples must not be lost by both
  peak.inside = std::abs(peak.du) <= kCell && std::abs(peak.dv) <= kCell && std::abs(peak.ds) <= kCell;
  return peak;
}

bool stronger(const SurfScaleSpace::Candidate& p, const SurfScaleSpace::Candidate& q) {
  const SurfPoint& a = p.point;
  const SurfPoint& b = q.point;
  return std::tie(b.response, a.v_px, a.u_px, a.scale) < std::tie(a.response, b.v_px, b.u_px, b.scale);
}

bool are_twins(const SurfPoint& a, const SurfPoint& b) {
  const float du = a.u_px - b.u_px;
  const float dv = a.v_px - b.v_px;
  const float smaller = std::min(a.scale, b.scale);
  return du * du + dv * dv < smaller * smaller && std::max(a.scale, b.scale) < kTwinScales * smaller;
}

}  // namespace

SurfScaleSpace::SurfScaleSpace(const SurfConfig& config, int width, int height)
    : config_(config), cell_columns_(width / kCellPx + 1), cell_rows_(height / kCellPx + 1) {
  PELORUS_CHECK(config.octaves >= 1 && config.octaves <= 4, "SURF octaves must be 1..4");
  PELORUS_CHECK(config.intervals >= 3 && config.intervals <= 5, "SURF intervals must be 3..5");
  PELORUS_CHECK(config.max_points >= 1, "SURF needs room for points");
  for (int o = 0; o < config.octaves; ++o) {
    for (int i = 0; i < config.intervals; ++i) {
      layers_.push_back(make_layer(config, o, i, width, height));
      ResponseLayer& added = layers_.back();
      const int finer = (o - 1) * config.intervals;
      for (int k = 0; o > 0 && k < config.intervals; ++k) {
        if (layers_[static_cast<std::size_t>(finer + k)].filter_size == added.filter_size) added.same_as = finer + k;
      }
    }
  }
  candidates_.reserve(static_cast<std::size_t>(std::max(4 * config.max_points, 8192)));
  points_.reserve(static_cast<std::size_t>(config.max_points));
  columns_.resize(static_cast<std::size_t>(layers_.front().width));
  latest_in_cell_.resize(static_cast<std::size_t>(cell_columns_ * cell_rows_));
  before_.resize(candidates_.capacity());
}

const ResponseLayer& SurfScaleSpace::layer(int octave, int interval) const {
  return layers_[static_cast<std::size_t>(octave * config_.intervals + interval)];
}

void SurfScaleSpace::build(const IntegralImage& integral) {
  for (ResponseLayer& layer : layers_) {
    if (layer.same_as >= 0) {
      take(layers_[static_cast<std::size_t>(layer.same_as)], layer);
    } else {
      compute(integral, layer);
    }
  }
}

void SurfScaleSpace::find_in(int octave, int interval) {
  const ResponseLayer& below = layer(octave, interval - 1);
  const ResponseLayer& middle = layer(octave, interval);
  const ResponseLayer& above = layer(octave, interval + 1);
  const auto filter_step = static_cast<float>(6 << octave);
  const auto step = static_cast<float>(middle.step);
  const int first = above.first + 1;
  for (int j = first; j < above.last_v; ++j) {
    const Neighbourhood n(below, middle, above, j);
    const int found = local_maxima(n.rows, first, above.last_u - first,
                                   std::min(config_.threshold, config_.faint_threshold), columns_.data());
    for (int k = 0; k < found; ++k) {
      const int i = columns_[static_cast<std::size_t>(k)];
      const Peak peak = interpolate(n, i);
      if (!peak.inside) continue;
      Candidate candidate;
      candidate.point.u_px = (static_cast<float>(i) + peak.du) * step;
      candidate.point.v_px = (static_cast<float>(j) + peak.dv) * step;
      candidate.point.scale = kScalePerFilter * (static_cast<float>(middle.filter_size) + peak.ds * filter_step);
      candidate.point.response = n.at(0, 0, i) + peak.gain;
      candidate.filter_size = middle.filter_size;
      candidate.u = i * middle.step;
      candidate.v = j * middle.step;
      if (candidates_.size() == candidates_.capacity()) keep_strongest(candidates_.size() / 2);
      candidates_.push_back(candidate);
    }
  }
}

// Drops what cannot be among the answer any more; the order is total, so the result depends on nothing else.
void SurfScaleSpace::keep_strongest(std::size_t wanted) {
  if (candidates_.size() <= wanted) return;
  const auto end = candidates_.begin() + static_cast<std::ptrdiff_t>(wanted);
  std::nth_element(candidates_.begin(), end, candidates_.end(), stronger);
  candidates_.resize(wanted);
}

bool SurfScaleSpace::has_twin(const SurfPoint& point) const {
  const auto cell = [](float px, int cells) { return std::clamp(static_cast<int>(px) / kCellPx, 0, cells - 1); };
  const int last_row = cell(point.v_px + point.scale, cell_rows_);
  const int last_column = cell(point.u_px + point.scale, cell_columns_);
  for (int row = cell(point.v_px - point.scale, cell_rows_); row <= last_row; ++row) {
    for (int column = cell(point.u_px - point.scale, cell_columns_); column <= last_column; ++column) {
      auto k = latest_in_cell_[static_cast<std::size_t>(row * cell_columns_ + column)];
      for (; k >= 0; k = before_[static_cast<std::size_t>(k)]) {
        if (are_twins(candidates_[static_cast<std::size_t>(k)].point, point)) return true;
      }
    }
  }
  return false;
}

// Of candidates ordered by strength.
void SurfScaleSpace::drop_weak() {
  if (candidates_.empty() || config_.faint_threshold >= config_.threshold) return;
  const float median = candidates_[candidates_.size() / 2].point.response;
  const float least = std::clamp(kLeastOfMedian * median, config_.faint_threshold, config_.threshold);
  const auto weak = [least](const Candidate& c) { return c.point.response < least; };
  candidates_.erase(std::find_if(candidates_.begin(), candidates_.end(), weak), candidates_.end());
}

// Of candidates ordered by strength.
void SurfScaleSpace::drop_twins() {
  std::fill(latest_in_cell_.begin(), latest_in_cell_.end(), -1);
  std::size_t kept = 0;
  const auto wanted = static_cast<std::size_t>(config_.max_points);
  for (std::size_t k = 0; k < candidates_.size() && kept < wanted; ++k) {
    const Candidate candidate = candidates_[k];
    if (has_twin(candidate.point)) continue;
    const int row = std::clamp(static_cast<int>(candidate.point.v_px) / kCellPx, 0, cell_rows_ - 1);
    const int column = std::clamp(static_cast<int>(candidate.point.u_px) / kCellPx, 0, cell_columns_ - 1);
    std::int32_t& latest = latest_in_cell_[static_cast<std::size_t>(row * cell_columns_ + column)];
    before_[kept] = latest;
    latest = static_cast<std::int32_t>(kept);
    candidates_[kept++] = candidate;
  }
  candidates_.resize(kept);
}

// The finer octave finds the maxima of this layer too, and places them better.
bool SurfScaleSpace::searched_before(int octave, int interval) const {
  const int same = layer(octave, interval).same_as;
  if (same < 0 || !config_.distinct) return false;
  const int finer_interval = same % config_.intervals;
  return finer_interval > 0 && finer_interval + 1 < config_.intervals;
}

std::span<const SurfPoint> SurfScaleSpace::find_maxima(const IntegralImage& integral) {
  candidates_.clear();
  for (int o = 0; o < config_.octaves; ++o) {
    for (int i = 1; i + 1 < config_.intervals; ++i) {
      if (!searched_before(o, i)) find_in(o, i);
    }
  }
  const auto wanted = static_cast<std::size_t>(config_.max_points);
  keep_strongest(config_.distinct ? wanted + wanted / 2 : wanted);  // some are twins
  std::sort(candidates_.begin(), candidates_.end(), stronger);
  drop_weak();
  if (config_.distinct) drop_twins();
  points_.clear();
  for (const Candidate& c : candidates_) {
    points_.push_back(c.point);
    points_.back().laplacian = static_cast<std::int8_t>(laplacian_sign(integral, c.filter_size, c.u, c.v));
  }
  return points_;
}

}  // namespace pelorus
