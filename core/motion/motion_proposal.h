#pragma once
// A motion for a set of points of which an unknown part moves rigidly together: minimal samples of three points,
// closed form, polished in pixels, scored by truncated stereo transfer error (method section 4). Deterministic:
// the samples depend on the seed given and the points only. O(samples * points).

#include <cstdint>
#include <optional>

#include "core/motion/transfer_points.h"

namespace pelorus {

struct MotionProposalConfig {
  int samples = 24;
  double gate_chi2 = 16.266;  // 99.9 % of 3 degrees of freedom
  int scored_points = 60;     // evenly strided subset that scores a sample
};

// Small deterministic generator (splitmix64): same seed, same samples, on every host.
class SampleSequence {
 public:
  explicit SampleSequence(std::uint64_t seed) : state_(seed) {}
  // Uniform in [0, bound).
  [[nodiscard]] std::size_t below(std::size_t bound);

 private:
  std::uint64_t state_;
};

// The motion of three point pairs: closed form on the triangulated points, then Gauss-Newton on the pixels.
[[nodiscard]] std::optional<Rigid3> motion_of_three(const StereoRig& rig, PointPairs pairs,
                                                    const std::array<PointIndex, 3>& sample);

// Best-scoring H_curr_prev over the samples drawn from `members`; empty with fewer than three. `scored` is storage.
[[nodiscard]] std::optional<Rigid3> propose_motion(const StereoRig& rig, PointPairs pairs,
                                                   std::span<const PointIndex> members, std::uint64_t seed,
                                                   const MotionProposalConfig& config, TransferPoints& scored);

}  // namespace pelorus
