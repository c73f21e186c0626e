#pragma once
// Convex hulls: membership of a point in a moving body (paper 5.2.4, "point in hull") and outlines in the image.
// Any unit; distances come back in the unit of the points. Pure, no allocation.

#include <Eigen/Core>
#include <span>

namespace pelorus {

// Distance from p to the convex hull of the points: 0 inside or on it. Gilbert, Johnson, Keerthi 1988 on the points
// themselves, so no hull is built and flat or single-point sets are legal. Relative accuracy 1e-9 of the set's size
// as seen from p. O(n) per iteration, usually three to six. HUGE_VAL for an empty set.
[[nodiscard]] double distance_to_hull(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& p);

// Convex polygon around 2D points, counter-clockwise with x right and y up, written to out (room for at least four
// vertices); returns their number. The exact hull when it fits, otherwise the smallest polygon with out.size() evenly
// turned sides that encloses all points. One place gives one vertex, a line two, no points none.
[[nodiscard]] int convex_outline(std::span<const Eigen::Vector2d> points, std::span<Eigen::Vector2d> out);

// Whether p lies inside the convex counter-clockwise outline, on it, or at most `margin` beyond each of its sides.
// Never for fewer than three vertices.
[[nodiscard]] bool inside_outline(std::span<const Eigen::Vector2d> outline, const Eigen::Vector2d& p,
                                  double margin = 0);

}  // namespace pelorus
