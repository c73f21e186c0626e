#include "core/motion/grouping.h"

#include <algorithm>

#include "core/base/check.h"
#include "core/base/fixed_vector.h"
#include "core/motion/stereo_transfer.h"

namespace pelorus {
namespace {

constexpr std::size_t kMaxNeighbours = 64;
constexpr int kMostRefused = 8;        // motions that lose their points when refined: each costs an adjustment
constexpr int kSampledProposals = 24;  // as many as a typical number of seeds, for a fair ablation

const PointPair& at(PointPairs pairs, PointIndex i) { return pairs[static_cast<std::size_t>(i)]; }

}  // namespace

Grouping::Grouping(const GroupingConfig& config, const SeedPointsConfig& seeds, const TwoFrameBaConfig& ba,
                   int capacity)
    : config_(config), seed_points_(seeds, capacity), two_frame_ba_(ba, capacity) {
  PELORUS_CHECK(config.neighbours >= 0 && config.neighbours <= static_cast<int>(kMaxNeighbours), "bad neighbours");
  const auto points = static_cast<std::size_t>(capacity);
  const auto proposals = static_cast<std::size_t>(std::max(seeds.columns * seeds.rows, kSampledProposals));
  const auto motions =
      std::max(proposals + std::size_t{2} * (kMaxObjects + 1), static_cast<std::size_t>(config.max_groups));
  motions_.reserve(motions);
  motion_chi2_.resize(motions);
  for (auto& chi2 : motion_chi2_) chi2.reserve(points);
  refined_chi2_.reserve(points);
  seed_groups_.resize(proposals);
  for (auto& group : seed_groups_) group.reserve(points);
  spare_.resize(static_cast<std::size_t>(config.max_groups) + 1);
  for (auto& members : spare_) members.reserve(points);
  spare_.reserve(2 * spare_.size());
  partition_.groups.reserve(static_cast<std::size_t>(config.max_groups));
  partition_.group_of.reserve(points);
  histories_.reserve(points);
  labelled_.reserve(points);
  label_.reserve(points);
  neighbours_.reserve(points * static_cast<std::size_t>(config.neighbours));
  candidate_points_.reserve(points);
  proposal_points_.reserve(points);
}

Group Grouping::empty_group() {
  Group group;
  group.members = std::move(spare_.back());
  group.members.clear();
  spare_.pop_back();
  return group;
}

const Partition& Grouping::run(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> candidates,
                               std::span<const Rigid3> prior_motions, std::uint64_t seed, const Options& options) {
  for (Group& group : partition_.groups) spare_.push_back(std::move(group.members));
  partition_.groups.clear();
  partition_.group_of.assign(pairs.size(), -1);
  label_.assign(candidates.size(), -1);
  motions_.assign(prior_motions.begin(), prior_motions.end());
  if (candidates.size() < static_cast<std::size_t>(config_.min_group_points)) return partition_;

  candidate_points_.assign(rig, pairs, candidates);
  propose_by_labels(rig, pairs, candidates, seed);
  if (options.rigidity) {
    propose_by_rigidity(rig, pairs, candidates, seed);
  } else {
    propose_by_sampling(rig, pairs, candidates, seed);
  }
  claim_groups(rig, pairs, candidates);
  if (options.reassignment) {
    find_neighbours(pairs, candidates);
    for (int round = 0; round < config_.reassignments; ++round) reassign(rig, pairs, candidates);
  }
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    partition_.group_of[static_cast<std::size_t>(candidates[c])] = label_[c];
  }
  return partition_;
}

// What moved together before is likely to do so again: the points of each body propose its motion of this step.
void Grouping::propose_by_labels(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> candidates,
                                 std::uint64_t seed) {
  for (BodyId body = kWorldBody; body.value >= 0;) {
    BodyId next = kNoBody;
    labelled_.clear();
    for (const PointIndex i : candidates) {
      const BodyId here = at(pairs, i).previous_body;
      if (here == body) labelled_.push_back(i);
      if (here > body && (next == kNoBody || here < next)) next = here;
    }
    if (static_cast<int>(labelled_.size()) >= config_.min_group_points) {
      const auto label_seed = seed * 64 + 63 + static_cast<std::uint64_t>(body.value) * 4096;
      const auto motion = propose_motion(rig, pairs, labelled_, label_seed, config_.proposal, proposal_points_);
      if (motion) {
        const MotionFit fit = two_frame_ba_.run(rig, pairs, labelled_, *motion);
        motions_.push_back(fit.outcome == StageOutcome::ok ? fit.H_curr_prev : *motion);
      }
    }
    body = next;
  }
}

bool Grouping::is_known(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> group,
                        std::size_t known_motions) {
  proposal_points_.assign(rig, pairs, group);
  for (std::size_t m = 0; m < known_motions; ++m) {
    const auto chi2 = proposal_points_.chi2(rig, motions_[m]);
    const auto explained = std::count_if(chi2.begin(), chi2.end(), [](double c) { return c < kChi2_3dof_990; });
    if (static_cast<double>(explained) >= config_.known_share * static_cast<double>(group.size())) return true;
  }
  return false;
}

// Paper 5.1: no accept threshold; each point goes to the seed with which it is most rigid.
void Grouping::propose_by_rigidity(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> candidates,
                                   std::uint64_t seed) {
  const std::size_t known_motions = motions_.size();
  const auto seeds = seed_points_.run(rig, pairs, candidates);
  histories_.resize(pairs.size());
  for (const PointIndex i : candidates) histories_[static_cast<std::size_t>(i)] = history_of(rig, at(pairs, i));
  for (auto& group : seed_groups_) group.clear();
  for (const PointIndex i : candidates) {
    std::size_t best = 0;
    double best_cost = 1e30;
    for (std::size_t s = 0; s < seeds.size(); ++s) {
      if (seeds[s] == i) continue;
      const double cost =
          rigidity(histories_[static_cast<std::size_t>(seeds[s])], histories_[static_cast<std::size_t>(i)]).cost;
      if (cost < best_cost) {
        best_cost = cost;
        best = s;
      }
    }
    seed_groups_[best].push_back(i);
  }
  for (std::size_t s = 0; s < seeds.size(); ++s) {
    if (is_known(rig, pairs, seed_groups_[s], known_motions)) continue;
    const auto motion = propose_motion(rig, pairs, seed_groups_[s], seed * 64 + s, config_.proposal, proposal_points_);
    if (motion) motions_.push_back(*motion);
  }
}

void Grouping::propose_by_sampling(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> candidates,
                                   std::uint64_t seed) {
  for (std::uint64_t s = 0; s < kSampledProposals; ++s) {
    const auto motion = propose_motion(rig, pairs, candidates, seed * 64 + s, config_.proposal, proposal_points_);
    if (motion) motions_.push_back(*motion);
  }
}

void Grouping::score(const StereoRig& rig, const Rigid3& motion, std::vector<float>& chi2) {
  const auto of_candidates = candidate_points_.chi2(rig, motion);
  chi2.resize(of_candidates.size());
  std::transform(of_candidates.begin(), of_candidates.end(), chi2.begin(),
                 [](double c) { return static_cast<float>(c); });
}

// Greedy cover: the motion that explains most of what is left, refined on it, claims it. Proposals that agree with
// one already taken find nothing left: that is the consolidation of groups with equal motions.
void Grouping::claim_groups(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> candidates) {
  for (std::size_t m = 0; m < motions_.size(); ++m) score(rig, motions_[m], motion_chi2_[m]);
  for (int refused = 0; refused < kMostRefused && static_cast<int>(partition_.groups.size()) < config_.max_groups;) {
    const std::size_t best = most_explaining();
    if (best == motions_.size()) break;
    if (claim(rig, pairs, candidates, best)) continue;
    motion_chi2_[best].clear();
    ++refused;
  }
  collect_members(candidates);
}

// Of what is left; motions_.size() when none explains enough for a group. What is left only shrinks: a motion that
// explains too little now is spent for good, and its chi-squares are cleared.
std::size_t Grouping::most_explaining() {
  std::size_t best = motions_.size();
  double best_score = 0;
  for (std::size_t m = 0; m < motions_.size(); ++m) {
    double sum = 0;
    int explained = 0;
    for (std::size_t c = 0; c < motion_chi2_[m].size(); ++c) {
      const double gain = config_.gate_chi2 - static_cast<double>(motion_chi2_[m][c]);
      if (label_[c] >= 0 || !(gain > 0)) continue;
      sum += gain;
      ++explained;
    }
    if (explained < config_.min_group_points) {
      motion_chi2_[m].clear();
    } else if (sum > best_score) {
      best_score = sum;
      best = m;
    }
  }
  return best;
}

// False, and nothing claimed, when the motion as refined on what it explains explains too little.
bool Grouping::claim(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> candidates,
                     std::size_t proposal) {
  Group group = empty_group();
  const auto explained = [&](const std::vector<float>& chi2, std::size_t c) {
    return label_[c] < 0 && static_cast<double>(chi2[c]) < config_.gate_chi2;
  };
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    if (explained(motion_chi2_[proposal], c)) group.members.push_back(candidates[c]);
  }
  const MotionFit fit = two_frame_ba_.run(rig, pairs, group.members, motions_[proposal]);
  group.H_curr_prev = fit.outcome == StageOutcome::degenerate ? motions_[proposal] : fit.H_curr_prev;
  score(rig, group.H_curr_prev, refined_chi2_);
  int claimed = 0;
  for (std::size_t c = 0; c < candidates.size(); ++c) claimed += explained(refined_chi2_, c);
  if (claimed < config_.min_group_points) {
    spare_.push_back(std::move(group.members));
    return false;
  }
  const auto number = static_cast<std::int32_t>(partition_.groups.size());
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    if (explained(refined_chi2_, c)) label_[c] = number;
  }
  partition_.groups.push_back(std::move(group));
  return true;
}

void Grouping::find_neighbours(PointPairs pairs, std::span<const PointIndex> candidates) {
  const auto k = static_cast<std::size_t>(config_.neighbours);
  neighbours_.assign(candidates.size() * k, -1);
  FixedVector<double, kMaxNeighbours> nearest(k);
  const double radius2 = config_.neighbour_radius_px * config_.neighbour_radius_px;
  for (std::size_t a = 0; a < candidates.size(); ++a) {
    std::fill(nearest.begin(), nearest.end(), radius2);
    const Eigen::Vector2d here = at(pairs, candidates[a]).curr.z_px.head<2>();
    std::int32_t* list = &neighbours_[a * k];
    for (std::size_t b = 0; b < candidates.size(); ++b) {
      const double d2 = (at(pairs, candidates[b]).curr.z_px.head<2>() - here).squaredNorm();
      if (a == b || d2 >= nearest[k - 1]) continue;
      std::size_t place = k - 1;
      for (; place > 0 && nearest[place - 1] > d2; --place) {
        nearest[place] = nearest[place - 1];
        list[place] = list[place - 1];
      }
      nearest[place] = d2;
      list[place] = static_cast<std::int32_t>(b);
    }
  }
}

// Least stereo residual plus smoothness (Judd & Gammell 2018 label in the same spirit), then refined motions.
void Grouping::reassign(const StereoRig& rig, PointPairs pairs, std::span<const PointIndex> candidates) {
  const auto groups = partition_.groups.size();
  if (groups == 0) return;
  for (std::size_t g = 0; g < groups; ++g) {
    score(rig, partition_.groups[g].H_curr_prev, motion_chi2_[g]);
  }
  const auto k = static_cast<std::size_t>(config_.neighbours);
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    std::int32_t best = -1;
    double best_cost = config_.gate_chi2 + config_.smoothness_chi2;
    for (std::size_t g = 0; g < groups; ++g) {
      const double chi2 = static_cast<double>(motion_chi2_[g][c]);
      if (chi2 >= config_.gate_chi2) continue;
      int other = 0;
      int all = 0;
      for (std::size_t n = 0; n < k && neighbours_[c * k + n] >= 0; ++n, ++all) {
        other += label_[static_cast<std::size_t>(neighbours_[c * k + n])] != static_cast<std::int32_t>(g);
      }
      const double cost = chi2 + (all > 0 ? config_.smoothness_chi2 * other / all : 0.0);
      if (cost < best_cost) {
        best_cost = cost;
        best = static_cast<std::int32_t>(g);
      }
    }
    label_[c] = best;
  }
  collect_members(candidates);
  for (Group& group : partition_.groups) {
    const MotionFit fit = two_frame_ba_.run(rig, pairs, group.members, group.H_curr_prev);
    if (fit.outcome == StageOutcome::too_few_points || fit.outcome == StageOutcome::degenerate) continue;
    group.H_curr_prev = fit.H_curr_prev;
    group.cov_H = fit.cov_H;
    group.rms_px = fit.rms_px;
  }
}

void Grouping::collect_members(std::span<const PointIndex> candidates) {
  for (Group& group : partition_.groups) group.members.clear();
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    if (label_[c] >= 0) partition_.groups[static_cast<std::size_t>(label_[c])].members.push_back(candidates[c]);
  }
}

}  // namespace pelorus
