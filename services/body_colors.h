#pragma once
// One color per body and per state, in pictures and in reports alike. Colors of bodies can be told apart with each kind
// of color blindness (found by search: the least difference of any two, as seen with it, is largest), none of them is
// the green-gray of the static scene; of middle brightness, so that they stand out on a dark picture and on white paper
// (contrast 3 to 1 on both, WCAG 1.4.11). After eight they begin anew. Pure.

#include <cstdint>

#include "core/model/stage_data.h"

namespace pelorus {

struct Rgb {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
};

inline constexpr Rgb kStaticColor{122, 172, 128};

[[nodiscard]] Rgb object_color(BodyId id);
[[nodiscard]] Rgb state_color(VisionState state);

}  // namespace pelorus
