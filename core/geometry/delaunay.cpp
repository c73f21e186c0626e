#include "core/geometry/delaunay.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace pelorus {
namespace {

constexpr int kInfinite = -1;
// 29 bits: products of two differences stay within 64 bits, the circle test within 128.
constexpr int kGridBits = 29;

__extension__ using Int128 = __int128;

// Spreads the low 32 bits of x to the even bits.
std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | (x << 16U)) & 0x0000FFFF0000FFFFULL;
  x = (x | (x << 8U)) & 0x00FF00FF00FF00FFULL;
  x = (x | (x << 4U)) & 0x0F0F0F0F0F0F0F0FULL;
  x = (x | (x << 2U)) & 0x3333333333333333ULL;
  return (x | (x << 1U)) & 0x5555555555555555ULL;
}

std::size_t at(int index) { return static_cast<std::size_t>(index); }

bool is_outer(const std::array<int, 3>& vertices) { return vertices[2] == kInfinite; }

}  // namespace

Delaunay::Delaunay(int capacity) : capacity_(capacity) {
  PELORUS_CHECK(capacity > 0, "capacity of a triangulation must be positive");
  // Euler: n vertices and the infinite one make at most 2n - 2 faces; two more while a cavity is refilled.
  const std::size_t faces = 2 * at(capacity) + 2;
  grid_.resize(at(capacity));
  order_.reserve(at(capacity));
  faces_.reserve(faces);
  visit_.resize(faces, 0);
  cavity_.reserve(faces);
  border_.reserve(faces);
  face_from_.resize(at(capacity) + 1, 0);
  published_.resize(faces, -1);
  triangles_.reserve(faces);
  face_of_.reserve(faces);
}

bool Delaunay::run(std::span<const Eigen::Vector2d> points) {
  PELORUS_CHECK(points.size() <= at(capacity_), "more points than the triangulation was made for");
  order_.clear();
  faces_.clear();
  triangles_.clear();
  face_of_.clear();
  set_grid(points);
  place_on_grid(points);
  if (!start_net()) return false;
  for (const KeyedPoint& point : order_) {
    if (point.index >= 0) insert(point.index);
  }
  publish_triangles();
  return true;
}

int Delaunay::find(const Eigen::Vector2d& p) const {
  GridPoint on_grid;
  if (triangles_.empty() || !to_grid(p, on_grid)) return -1;
  return published_[at(walk(face_of_.back(), on_grid))];
}

// The power of two that spreads the larger extent over the grid, so that the rounding is the same for equal extents.
void Delaunay::set_grid(std::span<const Eigen::Vector2d> points) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(HUGE_VAL);
  Eigen::Vector2d high = -low;
  for (const Eigen::Vector2d& p : points) {
    if (!p.allFinite()) continue;
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double extent = (high - low).maxCoeff();
  origin_ = low;
  cells_per_unit_ = extent > 0 && std::isfinite(extent) ? std::ldexp(1.0, kGridBits - 1 - std::ilogb(extent)) : 1.0;
}

bool Delaunay::to_grid(const Eigen::Vector2d& p, GridPoint& on_grid) const {
  const Eigen::Vector2d cell = (p - origin_) * cells_per_unit_;
  const double limit = std::ldexp(1.0, kGridBits);
  // Written so that NaN fails too.
  if (!(cell.minCoeff() > -0.5 && cell.maxCoeff() <= limit)) return false;
  on_grid = {std::llround(cell.x()), std::llround(cell.y())};
  return true;
}

void Delaunay::place_on_grid(std::span<const Eigen::Vector2d> points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite() || !to_grid(points[i], grid_[i])) continue;
    const std::uint64_t key = spread_bits(static_cast<std::uint64_t>(grid_[i].x)) |
                              (spread_bits(static_cast<std::uint64_t>(grid_[i].y)) << 1U);
    order_.push_back({key, static_cast<int>(i)});
  }
  std::sort(order_.begin(), order_.end(), [](const KeyedPoint& a, const KeyedPoint& b) {
    return a.key != b.key ? a.key < b.key : a.index < b.index;
  });
  const auto same_place = [](const KeyedPoint& a, const KeyedPoint& b) { return a.key == b.key; };
  order_.erase(std::unique(order_.begin(), order_.end(), same_place), order_.end());
}

// The first two points of the curve and the first that is not in line with them; marks the three as used.
bool Delaunay::start_net() {
  if (order_.size() < 3) return false;
  int a = order_[0].index;
  int b = order_[1].index;
  const auto off_line = std::find_if(order_.begin() + 2, order_.end(), [&](const KeyedPoint& point) {
    return orientation(grid_[at(a)], grid_[at(b)], grid_[at(point.index)]) != 0;
  });
  if (off_line == order_.end()) return false;
  const int c = off_line->index;
  if (orientation(grid_[at(a)], grid_[at(b)], grid_[at(c)]) < 0) std::swap(a, b);
  faces_.push_back({{a, b, c}, {2, 3, 1}});
  faces_.push_back({{b, a, kInfinite}, {3, 2, 0}});
  faces_.push_back({{c, b, kInfinite}, {1, 3, 0}});
  faces_.push_back({{a, c, kInfinite}, {2, 1, 0}});
  order_[0].index = order_[1].index = off_line->index = kInfinite;
  last_face_ = 0;
  return true;
}

void Delaunay::insert(int vertex) {
  const GridPoint& p = grid_[at(vertex)];
  collect_cavity(walk(last_face_, p), p);
  fill_cavity(vertex);
}

// The face that contains p: steps across an edge that has p on its far side until there is none. Ends on a Delaunay
// net (Edelsbrunner 1990); p outside the hull ends in an outer face.
int Delaunay::walk(int start, const GridPoint& p) const {
  int current = is_outer(faces_[at(start)].vertices) ? faces_[at(start)].neighbors[2] : start;
  while (!is_outer(faces_[at(current)].vertices)) {
    const Face& face = faces_[at(current)];
    int next = -1;
    for (std::size_t i = 0; i < 3 && next < 0; ++i) {
      const GridPoint& from = grid_[at(face.vertices[(i + 1) % 3])];
      const GridPoint& to = grid_[at(face.vertices[(i + 2) % 3])];
      if (orientation(from, to, p) < 0) next = face.neighbors[i];
    }
    if (next < 0) return current;
    current = next;
  }
  return current;
}

// All faces whose circumcircle holds p, found from one of them; and the edges around them, unordered.
void Delaunay::collect_cavity(int seed, const GridPoint& p) {
  cavity_.clear();
  border_.clear();
  cavity_.push_back(seed);
  visit_[at(seed)] = 1;
  for (std::size_t next = 0; next < cavity_.size(); ++next) {
    const Face& face = faces_[at(cavity_[next])];
    for (std::size_t i = 0; i < 3; ++i) {
      const int beyond = face.neighbors[i];
      if (visit_[at(beyond)] != 0) continue;
      if (conflicts(faces_[at(beyond)], p)) {
        visit_[at(beyond)] = 1;
        cavity_.push_back(beyond);
      } else {
        border_.push_back({face.vertices[(i + 1) % 3], face.vertices[(i + 2) % 3], beyond});
      }
    }
  }
}

// Replaces the cavity by the fan from `vertex` to its border.
void Delaunay::fill_cavity(int vertex) {
  const auto slot = [](int v) { return at(v + 1); };  // kInfinite has slot 0
  for (int face : cavity_) visit_[at(face)] = 0;
  while (cavity_.size() < border_.size()) {
    cavity_.push_back(static_cast<int>(faces_.size()));
    faces_.emplace_back();
  }
  for (std::size_t k = 0; k < border_.size(); ++k) {
    const CavityEdge& edge = border_[k];
    Face& outside = faces_[at(edge.outside)];
    const auto apex = std::find_if(outside.vertices.begin(), outside.vertices.end(),
                                   [&](int v) { return v != edge.from && v != edge.to; });
    outside.neighbors[static_cast<std::size_t>(apex - outside.vertices.begin())] = cavity_[k];
    face_from_[slot(edge.from)] = cavity_[k];
  }
  for (std::size_t k = 0; k < border_.size(); ++k) {
    const CavityEdge& edge = border_[k];
    const int after = face_from_[slot(edge.to)];
    faces_[at(cavity_[k])] = {{edge.from, edge.to, vertex}, {after, -1, edge.outside}};
  }
  // Across the edge vertex -> from lies the fan face that ends in `from`: each face tells the one after it.
  for (std::size_t k = 0; k < border_.size(); ++k) {
    faces_[at(faces_[at(cavity_[k])].neighbors[0])].neighbors[1] = cavity_[k];
  }
  for (std::size_t k = 0; k < border_.size(); ++k) {
    Face& face = faces_[at(cavity_[k])];
    const auto infinite = std::find(face.vertices.begin(), face.vertices.end(), kInfinite);
    if (infinite == face.vertices.end()) continue;
    const auto shift = (infinite - face.vertices.begin() + 1) % 3;  // kInfinite goes last
    std::rotate(face.vertices.begin(), face.vertices.begin() + shift, face.vertices.end());
    std::rotate(face.neighbors.begin(), face.neighbors.begin() + shift, face.neighbors.end());
  }
  last_face_ = cavity_[0];
}

void Delaunay::publish_triangles() {
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    published_[i] = -1;
    if (is_outer(faces_[i].vertices)) continue;
    published_[i] = static_cast<int>(triangles_.size());
    triangles_.push_back({faces_[i].vertices});
    face_of_.push_back(static_cast<int>(i));
  }
}

// True when p lies inside the circumcircle; for an outer face, whose circle is a half-plane, beyond its edge or on it.
bool Delaunay::conflicts(const Face& face, const GridPoint& p) const {
  const GridPoint& a = grid_[at(face.vertices[0])];
  const GridPoint& b = grid_[at(face.vertices[1])];
  if (!is_outer(face.vertices)) return inside_circle(a, b, grid_[at(face.vertices[2])], p);
  const std::int64_t side = orientation(a, b, p);
  if (side != 0) return side > 0;
  return (p.x - a.x) * (p.x - b.x) + (p.y - a.y) * (p.y - b.y) < 0;
}

// Twice the signed area of (a, b, c): positive when counter-clockwise.
std::int64_t Delaunay::orientation(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool Delaunay::inside_circle(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& p) {
  const GridPoint u{a.x - p.x, a.y - p.y};
  const GridPoint v{b.x - p.x, b.y - p.y};
  const GridPoint w{c.x - p.x, c.y - p.y};
  const Int128 determinant = Int128{u.x * u.x + u.y * u.y} * (v.x * w.y - v.y * w.x) +
                             Int128{v.x * v.x + v.y * v.y} * (w.x * u.y - w.y * u.x) +
                             Int128{w.x * w.x + w.y * w.y} * (u.x * v.y - u.y * v.x);
  return determinant > 0;
}

}  // namespace pelorus
