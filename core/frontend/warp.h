#pragma once
// 2x2 warps of patches (row-major, offsets to offsets): how a small patch of a surface is scaled, turned and sheared by
// a body's motion, and between left and right. The surface's slope is given as the gradient of its disparity in the
// image (0, 0: it faces the camera). Pure, no allocation.

#include <array>

#include "core/geometry/stereo_rig.h"
#include "core/geometry/transform.h"

namespace pelorus {

using Warp = std::array<float, 4>;

// Warp of one step of a patch at p_prev that moves by H_curr_prev; identity when it would be behind the camera.
[[nodiscard]] Warp step_warp(const StereoRig& rig, const Rigid3& H_curr_prev, const Eigen::Vector3d& p_prev,
                             const Eigen::Vector2d& disparity_gradient);
// Warp from the left to the right image of one pair.
[[nodiscard]] Warp stereo_warp(const Eigen::Vector2d& disparity_gradient);

// later * earlier.
[[nodiscard]] Warp compose_warp(const Warp& later, const Warp& earlier);
[[nodiscard]] Warp inverse_warp(const Warp& warp);
// Whether the patch still looks like itself: scale within 0.6..1.6 and little shear.
[[nodiscard]] bool usable_warp(const Warp& warp);

}  // namespace pelorus
