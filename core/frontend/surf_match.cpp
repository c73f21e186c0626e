#include "core/frontend/surf_match.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/base/check.h"

namespace pelorus {

void SurfMatcher::Nearest::offer(float square, std::int32_t candidate) {
  if (square < best || (square == best && candidate < index)) {
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
  order_.reserve(room);
  blocks_.resize(room / kBlockDescriptors + 3);  // each sign may leave one block half full
}

// Ordered by Laplacian sign, then row, so that whole blocks lie out of reach.
void SurfMatcher::fill_blocks(std::span<const SurfPoint> second, std::span<const SurfDescriptor> descriptors) {
  order_.resize(second.size());
  std::iota(order_.begin(), order_.end(), 0);
  const auto at = [&](std::int32_t i) -> const SurfPoint& { return second[static_cast<std::size_t>(i)]; };
  std::sort(order_.begin(), order_.end(), [&](std::int32_t a, std::int32_t b) {
    return std::tie(at(a).laplacian, at(a).v_px, a) < std::tie(at(b).laplacian, at(b).v_px, b);
  });
  blocks_size_ = 0;
  for (const std::int32_t i : order_) {
    const bool fits = blocks_size_ > 0 && blocks_[blocks_size_ - 1].size < kBlockDescriptors &&
                      blocks_[blocks_size_ - 1].laplacian == at(i).laplacian;
    if (!fits) {
      Block& fresh = blocks_[blocks_size_++];
      fresh.size = 0;
      fresh.laplacian = at(i).laplacian;
      fresh.first_v_px = at(i).v_px;
    }
    Block& block = blocks_[blocks_size_ - 1];
    block.descriptors.set(block.size, descriptors[static_cast<std::size_t>(i)]);
    block.index[block.size++] = i;
    block.last_v_px = at(i).v_px;
  }
}

void SurfMatcher::offer_all(std::span<const SurfPoint> first, std::span<const SurfDescriptor> descriptors,
                            std::span<const SurfPoint> second, float radius_px) {
  BlockDistances squares{};
  for (std::size_t i = 0; i < first.size(); ++i) {
    const float min_v = first[i].v_px - radius_px;
    const float max_v = first[i].v_px + radius_px;
    for (std::size_t b = 0; b < blocks_size_; ++b) {
      const Block& block = blocks_[b];
      if (block.laplacian != first[i].laplacian || block.last_v_px < min_v || block.first_v_px > max_v) continue;
      squared_distances(descriptors[i], block.descriptors, squares);
      for (std::size_t k = 0; k < block.size; ++k) {
        const auto j = static_cast<std::size_t>(block.index[k]);
        const float du = second[j].u_px - first[i].u_px;
        const float dv = second[j].v_px - first[i].v_px;
        if (du * du + dv * dv > radius_px * radius_px) continue;
        of_first_[i].offer(squares[k], static_cast<std::int32_t>(j));
        of_second_[j].offer(squares[k], static_cast<std::int32_t>(i));
      }
    }
  }
}

std::span<const SurfMatch> SurfMatcher::match(std::span<const SurfPoint> first,
                                              std::span<const SurfDescriptor> first_descriptors,
                                              std::span<const SurfPoint> second,
                                              std::span<const SurfDescriptor> second_descriptors, float radius_px) {
  PELORUS_CHECK(first_descriptors.size() >= first.size() && second_descriptors.size() >= second.size(),
                "a descriptor for every point");
  const auto room = static_cast<std::size_t>(config_.max_points);
  first = first.first(std::min(first.size(), room));
  second = second.first(std::min(second.size(), room));
  of_first_.assign(first.size(), {});
  of_second_.assign(second.size(), {});
  fill_blocks(second, second_descriptors);
  offer_all(first, first_descriptors, second, radius_px);
  matches_.clear();
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Nearest& nearest = of_first_[i];
    if (nearest.index < 0) continue;
    const Nearest& back = of_second_[static_cast<std::size_t>(nearest.index)];
    if (back.index != static_cast<std::int32_t>(i)) continue;
    // The rival may stand on either side.
    const float rival = std::min(nearest.second_best, back.second_best);
    if (rival <= 0) continue;  // two identical partners: no telling
    const float distance = std::sqrt(nearest.best);
    const float ratio = std::isinf(rival) ? 0.0F : distance / std::sqrt(rival);
    if (distance > config_.max_distance || ratio > config_.max_ratio) continue;
    matches_.push_back({static_cast<std::int32_t>(i), nearest.index, distance, ratio});
  }
  return matches_;
}

}  // namespace pelorus
