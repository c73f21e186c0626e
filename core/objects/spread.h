#pragma once
// How a body's points lie, in space and in the image among the others. Pure. O(points).

#include "core/model/stage_data.h"

namespace pelorus {

// Deviation [px] of the points along their second principal axis: points on a line fix no rotation.
[[nodiscard]] double spread_px(PointPairs pairs, std::span<const PointIndex> members);

// Static points inside the convex outline of the members, per member. A body hides the scene behind it, so its outline
// holds few; points scattered over the scene that happen to agree hold many.
[[nodiscard]] double static_inside(PointPairs pairs, std::span<const PointRole> roles,
                                   std::span<const PointIndex> members);

// Componentwise median: a mismatch far away does not move it. Reorders the points; there must be some.
[[nodiscard]] Eigen::Vector3d robust_centroid(std::span<Eigen::Vector3d> points);

}  // namespace pelorus
