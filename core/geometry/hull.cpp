#include "core/geometry/hull.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/check.h"

namespace pelorus {
namespace {

// Up to four points, and the point nearest to the origin of their convex hull.
struct Simplex {
  std::array<Eigen::Vector3d, 4> corners;
  std::size_t size = 0;
  Eigen::Vector3d nearest = Eigen::Vector3d::Zero();
};

Simplex point_simplex(const Eigen::Vector3d& a) { return {{a}, 1, a}; }

Simplex closer(const Simplex& a, const Simplex& b) { return b.nearest.squaredNorm() < a.nearest.squaredNorm() ? b : a; }

Simplex reduce_segment(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d ab = b - a;
  const double along = -a.dot(ab);
  if (along <= 0) return point_simplex(a);
  if (along >= ab.squaredNorm()) return point_simplex(b);
  return {{a, b}, 2, a + ab * (along / ab.squaredNorm())};
}

// The feature of triangle abc nearest to the origin: the face when the origin projects into it, else the best edge.
Simplex reduce_triangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double area2 = normal.squaredNorm();
  const double weight_c = normal.dot(a.cross(b));
  const double weight_a = normal.dot(b.cross(c));
  const double weight_b = normal.dot(c.cross(a));
  const bool projects_inside = weight_a > 0 && weight_b > 0 && weight_c > 0;
  if (projects_inside && area2 > 0) return {{a, b, c}, 3, normal * (normal.dot(a) / area2)};
  return closer(closer(reduce_segment(a, b), reduce_segment(b, c)), reduce_segment(c, a));
}

// True when the origin lies inside the tetrahedron, seen from every face on the side of the opposite corner. A flat
// tetrahedron holds nothing: its faces answer.
bool holds_origin(const std::array<Eigen::Vector3d, 4>& p) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d& a = p[(i + 1) % 4];
    const Eigen::Vector3d normal = (p[(i + 2) % 4] - a).cross(p[(i + 3) % 4] - a);
    const double origin_side = -normal.dot(a);
    const double corner_side = normal.dot(p[i] - a);
    const bool flat = std::abs(corner_side) <= 1e-12 * normal.norm() * (p[i] - a).norm();
    if (flat || origin_side * corner_side < 0) return false;
  }
  return true;
}

Simplex reduce_tetrahedron(const std::array<Eigen::Vector3d, 4>& p) {
  if (holds_origin(p)) return {p, 4, Eigen::Vector3d::Zero()};
  return closer(closer(reduce_triangle(p[0], p[1], p[2]), reduce_triangle(p[0], p[1], p[3])),
                closer(reduce_triangle(p[0], p[2], p[3]), reduce_triangle(p[1], p[2], p[3])));
}

// The smallest part of the simplex that holds its point nearest to the origin.
Simplex reduce(const Simplex& s) {
  if (s.size == 2) return reduce_segment(s.corners[0], s.corners[1]);
  if (s.size == 3) return reduce_triangle(s.corners[0], s.corners[1], s.corners[2]);
  return reduce_tetrahedron(s.corners);
}

double cross2(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// Gift wrapping (Jarvis 1973): the number of hull vertices written, or -1 when they do not fit.
int wrap(std::span<const Eigen::Vector2d> points, std::span<Eigen::Vector2d> out) {
  const auto lower_left = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.y() != b.y() ? a.y() < b.y() : a.x() < b.x();
  };
  const Eigen::Vector2d start = *std::min_element(points.begin(), points.end(), lower_left);
  Eigen::Vector2d current = start;
  for (std::size_t size = 0; size < out.size(); ++size) {
    out[size] = current;
    Eigen::Vector2d next = current;
    for (const Eigen::Vector2d& p : points) {
      const double turn = cross2(next - current, p - current);
      const bool farther = (p - current).squaredNorm() > (next - current).squaredNorm();
      if (next == current || turn < 0 || (turn == 0 && farther)) next = p;
    }
    if (next == start) return static_cast<int>(size) + 1;
    current = next;
  }
  return -1;
}

// Sides of out.size() evenly spread directions, each moved out to the last point: corners of neighbouring sides.
int enclose(std::span<const Eigen::Vector2d> points, std::span<Eigen::Vector2d> out) {
  const double turn = 2 * std::numbers::pi / static_cast<double>(out.size());
  const auto side = [&](std::size_t k) {
    const Eigen::Vector2d outward(std::cos(turn * static_cast<double>(k)), std::sin(turn * static_cast<double>(k)));
    double reach = -HUGE_VAL;
    for (const Eigen::Vector2d& p : points) reach = std::max(reach, outward.dot(p));
    return Eigen::Vector3d(outward.x(), outward.y(), reach);
  };
  Eigen::Vector3d previous = side(out.size() - 1);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const Eigen::Vector3d current = side(k);
    const double x = previous.z() * current.y() - current.z() * previous.y();
    const double y = current.z() * previous.x() - previous.z() * current.x();
    out[k] = Eigen::Vector2d(x, y) / std::sin(turn);
    previous = current;
  }
  return static_cast<int>(out.size());
}

}  // namespace

double distance_to_hull(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& p) {
  constexpr int kMaxIterations = 64;  // each but the last brings the simplex nearer; a bound, not a tuning
  constexpr double kRelativeGap = 1e-18;
  if (points.empty()) return HUGE_VAL;
  Simplex simplex = point_simplex(points[0] - p);
  double reach2 = 0;  // largest squared distance seen: the scale against which "zero" is judged
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const Eigen::Vector3d& nearest = simplex.nearest;
    Eigen::Vector3d support = points[0] - p;
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Vector3d candidate = point - p;
      reach2 = std::max(reach2, candidate.squaredNorm());
      if (nearest.dot(candidate) < nearest.dot(support)) support = candidate;
    }
    const double distance2 = nearest.squaredNorm();
    if (distance2 <= kRelativeGap * reach2) return 0;
    // The hull lies beyond the plane through `support` square to `nearest`: no point of it is nearer than that.
    if (distance2 - nearest.dot(support) <= 1e-9 * distance2) break;
    simplex.corners[simplex.size++] = support;
    const Simplex reduced = reduce(simplex);
    if (reduced.size == 4) return 0;
    if (reduced.nearest.squaredNorm() >= distance2) break;  // rounding has the last word
    simplex = reduced;
  }
  return simplex.nearest.norm();
}

int convex_outline(std::span<const Eigen::Vector2d> points, std::span<Eigen::Vector2d> out) {
  PELORUS_CHECK(out.size() >= 4, "an outline needs room for four vertices");
  if (points.empty()) return 0;
  const int exact = wrap(points, out);
  return exact >= 0 ? exact : enclose(points, out);
}

bool inside_outline(std::span<const Eigen::Vector2d> outline, const Eigen::Vector2d& p, double margin) {
  if (outline.size() < 3) return false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d side = outline[(i + 1) % outline.size()] - outline[i];
    if (cross2(side, p - outline[i]) < -margin * side.norm()) return false;
  }
  return true;
}

}  // namespace pelorus
