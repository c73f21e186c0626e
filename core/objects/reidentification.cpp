#include "core/objects/reidentification.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "core/base/fixed_vector.h"
#include "core/geometry/hull.h"
#include "core/geometry/rigid_fit.h"
#include "core/geometry/robust_weight.h"
#include "core/kernels/descriptor_distance.h"
#include "core/motion/motion_proposal.h"

namespace pelorus {
namespace {

constexpr int kPoseIterations = 5;
constexpr double kSameSpot_m = 0.03;  // detections nearer than this on the body are of one spot
// Deviations of matches by descriptors, as the residuals of rendered bodies are (DECISIONS 53), and the squared length
// in them at which a match counts a quarter.
constexpr double kSigmaCentre_px = 0.7;
constexpr double kSigmaDisparity_px = 0.1;
constexpr double kRobustChi2 = 6.0;

struct ModelMatch {
  Eigen::Vector3d p_obj;
  const PointPair* pair = nullptr;
};
using ModelMatches = FixedVector<ModelMatch, kMaxPoints>;

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

// The model's descriptors, as the kernel compares them.
struct ModelDescriptors {
  FixedVector<const ModelPoint*, kMaxModelPoints> points;
  std::array<DescriptorBlock, kMaxModelPoints / kBlockDescriptors> blocks;

  ModelDescriptors(const MovingBody& body, ModelPart part) {
    for (const ModelPoint& point : body.model) {
      if (!point.has_descriptor || (part == ModelPart::of_birth && !point.of_birth)) continue;
      blocks[points.size() / kBlockDescriptors].set(points.size() % kBlockDescriptors, point.descriptor);
      points.push_back(&point);
    }
  }
};

// The model's point that a track shows: the nearest, and clearly nearer than the next. A re-detection of the same spot
// is no rival: it must not fail the ratio test.
const ModelPoint* nearest_of(const ModelDescriptors& model, const Track& track, const ReidentificationConfig& config) {
  FixedVector<double, kMaxModelPoints> d2;
  std::size_t nearest = model.points.size();
  for (std::size_t first = 0; first < model.points.size(); first += kBlockDescriptors) {
    BlockDistances squares;
    squared_distances(track.descriptor, model.blocks[first / kBlockDescriptors], squares);
    for (std::size_t i = first; i < std::min(first + kBlockDescriptors, model.points.size()); ++i) {
      d2.push_back(static_cast<double>(squares[i - first]));
      const bool same_kind = model.points[i]->laplacian == track.laplacian;
      if (same_kind && (nearest == model.points.size() || d2[i] < d2[nearest])) nearest = i;
    }
  }
  if (nearest == model.points.size() || d2[nearest] > config.max_descriptor_distance2) return nullptr;
  const ModelPoint& best = *model.points[nearest];
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    const ModelPoint& rival = *model.points[i];
    const bool other_spot = rival.laplacian == best.laplacian && (rival.p_obj - best.p_obj).norm() > kSameSpot_m;
    if (other_spot && d2[nearest] > config.ratio2 * d2[i]) return nullptr;
  }
  return &best;
}

ModelMatches match_model(PointPairs pairs, std::span<const PointIndex> members,
                         std::span<const Track* const> track_of_pair, const ModelDescriptors& model,
                         const ReidentificationConfig& config) {
  ModelMatches matches;
  for (const PointIndex i : members) {
    const auto index = static_cast<std::size_t>(i);
    const Track& track = *track_of_pair[index];
    if (!track.has_descriptor) continue;
    const ModelPoint* point = nearest_of(model, track, config);
    if (point != nullptr) matches.push_back({point->p_obj, &pairs[index]});
  }
  return matches;
}

// A pixel or so of a SURF centre's place changes with the view, in both images alike: across the view a match is worth
// that, in depth as much as the disparity, which follows the surface. Rows: place in u, in v, disparity, in deviations.
Eigen::Matrix3d whitening(const ModelMatch& m) {
  const double centre = 1.0 / std::max(kSigmaCentre_px, 1.5 * m.pair->sigma_px);
  const double disparity = 1.0 / std::max(kSigmaDisparity_px, 2.0 * m.pair->sigma_px);
  Eigen::Matrix3d W;
  W << 0.5 * centre, 0, 0.5 * centre, 0, centre, 0, disparity, 0, -disparity;
  return W;
}

// What a model point at this pose misses of its measurement in the current frame, in deviations; nothing behind the
// camera.
std::optional<Eigen::Vector3d> miss(const StereoRig& rig, const ModelMatch& m, const Rigid3& T_cam_obj) {
  const Eigen::Vector3d p_cam = T_cam_obj * m.p_obj;
  if (!(p_cam.z() > 0.05)) return std::nullopt;
  return whitening(m) * (m.pair->curr.z_px - rig.project(p_cam));
}

int support(const StereoRig& rig, const ModelMatches& matches, const Rigid3& T_cam_obj, double gate_chi2) {
  int count = 0;
  for (const ModelMatch& m : matches) {
    const auto r = miss(rig, m, T_cam_obj);
    count += r && r->squaredNorm() < gate_chi2;
  }
  return count;
}

// Gauss-Newton on the pixels of both images, of the matches that agree: aligning clouds would weigh depth as if it were
// as good as the rest, and turn the body by degrees. Nothing where the matches do not tell all six unknowns.
std::optional<Placing> refine(const StereoRig& rig, const ModelMatches& matches, Placing placing, double gate_chi2) {
  for (int iteration = 0; iteration < kPoseIterations; ++iteration) {
    Matrix6d information = Matrix6d::Zero();
    Vector6d gradient = Vector6d::Zero();
    placing.matches = 0;
    for (const ModelMatch& m : matches) {
      const auto r = miss(rig, m, placing.T_cam_obj);
      if (!r || r->squaredNorm() > gate_chi2) continue;
      // Right perturbations: in the body's frame, whose origin is in it, both kinds of unknowns are of one size.
      Eigen::Matrix<double, 3, 6> B;
      B.leftCols<3>() = whitening(m) * rig.project_jacobian(placing.T_cam_obj * m.p_obj) * placing.T_cam_obj.linear();
      B.rightCols<3>() = -B.leftCols<3>() * skew(m.p_obj);
      // Geman-McClure: a neighbour that looks alike is a pixel or two beside, and tells as much less.
      const double weight = geman_mcclure_weight(r->squaredNorm(), kRobustChi2);
      information += weight * B.transpose() * B;
      gradient += weight * B.transpose() * *r;
      ++placing.matches;
    }
    const Eigen::LDLT<Matrix6d> solver(information);
    if (solver.info() != Eigen::Success || !(solver.rcond() > 1e-9)) return std::nullopt;
    const Vector6d xi = solver.solve(gradient);
    if (!(xi.norm() < 1.0)) return std::nullopt;
    placing.T_cam_obj = orthonormalized(placing.T_cam_obj * se3_exp(xi));
    placing.cov_obj = solver.solve(Matrix6d::Identity());
  }
  return placing;
}

std::optional<Placing> place(const StereoRig& rig, const ModelMatches& matches, std::uint64_t seed,
                             const ReidentificationConfig& config) {
  SampleSequence sequence(seed);
  Placing best;
  for (int s = 0; s < config.samples; ++s) {
    std::array<PointMatch, 3> sample;
    for (PointMatch& m : sample) {
      const ModelMatch& chosen = matches[sequence.below(matches.size())];
      m = {chosen.p_obj, chosen.pair->curr.p_cam, 1.0};
    }
    const auto T_cam_obj = fit_rigid(sample);
    if (!T_cam_obj) continue;
    const int count = support(rig, matches, *T_cam_obj, config.gate_chi2);
    if (count > best.matches) best = {*T_cam_obj, Matrix6d::Zero(), count};
  }
  if (best.matches < config.min_matches) return std::nullopt;
  const auto refined = refine(rig, matches, best, config.gate_chi2);
  return refined && refined->matches >= config.min_matches ? refined : std::nullopt;
}

}  // namespace

std::optional<Placing> place_by_descriptors(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> members,
                                            std::span<const Track* const> track_of_pair, const MovingBody& body,
                                            ModelPart part, std::uint64_t seed, const ReidentificationConfig& config) {
  const ModelDescriptors model(body, part);
  const ModelMatches matches = match_model(pairs, members, track_of_pair, model, config);
  if (static_cast<int>(matches.size()) < config.min_matches) return std::nullopt;
  return place(rig, matches, seed, config);
}

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
    const auto placing =
        place_by_descriptors(rig, pairs, group.members, track_of_pair, body, ModelPart::all, seed + j, config);
    if (!placing || placing->matches <= found.placing.matches) continue;
    found = {static_cast<std::int32_t>(j), *placing};
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
    found = {static_cast<std::int32_t>(j),
             {T_cam_obj_expected[j], transported(body.T_world_obj.inverse(), body.cov_T_world_obj), 0}};
  }
  return found;
}

}  // namespace pelorus
