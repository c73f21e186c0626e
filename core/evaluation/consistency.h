#pragma once
// Does the reported covariance tell the truth? NEES = xi^T cov^-1 xi of the error xi = log(T_true T^-1), 6 degrees of
// freedom, averaged over the run, against the 95 % band of a chi-square mean (Bar-Shalom, Li, Kirubarajan 2001).
// The band takes frames as independent; neighbouring frames share points, so a run a little outside is no verdict.
// Above the band: overconfident. Below: too modest. Pure.

#include <optional>
#include <vector>

#include "core/evaluation/association.h"
#include "core/evaluation/records.h"

namespace pelorus {

struct Consistency {
  std::size_t count = 0;
  double mean_nees = 0;    // expected: 6
  double median_nees = 0;  // expected: 5.35; robust against a few wild frames
  double band_low = 0;     // of the mean
  double band_high = 0;
  double share_inside = 0;  // frames within their own 95 % bound (12.59); expected: 0.95
  [[nodiscard]] bool is_inside_band() const { return mean_nees >= band_low && mean_nees <= band_high; }
};

// Of xi under cov; absent when cov is unknown (zero) or no covariance at all (not positive definite).
[[nodiscard]] std::optional<double> nees(const Vector6d& xi, const Matrix6d& cov);

// Quantile of chi-square, after Wilson & Hilferty 1931: for 6 degrees of freedom 1 % off above, 3 % below; better for
// more.
[[nodiscard]] double chi_square_quantile(double probability, double degrees_of_freedom);

[[nodiscard]] Consistency summarize_nees(std::vector<double> values);

// Of the camera's step motion T_curr_prev. Absent when no frame has both a covariance and truth.
[[nodiscard]] std::optional<Consistency> ego_consistency(const EstimatedRun& run, const Truth& truth);

// Of the step motions of one body's confirmed objects.
[[nodiscard]] std::vector<double> object_nees(const EstimatedRun& run, const Truth& truth,
                                              const std::vector<FrameMatches>& matches, int body,
                                              const Rigid3& T_truth_world);

}  // namespace pelorus
