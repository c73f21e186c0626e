#pragma once
// Spread of a body's points over the image. Pure. O(members).

#include "core/model/stage_data.h"

namespace pelorus {

// Deviation [px] of the points along their second principal axis: points on a line fix no rotation.
[[nodiscard]] double spread_px(PointPairs pairs, std::span<const PointIndex> members);

}  // namespace pelorus
