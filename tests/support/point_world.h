#pragma once
// A world of points without images: a static tilted sea floor and rigid movers, seen by a moving stereo camera, with
// exact truth for every stage behind the front end. Frame k: p_world(k) = M_world^k * p_world(0), and the camera is at
// T_world_cam = T_world_cam_start * exp(k * twist_cam). Gaussian pixel noise, if any, comes from a fixed seed.

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "core/model/stage_data.h"

namespace pelorus::test {

inline const StereoRig kRig{1024, 768, 800.0, 511.5, 383.5, 0.12};

inline Vector6d twist(double x, double y, double z, double rx, double ry, double rz) {
  Vector6d xi;
  xi << x, y, z, rx, ry, rz;
  return xi;
}

// What the camera saw of it, and what is true. body_of[i] is 0 for the floor, then 1, 2, ... for the movers.
struct WorldView {
  std::vector<PointPair> pairs;
  std::vector<int> body_of;
  std::vector<Rigid3> T_world_cam;  // by frame
  std::vector<Rigid3> M_world;      // by body, of one step

  [[nodiscard]] Rigid3 H_curr_prev(int body) const {
    const Rigid3& T_world_prev = T_world_cam[T_world_cam.size() - 2];
    return T_world_cam.back().inverse() * M_world[static_cast<std::size_t>(body)] * T_world_prev;
  }
  [[nodiscard]] std::vector<PointIndex> members(int body) const {
    std::vector<PointIndex> list;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (body_of[i] == body) list.push_back(static_cast<PointIndex>(i));
    }
    return list;
  }
  [[nodiscard]] std::vector<PointIndex> all() const {
    std::vector<PointIndex> list(pairs.size());
    std::iota(list.begin(), list.end(), 0);
    return list;
  }
};

class PointWorld {
 public:
  Rigid3 T_world_cam_start = Rigid3::Identity();
  Vector6d twist_cam = twist(0.03, 0.01, 0.02, 0.002, -0.004, 0.003);  // per frame, camera axes

  // Floor points on z = depth_m + 0.3 x - 0.4 y of the first camera, spread over its view.
  explicit PointWorld(int floor_points, double depth_m = 4.0, std::uint64_t seed = 1) : random_(seed) {
    M_world_.push_back(Rigid3::Identity());
    std::uniform_real_distribution<double> u(60, 960);
    std::uniform_real_distribution<double> v(60, 700);
    for (int i = 0; i < floor_points; ++i) {
      const double x = (u(random_) - kRig.cx_px) / kRig.f_px;
      const double y = (v(random_) - kRig.cy_px) / kRig.f_px;
      points_.push_back({0, Eigen::Vector3d(x, y, 1) * (depth_m / (1 - 0.3 * x + 0.4 * y))});
    }
  }

  // A cloud of points in a ball; it turns and moves by twist_obj about its center, axes of the first camera.
  int add_body(int count, const Eigen::Vector3d& center, double radius_m, const Vector6d& twist_obj) {
    const int body = static_cast<int>(M_world_.size());
    const Eigen::Translation3d there(center);
    M_world_.push_back(there * se3_exp(twist_obj) * there.inverse());
    std::uniform_real_distribution<double> side(-1, 1);
    for (int i = 0; i < count;) {
      const Eigen::Vector3d p = draw(side, random_);
      if (p.norm() > 1) continue;
      points_.push_back({body, center + radius_m * p});
      ++i;
    }
    return body;
  }

  // Everything and the camera, carried by one rigid motion of the world's frame.
  void move_world(const Rigid3& T_new_old) {
    T_world_cam_start = T_new_old * T_world_cam_start;
    for (auto& point : points_) point.p_world = T_new_old * point.p_world;
    for (auto& M : M_world_) M = T_new_old * M * T_new_old.inverse();
  }

  // The points that all `frames` frames see; floor points hidden by a body's outline are left out. `assumed_px` is
  // what the pairs state as their deviation.
  [[nodiscard]] WorldView observe(int frames, double noise_px, double assumed_px, std::uint64_t seed = 1) const {
    WorldView view;
    view.M_world = M_world_;
    for (int k = 0; k < frames; ++k) view.T_world_cam.push_back(T_world_cam_start * se3_exp(k * twist_cam));
    std::uint64_t track = 0;
    for (const auto& point : points_) {
      // Its own sequence for each point: a longer observation has the same noise in the frames both have.
      std::mt19937_64 random(seed * 1000003 + ++track);
      std::normal_distribution<double> noise(0, noise_px > 0 ? noise_px : 1.0);
      std::vector<Eigen::Vector3d> z_px;
      Eigen::Vector3d p_world = point.p_world;
      bool seen = true;
      for (const Rigid3& T_world_cam : view.T_world_cam) {
        const Eigen::Vector3d p_cam = T_world_cam.inverse() * p_world;
        Eigen::Vector3d z = kRig.project(p_cam);
        seen = seen && p_cam.z() > 0.3 && z.x() > 0 && z.x() < kRig.width && z.y() > 0 && z.y() < kRig.height &&
               z.z() > 0 && !(point.body == 0 && hidden(view, z));
        if (noise_px > 0) z += draw(noise, random);
        z_px.push_back(z);
        p_world = M_world_[static_cast<std::size_t>(point.body)] * p_world;
      }
      if (!seen) continue;
      view.pairs.push_back(pair_of(z_px, assumed_px, TrackId{track}));
      view.body_of.push_back(point.body);
    }
    return view;
  }

  static PointPair pair_of(const std::vector<Eigen::Vector3d>& z_px, double sigma_px, TrackId track) {
    PointPair pair;
    pair.track = track;
    const std::size_t last = z_px.size() - 1;
    pair.curr = {z_px[last], kRig.triangulate(z_px[last])};
    pair.prev = {z_px[last - 1], kRig.triangulate(z_px[last - 1])};
    pair.sigma_px = sigma_px;
    pair.age = static_cast<int>(last);
    pair.past_size = std::min(kPastFrames, static_cast<int>(last) - 1);
    for (std::size_t j = 0; j < static_cast<std::size_t>(pair.past_size); ++j) pair.past[j] = z_px[last - 2 - j];
    return pair;
  }

 private:
  struct Point {
    int body = 0;
    Eigen::Vector3d p_world;
  };

  // One number after the other: the order in which arguments are evaluated differs between x86 and arm64, and so would
  // the worlds.
  template <class Distribution>
  static Eigen::Vector3d draw(Distribution& distribution, std::mt19937_64& random) {
    const double z = distribution(random);
    const double y = distribution(random);
    const double x = distribution(random);
    return {x, y, z};
  }

  // Roughly: within the box around a body's points in the first frame, which movers of a few pixels hardly leave.
  [[nodiscard]] bool hidden(const WorldView& view, const Eigen::Vector3d& z_px) const {
    const Rigid3 T_cam_world = view.T_world_cam.front().inverse();
    for (int body = 1; body < static_cast<int>(M_world_.size()); ++body) {
      Eigen::AlignedBox2d box;
      for (const auto& point : points_) {
        if (point.body == body) box.extend(kRig.project(T_cam_world * point.p_world).head<2>());
      }
      if (box.contains(z_px.head<2>())) return true;
    }
    return false;
  }

  std::mt19937_64 random_;
  std::vector<Rigid3> M_world_;
  std::vector<Point> points_;
};

// Mean difference [px] of where two motions put the points: a good fit leaves sigma * sqrt(2 * 3 / n) of it.
inline double image_error_px(const WorldView& view, const std::vector<PointIndex>& members, const Rigid3& H_a,
                             const Rigid3& H_b) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const PointIndex i : members) {
    const Eigen::Vector3d& p_prev = view.pairs[static_cast<std::size_t>(i)].prev.p_cam;
    mean += (kRig.project(H_a * p_prev) - kRig.project(H_b * p_prev)) / static_cast<double>(members.size());
  }
  return mean.norm();
}

}  // namespace pelorus::test
