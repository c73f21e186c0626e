#pragma once
// One camera's projection: pinhole with a lens distortion. Raw pixels (raw_px) in, unit-plane directions out.
// Coefficient orders are OpenCV's: radtan (k1 k2 p1 p2 [k3]), rational (k1 k2 p1 p2 k3 k4 k5 k6),
// equidistant (k1 k2 k3 k4). Pure.

#include <Eigen/Core>
#include <array>

namespace pelorus {

enum class LensKind { none, radtan, rational, equidistant };

struct CameraIntrinsics {
  int width = 0;
  int height = 0;
  double fx_px = 0;
  double fy_px = 0;
  double cx_px = 0;
  double cy_px = 0;
  LensKind lens = LensKind::none;
  std::array<double, 8> distortion{};  // unused entries are zero
};

}  // namespace pelorus
