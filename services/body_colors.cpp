#include "services/body_colors.h"

#include <algorithm>
#include <array>

namespace pelorus {
namespace {

constexpr std::array<Rgb, 8> kObjectColors = {Rgb{225, 120, 0},   Rgb{120, 45, 255}, Rgb{0, 120, 180},
                                              Rgb{225, 0, 120},   Rgb{60, 150, 255}, Rgb{165, 75, 0},
                                              Rgb{165, 135, 180}, Rgb{105, 105, 90}};

}  // namespace

Rgb object_color(BodyId id) {
  return kObjectColors[static_cast<std::size_t>(std::max(0, id.value - 1)) % kObjectColors.size()];
}

Rgb state_color(VisionState state) {
  switch (state) {
    case VisionState::tracking:
      return {60, 170, 90};
    case VisionState::degraded:
      return {235, 150, 30};
    case VisionState::init:
    case VisionState::standby:
      return {110, 130, 150};
    case VisionState::lost:
    case VisionState::camera_fault:
    case VisionState::calibration_fault:
      return {215, 50, 60};
  }
  return {110, 130, 150};
}

}  // namespace pelorus
