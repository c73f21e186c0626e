#include "core/frontend/surf_match.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/kernels/descriptor_distance.h"

namespace pelorus {

bool SurfGate::admits(const SurfPoint& point, const SurfPoint& partner) const {
  const float du = partner.u_px - point.u_px;
  const float dv = partner.v_px - point.v_px;
  return du >= min_du_px && du <= max_du_px && dv >= min_dv_px && dv <= max_dv_px &&
         du * du + dv * dv <= radius_px * radius_px;
}

SurfGate stereo_gate(float row_band_px, float min_disparity_px, float max_disparity_px) {
  SurfGate gate;
  gate.min_du_px = -max_disparity_px;
  gate.max_du_px = -min_disparity_px;
  gate.min_dv_px = -row_band_px;
  gate.max_dv_px = row_band_px;
  return gate;
}

SurfGate temporal_gate(float radius_px) {
  SurfGate gate;
  gate.radius_px = radius_px;
  return gate;
}

void SurfMatcher::Nearest::offer(float square, std::int32_t candidate) {
  if (square < best) {
    second_best = best;
    best = square;
    index = candidate;
  } else if (square < second_best) {
    second_best = square;
  }
}

SurfMatcher::SurfMatcher(const SurfMatchConfig& config) : config_(config) {
  PELORUS_CHECK(config.max_points > 0, "the matcher needs room for points");
  const auto room = static_cast<std::size_t>(config.max_points);
  of_first_.reserve(room);
  of_second_.reserve(room);
  matches_.reserve(room);
}

std::span<const SurfMatch> SurfMatcher::match(std::span<const SurfPoint> first,
                                              std::span<const SurfDescriptor> first_descriptors,
                                              std::span<const SurfPoint> second,
                                              std::span<const SurfDescriptor> second_descriptors,
                                              const SurfGate& gate) {
  PELORUS_CHECK(first_descriptors.size() >= first.size() && second_descriptors.size() >= second.size(),
                "a descriptor for every point");
  const auto room = static_cast<std::size_t>(config_.max_points);
  first = first.first(std::min(first.size(), room));
  second = second.first(std::min(second.size(), room));
  of_first_.assign(first.size(), {});
  of_second_.assign(second.size(), {});
  for (std::size_t i = 0; i < first.size(); ++i) {
    for (std::size_t j = 0; j < second.size(); ++j) {
      if (first[i].laplacian != second[j].laplacian || !gate.admits(first[i], second[j])) continue;
      const float square = squared_distance(first_descriptors[i], second_descriptors[j]);
      of_first_[i].offer(square, static_cast<std::int32_t>(j));
      of_second_[j].offer(square, static_cast<std::int32_t>(i));
    }
  }
  matches_.clear();
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Nearest& nearest = of_first_[i];
    if (nearest.index < 0) continue;
    const Nearest& back = of_second_[static_cast<std::size_t>(nearest.index)];
    if (back.index != static_cast<std::int32_t>(i)) continue;
    // The rival may stand on either side.
    const float rival = std::min(nearest.second_best, back.second_best);
    const float distance = std::sqrt(nearest.best);
    const float ratio = std::isinf(rival) || rival <= 0 ? 0.0F : distance / std::sqrt(rival);
    if (distance > config_.max_distance || ratio > config_.max_ratio) continue;
    if (rival <= 0) continue;  // two identical partners: no telling
    matches_.push_back({static_cast<std::int32_t>(i), nearest.index, distance, ratio});
  }
  return matches_;
}

}  // namespace pelorus
