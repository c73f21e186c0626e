#include "core/evaluation/association.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace pelorus {
namespace {

struct Candidate {
  BodyId object;
  int body = 0;
  double distance = 0;  // in gates: 0 = on the spot, 1 = at the gate
  bool confirmed = false;
};

// Distance over gate; above 1 they have nothing to do with each other.
// Points on a body's surface have their centroid within its box: the gate only has to allow for the measurement.
// Inside, the centre is the tie-break between boxes that overlap.
double gated_distance(const Eigen::Vector3d& centroid_cam, const TrueBodyView& view, bool exact,
                      const AssociationConfig& config) {
  constexpr double kTieBreak_per_m = 1e-6;
  const Eigen::Vector3d p_body = view.T_cam_body.inverse() * centroid_cam;
  if (!view.half_size_m) return p_body.norm() / config.centre_gate_m;
  const Eigen::Vector3d outside = (p_body.cwiseAbs() - *view.half_size_m).cwiseMax(0.0);
  return outside.norm() / (exact ? config.box_gate_m : config.rough_box_gate_m) + kTieBreak_per_m * p_body.norm();
}

std::vector<Candidate> near_pairs(const EstimatedFrame& frame, const TrueFrame& truth, bool exact,
                                  const AssociationConfig& config) {
  std::vector<Candidate> candidates;
  if (!frame.T_world_cam) return candidates;
  const Rigid3 T_cam_world = frame.T_world_cam->inverse();
  for (const EstimatedObject& object : frame.objects) {
    const bool confirmed = object.phase == ObjectPhase::confirmed;
    if (!confirmed && object.phase != ObjectPhase::coasting) continue;
    const Eigen::Vector3d centroid_cam = T_cam_world * object.centroid_world;
    for (const TrueBodyView& view : truth.bodies) {
      const double distance = gated_distance(centroid_cam, view, exact, config);
      if (distance <= 1.0) candidates.push_back({object.id, view.body, distance, confirmed});
    }
  }
  // Measured objects before extrapolated ones, then the nearest; ids break ties so that the order is one.
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    if (a.confirmed != b.confirmed) return a.confirmed;
    if (a.distance != b.distance) return a.distance < b.distance;
    return a.object != b.object ? a.object < b.object : a.body < b.body;
  });
  return candidates;
}

void pair_up(const std::vector<Candidate>& candidates, const FrameMatches& previous, FrameMatches& matches) {
  const auto is_free = [&](const Candidate& c) { return !matches.of_object(c.object) && !matches.of_body(c.body); };
  for (const Candidate& c : candidates) {
    const ObjectMatch* before = previous.of_object(c.object);
    if (before && before->body == c.body && is_free(c)) matches.pairs.push_back({c.object, c.body});
  }
  for (const Candidate& c : candidates) {
    if (is_free(c)) matches.pairs.push_back({c.object, c.body});
  }
}

void note_duplicates(const std::vector<Candidate>& candidates, const TrueFrame& truth, FrameMatches& matches) {
  for (const Candidate& c : candidates) {
    const bool claims_moving_body = c.confirmed && truth.find(c.body)->moving;
    if (claims_moving_body && !matches.of_object(c.object)) matches.duplicates.push_back({c.object, c.body});
  }
}

}  // namespace

const ObjectMatch* FrameMatches::of_object(BodyId object) const {
  const auto found = std::find_if(pairs.begin(), pairs.end(), [&](const ObjectMatch& m) { return m.object == object; });
  return found == pairs.end() ? nullptr : &*found;
}

const ObjectMatch* FrameMatches::of_body(int body) const {
  const auto found = std::find_if(pairs.begin(), pairs.end(), [&](const ObjectMatch& m) { return m.body == body; });
  return found == pairs.end() ? nullptr : &*found;
}

std::vector<FrameMatches> associate(const EstimatedRun& run, const Truth& truth, const AssociationConfig& config) {
  std::vector<FrameMatches> all(run.size());
  FrameMatches previous;
  for (std::size_t i = 0; i < run.size() && i < truth.frames.size(); ++i) {
    const std::vector<Candidate> candidates = near_pairs(run[i], truth.frames[i], truth.exact, config);
    pair_up(candidates, previous, all[i]);
    note_duplicates(candidates, truth.frames[i], all[i]);
    previous = all[i];
  }
  return all;
}

}  // namespace pelorus
