#pragma once
// Delaunay triangulation of points in the image: the net of the static scene (paper 5.2.2 and 5.2.3).
// Incremental insertion (Bowyer 1981, Watson 1981) along a space-filling curve, walking point location (Lawson 1977).
// Predicates are exact: coordinates are rounded to a grid of 2^-29 of the extent (2e-6 px for an image) and compared
// as integers, so that collinear and cocircular points need no tolerance. The set of triangles depends on the set of
// points alone, never on their order. Any 2D unit (pixels here). No allocation after construction; about O(n) run(),
// O(sqrt n) find(). Thread-bound; find() and triangles() are pure between two runs.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace pelorus {

// Indices into the points given to run(); counter-clockwise with x right and y up (so clockwise on a screen, v down).
struct Triangle {
  std::array<int, 3> vertices{};
};

class Delaunay {
 public:
  // `capacity`: the most points that run() will be given.
  explicit Delaunay(int capacity);

  // Triangulates up to `capacity` points. Of points at the same place only the one with the lowest index becomes a
  // vertex; points that are not finite are skipped. False when there is no triangle: fewer than three places, or all
  // on one line.
  bool run(std::span<const Eigen::Vector2d> points);

  // Of the last run; valid until the next.
  [[nodiscard]] std::span<const Triangle> triangles() const { return triangles_; }

  // Index into triangles() of the triangle that contains p (its border included), or -1 outside the hull.
  [[nodiscard]] int find(const Eigen::Vector2d& p) const;

 private:
  struct GridPoint {
    std::int64_t x = 0;
    std::int64_t y = 0;
  };
  struct KeyedPoint {
    std::uint64_t key = 0;  // Morton code: place on the space-filling curve
    int index = 0;
  };
  // A face of the growing net. Edge i runs from vertex i+1 to vertex i+2; neighbor i lies beyond it. A face whose
  // last vertex is kInfinite lies outside the hull, beyond the edge 0 -> 1, and closes the net into a sphere.
  struct Face {
    std::array<int, 3> vertices{};
    std::array<int, 3> neighbors{};
  };
  struct CavityEdge {
    int from = 0;
    int to = 0;
    int outside = 0;  // face that stays beyond the edge
  };

  void set_grid(std::span<const Eigen::Vector2d> points);
  void place_on_grid(std::span<const Eigen::Vector2d> points);
  bool start_net();
  void insert(int vertex);
  void collect_cavity(int seed, const GridPoint& p);
  void fill_cavity(int vertex);
  void publish_triangles();
  [[nodiscard]] bool to_grid(const Eigen::Vector2d& p, GridPoint& on_grid) const;
  [[nodiscard]] int walk(int start, const GridPoint& p) const;
  [[nodiscard]] bool conflicts(const Face& face, const GridPoint& p) const;
  [[nodiscard]] static std::int64_t orientation(const GridPoint& a, const GridPoint& b, const GridPoint& c);
  [[nodiscard]] static bool inside_circle(const GridPoint& a, const GridPoint& b, const GridPoint& c,
                                          const GridPoint& p);

  int capacity_ = 0;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  double cells_per_unit_ = 1.0;
  std::vector<GridPoint> grid_;    // by input index
  std::vector<KeyedPoint> order_;  // distinct places along the curve
  std::vector<Face> faces_;
  std::vector<int> visit_;  // by face: 1 in the cavity of the point being inserted
  std::vector<int> cavity_;
  std::vector<CavityEdge> border_;
  std::vector<int> face_from_;  // by vertex: the new face whose border edge starts there
  std::vector<int> published_;  // by face: index into triangles_, or -1
  std::vector<Triangle> triangles_;
  std::vector<int> face_of_;  // by triangle
  int last_face_ = 0;
};

}  // namespace pelorus
