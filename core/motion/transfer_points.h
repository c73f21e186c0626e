#pragma once
// Point pairs laid out for core/kernels/transfer.h. Thread-bound; storage grows to the largest set seen.

#include <span>
#include <vector>

#include "core/kernels/transfer.h"
#include "core/model/stage_data.h"

namespace pelorus {

class TransferPoints {
 public:
  void reserve(std::size_t points);
  // Every `stride`-th of `chosen`.
  void assign(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> chosen, std::size_t stride = 1);
  [[nodiscard]] std::size_t size() const { return size_; }
  // Mahalanobis squares (3 degrees of freedom) under a motion, in the order of assign(); valid until the next call.
  [[nodiscard]] std::span<const double> chi2(const StereoRig& rig, const Rigid3& H_curr_prev);

 private:
  static constexpr std::size_t kColumns = 9;
  [[nodiscard]] double* column(std::size_t c) { return columns_.data() + c * padded_; }

  std::vector<double> columns_;
  std::vector<double> chi2_;
  std::size_t size_ = 0;
  std::size_t padded_ = 0;
};

}  // namespace pelorus
