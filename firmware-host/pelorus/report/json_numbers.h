#pragma once
// Rows of numbers as compact JSON: fixed decimals without trailing zeros, null for NaN. Pure.

#include <Eigen/Core>
#include <string>

#include "core/geometry/transform.h"
#include "services/body_colors.h"

namespace pelorus {

class JsonNumbers {
 public:
  explicit JsonNumbers(int decimals) : decimals_(decimals) {}
  JsonNumbers& add(double value);
  JsonNumbers& add(const Eigen::Vector3d& v);
  // x y z, then the quaternion w x y z.
  JsonNumbers& add(const Rigid3& T);
  JsonNumbers& add_nulls(int count);
  [[nodiscard]] std::string str() const { return "[" + numbers_ + "]"; }

 private:
  int decimals_;
  std::string numbers_;
};

// "#rrggbb"
[[nodiscard]] std::string css_color(Rgb color);

}  // namespace pelorus
