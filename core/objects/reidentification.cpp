#include "core/objects/reidentification.h"

#include <algorithm>

#include "core/base/fixed_vector.h"
#include "core/geometry/hull.h"
#include "core/geometry/rigid_fit.h"
#include "core/motion/motion_proposal.h"

namespace pelorus {
namespace {

struct ModelMatch {
  Eigen::Vector3d p_obj;
  const PointPair* pair = nullptr;
};
using ModelMatches = FixedVector<ModelMatch, kMaxPoints>;

double distance2(const SurfDescriptor& a, const SurfDescriptor& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = static_cast<double>(a[i]) - static_cast<double>(b[i]);
    sum += d * d;
  }
  return sum;
}

// Known once and not found in this step, nor given to another group.
bool out_of_sight(const MovingBody& body) {
  return !body.measured && (body.phase == ObjectPhase::confirmed || body.phase == ObjectPhase::coasting);
}

Eigen::Vector3d centre_of(PointPairs pairs, const Group& group) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const PointIndex i : group.members) centre += pairs[static_cast<std::size_t>(i)].curr.p_cam;
  return centre / static_cast<double>(group.members.size());
}

// How far, on average, a motion misses where the points went.
double mean_miss_px(const StereoRig& rig, PointPairs pairs, const Group& group, const Rigid3& H_curr_prev) {
  double sum_px = 0;
  for (const PointIndex i : group.members) {
    const PointPair& pair = pairs[static_cast<std::size_t>(i)];
    const Eigen::Vector3d p_curr = H_curr_prev * pair.prev.p_cam;
    sum_px += p_curr.z() > 0.05 ? (rig.project(p_curr) - pair.curr.z_px).head<2>().norm() : 1e3;
  }
  return sum_px / static_cast<double>(group.members.size());
}

ModelMatches match_model(PointPairs pairs, const Group& group, std::span<const Track* const> track_of_pair,
                         const MovingBody& body, const ReidentificationConfig& config) {
  ModelMatches matches;
  for (const PointIndex i : group.members) {
    const Track& track = *track_of_pair[static_cast<std::size_t>(i)];
    if (!track.has_descriptor) continue;
    double nearest = 1e30;
    double second = 1e30;
    const ModelPoint* best = nullptr;
    for (const ModelPoint& point : body.model) {
      if (!point.has_descriptor || point.laplacian != track.laplacian) continue;
      const double d2 = distance2(point.descriptor, track.descriptor);
      if (d2 < nearest) {
        // A re-detection of the same spot is no rival: it must not fail the ratio test.
        if (best == nullptr || (best->p_obj - point.p_obj).norm() > 0.03) second = nearest;
        nearest = d2;
        best = &point;
      } else if (d2 < second && (best->p_obj - point.p_obj).norm() > 0.03) {
        second = d2;
      }
    }
    if (best == nullptr || nearest > config.max_descriptor_distance2 || nearest > config.ratio2 * second) continue;
    matches.push_back({best->p_obj, &pairs[static_cast<std::size_t>(i)]});
  }
  return matches;
}

int support(const StereoRig& rig, const ModelMatches& matches, const Rigid3& T_cam_obj, double gate_chi2) {
  int count = 0;
  for (const ModelMatch& m : matches) {
    const Eigen::Vector3d p_cam = T_cam_obj * m.p_obj;
    if (!(p_cam.z() > 0.05)) continue;
    // Twice the variance of a measurement: the model point was measured too. SURF centres move by a pixel or so
    // between views, hence the floor.
    const double sigma_px = std::max(1.0, 1.5 * m.pair->sigma_px);
    const Eigen::Vector3d r = m.pair->curr.z_px - rig.project(p_cam);
    count += r.squaredNorm() / (sigma_px * sigma_px) < gate_chi2;
  }
  return count;
}

std::optional<Rigid3> fit_pose(const StereoRig& rig, const ModelMatches& matches, std::uint64_t seed,
                               const ReidentificationConfig& config, int& best_support) {
  SampleSequence sequence(seed);
  std::optional<Rigid3> best;
  best_support = 0;
  for (int s = 0; s < config.samples; ++s) {
    std::array<PointMatch, 3> sample;
    for (PointMatch& m : sample) {
      const ModelMatch& chosen = matches[sequence.below(matches.size())];
      m = {chosen.p_obj, chosen.pair->curr.p_cam, 1.0};
    }
    const auto T_cam_obj = fit_rigid(sample);
    if (!T_cam_obj) continue;
    const int count = support(rig, matches, *T_cam_obj, config.gate_chi2);
    if (count > best_support) {
      best_support = count;
      best = T_cam_obj;
    }
  }
  if (!best || best_support < 3) return std::nullopt;
  FixedVector<PointMatch, kMaxPoints> inliers;
  for (const ModelMatch& m : matches) {
    const Eigen::Vector3d p_cam = *best * m.p_obj;
    if (p_cam.z() > 0.05 && (m.pair->curr.z_px - rig.project(p_cam)).squaredNorm() < config.gate_chi2) {
      inliers.push_back({m.p_obj, m.pair->curr.p_cam, 1.0 / std::pow(m.pair->curr.p_cam.z(), 4)});
    }
  }
  const auto refined = fit_rigid(inliers);
  return refined ? refined : best;
}

}  // namespace

Reidentified reidentify(const StereoRig& rig, PointPairs pairs, const Group& group,
                        std::span<const Track* const> track_of_pair, std::span<const MovingBody> bodies,
                        std::span<const Rigid3> T_cam_obj_expected, Timestamp now, std::uint64_t seed,
                        const ReidentificationConfig& config) {
  Reidentified found;
  const Eigen::Vector3d centre = centre_of(pairs, group);
  for (std::size_t j = 0; j < bodies.size(); ++j) {
    const MovingBody& body = bodies[j];
    if (!out_of_sight(body)) continue;
    const double gate_m = config.gate_m + config.growth_mps * seconds(now - body.last_seen) + body.extent_m.norm() / 2;
    if (body.place_known && (T_cam_obj_expected[j] * body.centroid_obj - centre).norm() > gate_m) continue;
    const auto matches = match_model(pairs, group, track_of_pair, body, config);
    if (static_cast<int>(matches.size()) < config.min_matches) continue;
    int count = 0;
    const auto T_cam_obj = fit_pose(rig, matches, seed + j, config, count);
    if (!T_cam_obj || count < config.min_matches || count <= found.matches) continue;
    found = {static_cast<std::int32_t>(j), *T_cam_obj, count};
  }
  return found;
}

Reidentified recognise_motion(const StereoRig& rig, PointPairs pairs, const Group& group,
                              std::span<const MovingBody> bodies, std::span<const Rigid3> T_cam_obj_expected,
                              const Rigid3& H_static, Timestamp now, const ReidentificationConfig& config) {
  const double static_px = mean_miss_px(rig, pairs, group, H_static);
  Reidentified found;
  double least_px = std::min(config.motion_px, config.motion_share * static_px);
  FixedVector<Eigen::Vector3d, kMaxPoints> hull;
  for (std::size_t j = 0; j < bodies.size(); ++j) {
    const MovingBody& body = bodies[j];
    if (!out_of_sight(body) || !body.place_known) continue;
    const double miss_px = mean_miss_px(rig, pairs, group, body.H_curr_prev);
    if (miss_px > least_px) continue;
    hull.clear();
    for (const ModelPoint& point : body.model) hull.push_back(T_cam_obj_expected[j] * point.p_obj);
    const double gate_m = config.growth_mps * seconds(now - body.last_seen);
    if (distance_to_hull(hull, centre_of(pairs, group)) > gate_m) continue;
    least_px = miss_px;
    found = {static_cast<std::int32_t>(j), T_cam_obj_expected[j], 0};
  }
  return found;
}

}  // namespace pelorus
