#include "core/evaluation/consistency.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/evaluation/error_statistics.h"
#include "core/evaluation/motion_error.h"

namespace pelorus {
namespace {

constexpr double kDegreesOfFreedom = 6;
constexpr double kBandProbability = 0.95;

// Inverse of the standard normal distribution by bisection: called a handful of times.
double normal_quantile(double probability) {
  double low = -10;
  double high = 10;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (0.5 * std::erfc(-middle / std::sqrt(2.0)) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

std::optional<double> nees(const Vector6d& xi, const Matrix6d& cov) {
  const Eigen::LLT<Matrix6d> factor(cov);
  if (factor.info() != Eigen::Success || !cov.allFinite()) return std::nullopt;
  const double value = xi.dot(factor.solve(xi));
  if (!std::isfinite(value)) return std::nullopt;
  return value;
}

double chi_square_quantile(double probability, double degrees_of_freedom) {
  const double spread = 2.0 / (9.0 * degrees_of_freedom);
  const double root = 1.0 - spread + normal_quantile(probability) * std::sqrt(spread);
  return degrees_of_freedom * root * root * root;
}

Consistency summarize_nees(std::vector<double> values) {
  Consistency consistency;
  consistency.count = values.size();
  if (values.empty()) return consistency;
  const auto count = static_cast<double>(values.size());
  const double bound = chi_square_quantile(kBandProbability, kDegreesOfFreedom);
  const auto inside = std::count_if(values.begin(), values.end(), [&](double value) { return value <= bound; });
  consistency.share_inside = static_cast<double>(inside) / count;
  constexpr double kTail = 0.5 * (1.0 - kBandProbability);
  consistency.band_low = chi_square_quantile(kTail, kDegreesOfFreedom * count) / count;
  consistency.band_high = chi_square_quantile(1.0 - kTail, kDegreesOfFreedom * count) / count;
  const ErrorStatistics statistics = summarize(std::move(values));
  consistency.mean_nees = statistics.mean;
  consistency.median_nees = statistics.median;
  return consistency;
}

std::optional<Consistency> ego_consistency(const EstimatedRun& run, const Truth& truth) {
  std::vector<double> values;
  for (std::size_t i = 1; i < run.size() && i < truth.frames.size(); ++i) {
    const std::optional<Rigid3>& T_truth_prev = truth.frames[i - 1].T_truth_cam;
    const std::optional<Rigid3>& T_truth_curr = truth.frames[i].T_truth_cam;
    if (!run[i].T_curr_prev || !run[i].T_world_cam || !T_truth_prev || !T_truth_curr) continue;
    const Rigid3 T_curr_prev_true = T_truth_curr->inverse() * *T_truth_prev;
    const Vector6d xi = se3_log(T_curr_prev_true * run[i].T_curr_prev->inverse());
    if (const std::optional<double> value = nees(xi, run[i].cov_T_curr_prev)) values.push_back(*value);
  }
  if (values.empty()) return std::nullopt;
  return summarize_nees(std::move(values));
}

std::vector<double> object_nees(const EstimatedRun& run, const Truth& truth, const std::vector<FrameMatches>& matches,
                                int body, const Rigid3& T_truth_world) {
  std::vector<double> values;
  for (std::size_t i = 1; i < matches.size(); ++i) {
    const ObjectMatch* match = matches[i].of_body(body);
    if (!match) continue;
    const std::optional<Rigid3> T_world_curr = true_body_in_world(truth.frames[i], body, T_truth_world);
    const std::optional<Rigid3> T_world_prev = true_body_in_world(truth.frames[i - 1], body, T_truth_world);
    if (!T_world_curr || !T_world_prev) continue;
    for (const EstimatedObject& object : run[i].objects) {
      if (object.id != match->object || object.phase != ObjectPhase::confirmed) continue;
      Rigid3 T_world_centroid = Rigid3::Identity();
      T_world_centroid.translation() = object.centroid_world;
      const Rigid3 M_true = *T_world_curr * T_world_prev->inverse();
      const Vector6d xi = se3_log(T_world_centroid.inverse() * M_true * object.M_world.inverse() * T_world_centroid);
      if (const std::optional<double> value = nees(xi, object.cov_M_centroid)) values.push_back(*value);
    }
  }
  return values;
}

}  // namespace pelorus
