#pragma once
// Correspondences between two sets of SURF points: mutual nearest neighbours in descriptor distance that pass the
// ratio test (Lowe 2004), among pairs of equal Laplacian sign (Bay et al. 2008, section 5) within a radius.
// Equal distances are decided by the lower index: results depend on nothing but the input. Thread-bound.
// O(first * second) distances at most; no allocation after construction.

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/frontend/surf.h"
#include "core/kernels/descriptor_distance.h"

namespace pelorus {

inline constexpr float kAnywhere_px = std::numeric_limits<float>::infinity();  // partners may lie

struct SurfMatchConfig {
  float max_ratio = 0.8F;     // of the best distance to the second best
  float max_distance = 0.7F;  // of unit descriptors
  int max_points = 4096;      // per set
};

struct SurfMatch {
  std::int32_t first = 0;
  std::int32_t second = 0;
  float distance = 0;
  float ratio = 0;  // 0 when there was no rival
};

class SurfMatcher {
 public:
  explicit SurfMatcher(const SurfMatchConfig& config);

  // Partners lie within `radius_px` of each other's places. Ordered by `first`; valid until the next call. Sets beyond
  // max_points are cut.
  [[nodiscard]] std::span<const SurfMatch> match(std::span<const SurfPoint> first,
                                                 std::span<const SurfDescriptor> first_descriptors,
                                                 std::span<const SurfPoint> second,
                                                 std::span<const SurfDescriptor> second_descriptors, float radius_px);

 private:
  struct Nearest {
    float best = std::numeric_limits<float>::infinity();  // squared distances
    float second_best = std::numeric_limits<float>::infinity();
    std::int32_t index = -1;

    void offer(float square, std::int32_t candidate);
  };
  // Neighbours in the second image, sixteen to a block: of one Laplacian sign, from a band of rows.
  struct Block {
    DescriptorBlock descriptors;
    std::array<std::int32_t, kBlockDescriptors> index{};
    std::size_t size = 0;
    std::int8_t laplacian = 0;
    float first_v_px = 0;
    float last_v_px = 0;
  };

  void fill_blocks(std::span<const SurfPoint> second, std::span<const SurfDescriptor> descriptors);
  void offer_all(std::span<const SurfPoint> first, std::span<const SurfDescriptor> descriptors,
                 std::span<const SurfPoint> second, float radius_px);

  SurfMatchConfig config_;
  std::vector<Nearest> of_first_;
  std::vector<Nearest> of_second_;
  std::vector<std::int32_t> order_;
  std::vector<Block> blocks_;
  std::size_t blocks_size_ = 0;
  std::vector<SurfMatch> matches_;
};

}  // namespace pelorus
