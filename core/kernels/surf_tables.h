#pragma once
// Constants of the SURF patch, shared by the scalar and the vector path of surf_patch.h; not for callers.

#include <array>
#include <cstddef>

#include "core/kernels/surf_patch.h"

namespace pelorus::surf {

inline constexpr int kSamples = kDescriptorCells - 1;  // Haar responses per row
inline constexpr int kWindows = 4;
inline constexpr int kWindowSize = 9;
inline constexpr int kWindowStep = 5;

// exp(-t^2 / (2 2.5^2)), t = -4..4: weight of a response within its window.
inline constexpr std::array<float, kWindowSize> kWithinWindow{0.2780373F, 0.4867523F, 0.7261490F, 0.9231163F, 1.0F,
                                                              0.9231163F, 0.7261490F, 0.4867523F, 0.2780373F};
// exp(-t^2 / (2 1.5^2)), t = -1.5..1.5: weight of a window.
inline constexpr std::array<float, kWindows> kAcrossWindows{0.6065307F, 0.9459595F, 0.9459595F, 0.6065307F};

inline constexpr int kOrientationSamples = kOrientationCells - 3;  // per axis, at -5.5..5.5 scale
inline constexpr int kDirections = 60;                             // bins of 6 degrees
inline constexpr int kOpening = 10;                                // sliding sector of 60 degrees
// exp(-t^2 / (2 2^2)), t = -5.5..5.5; padded to whole vectors.
inline constexpr std::array<float, 16> kOrientationWeight{0.0227941F, 0.0795595F, 0.2162652F, 0.4578334F,
                                                          0.7548396F, 0.9692332F, 0.9692332F, 0.7548396F,
                                                          0.4578334F, 0.2162652F, 0.0795595F, 0.0227941F};
// Responses within 6 scale per row j: columns first, ..., 11 - first.
inline constexpr std::array<int, kOrientationSamples> kFirstColumn{4, 2, 1, 1, 0, 0, 0, 0, 1, 1, 2, 4};

// atan(t), 0 <= t <= 1, to 1e-5 (Abramowitz & Stegun 4.4.49), highest power first.
inline constexpr std::array<float, 5> kArcTangent{0.0208351F, -0.0851330F, 0.1801410F, -0.3302995F, 0.9998660F};

using DirectionBins = std::array<SurfDirection, kDirections>;

inline SurfDirection strongest_sector(const DirectionBins& bins) {
  std::array<SurfDirection, kDirections + kOpening> until{};  // sums of the bins before each
  for (std::size_t i = 1; i < until.size(); ++i) {
    const SurfDirection& bin = bins[(i - 1) % kDirections];
    until[i] = {until[i - 1].u + bin.u, until[i - 1].v + bin.v};
  }
  SurfDirection best;
  float best_square = -1;
  for (std::size_t i = 0; i < kDirections; ++i) {
    const SurfDirection sum{until[i + kOpening].u - until[i].u, until[i + kOpening].v - until[i].v};
    const float square = sum.u * sum.u + sum.v * sum.v;
    if (square > best_square) best = sum, best_square = square;
  }
  return best;
}

}  // namespace pelorus::surf
