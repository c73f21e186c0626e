#include "firmware-host/pelorus/report/json_numbers.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace pelorus {

JsonNumbers& JsonNumbers::add(double value) {
  if (!numbers_.empty()) numbers_ += ',';
  if (!std::isfinite(value)) {
    numbers_ += "null";
    return *this;
  }
  std::array<char, 400> text{};  // the longest double has 309 digits before the point
  const int length = std::snprintf(text.data(), text.size(), "%.*f", decimals_, value);
  std::string number(text.data(), static_cast<std::size_t>(length));
  if (number.find('.') != std::string::npos) {
    number.erase(number.find_last_not_of('0') + 1);
    if (number.back() == '.') number.pop_back();
  }
  numbers_ += number == "-0" ? "0" : number;
  return *this;
}

JsonNumbers& JsonNumbers::add(const Eigen::Vector3d& v) { return add(v.x()).add(v.y()).add(v.z()); }

JsonNumbers& JsonNumbers::add(const Rigid3& T) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(T.linear()).normalized();
  return add(Eigen::Vector3d(T.translation())).add(q.w()).add(q.x()).add(q.y()).add(q.z());
}

JsonNumbers& JsonNumbers::add_nulls(int count) {
  for (int i = 0; i < count; ++i) add(std::nan(""));
  return *this;
}

std::string css_color(Rgb color) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "#%02x%02x%02x", color.red, color.green, color.blue);
  return text.data();
}

}  // namespace pelorus
