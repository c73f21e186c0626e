#include "services/body_colors.h"

#include <algorithm>
#include <array>

namespace pelorus {
namespace {

constexpr std::array<Rgb, 8> kObjectColors = {Rgb{226, 106, 0}, Rgb{170, 80, 255}, Rgb{10, 150, 205}, Rgb{230, 50, 50},
                                              Rgb{165, 130, 0}, Rgb{80, 110, 255}, Rgb{240, 50, 150}, Rgb{25, 155, 70}};

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
