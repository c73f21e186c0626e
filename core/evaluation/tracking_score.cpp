#include "core/evaluation/tracking_score.h"

#include <algorithm>
#include <map>

namespace pelorus {
namespace {

bool is_on_show(const TrueBodyView& view, const TrackingConfig& config) {
  return view.moving && (!view.visible_px || *view.visible_px > config.min_visible_px);
}

bool is_confirmed(const EstimatedFrame& frame, BodyId id) {
  return std::any_of(frame.objects.begin(), frame.objects.end(), [&](const EstimatedObject& object) {
    return object.id == id && object.phase == ObjectPhase::confirmed;
  });
}

// The confirmed object that is `body` in frame i.
std::optional<BodyId> covering(const EstimatedRun& run, const std::vector<FrameMatches>& matches, std::size_t i,
                               int body) {
  const ObjectMatch* match = matches[i].of_body(body);
  if (!match || !is_confirmed(run[i], match->object)) return std::nullopt;
  return match->object;
}

BodyScore score_body(const EstimatedRun& run, const Truth& truth, const std::vector<FrameMatches>& matches, int body,
                     const TrackingConfig& config) {
  BodyScore score;
  std::optional<BodyId> last_id;
  std::optional<Timestamp> first_on_show;
  std::optional<Timestamp> last_on_show;
  bool switch_allowed = false;
  for (std::size_t i = 1; i < matches.size(); ++i) {
    const TrueBodyView* view = truth.frames[i].find(body);
    const std::optional<BodyId> id = covering(run, matches, i, body);
    const Timestamp now = run[i].capture_time;
    if (view && is_on_show(*view, config)) {
      if (!first_on_show) first_on_show = now;
      if (last_on_show && seconds(now - *last_on_show) > config.identity_pause_s) switch_allowed = true;
      last_on_show = now;
      ++score.frames_on_show;
      if (id) ++score.frames_covered;
    }
    if (!id) continue;
    if (last_id && *id != *last_id && !switch_allowed) ++score.identity_switches;
    switch_allowed = false;
    last_id = id;
    if (view->moving) score.ids.insert(*id);
    if (first_on_show && !score.time_to_detection_s) score.time_to_detection_s = seconds(now - *first_on_show);
  }
  return score;
}

struct Life {
  std::size_t confirmed_frames = 0;
  bool was_moving_body = false;
  bool was_duplicate = false;
  int resting_body = -1;
};

std::vector<FalseObject> find_false_objects(const EstimatedRun& run, const Truth& truth,
                                            const std::vector<FrameMatches>& matches) {
  std::map<BodyId, Life> lives;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    for (const EstimatedObject& object : run[i].objects) {
      if (object.phase != ObjectPhase::confirmed) continue;
      Life& life = lives[object.id];
      ++life.confirmed_frames;
      const ObjectMatch* match = matches[i].of_object(object.id);
      if (!match) continue;
      const bool moving = truth.frames[i].find(match->body)->moving;
      life.was_moving_body |= moving;
      if (!moving) life.resting_body = match->body;
    }
    for (const ObjectMatch& duplicate : matches[i].duplicates) lives[duplicate.object].was_duplicate = true;
  }
  std::vector<FalseObject> found;
  for (const auto& [id, life] : lives) {
    if (life.was_moving_body) continue;
    const std::string resting = life.resting_body < 0 ? "" : truth.bodies[static_cast<std::size_t>(life.resting_body)];
    found.push_back({id, life.confirmed_frames, life.was_duplicate, resting});
  }
  return found;
}

// Objects that claim to be a motion now, less those excused because their body rests or hardly shows.
std::size_t claimed_motions(const EstimatedFrame& frame, const TrueFrame& truth, const FrameMatches& matches,
                            const TrackingConfig& config) {
  return static_cast<std::size_t>(
      std::count_if(frame.objects.begin(), frame.objects.end(), [&](const EstimatedObject& object) {
        if (object.phase != ObjectPhase::confirmed) return false;
        const ObjectMatch* match = matches.of_object(object.id);
        return !match || is_on_show(*truth.find(match->body), config);
      }));
}

void count_motions(const EstimatedRun& run, const Truth& truth, const std::vector<FrameMatches>& matches,
                   const TrackingConfig& config, TrackingScore& score) {
  std::map<int, Timestamp> on_show_since;
  std::size_t right = 0;
  std::size_t settled = 0;
  std::size_t right_settled = 0;
  for (std::size_t i = 1; i < matches.size(); ++i) {
    std::size_t wanted = 0;
    bool settling = false;
    std::map<int, Timestamp> still_on_show;
    for (const TrueBodyView& view : truth.frames[i].bodies) {
      if (!is_on_show(view, config)) continue;
      ++wanted;
      const auto before = on_show_since.find(view.body);
      const Timestamp since = before == on_show_since.end() ? run[i].capture_time : before->second;
      still_on_show[view.body] = since;
      settling |= seconds(run[i].capture_time - since) < config.settling_s;
    }
    on_show_since = still_on_show;
    const bool is_right = run[i].T_world_cam && claimed_motions(run[i], truth.frames[i], matches[i], config) == wanted;
    ++score.frames;
    right += is_right;
    settled += !settling;
    right_settled += is_right && !settling;
  }
  const auto share = [](std::size_t part, std::size_t whole) -> std::optional<double> {
    if (whole == 0) return std::nullopt;
    return static_cast<double>(part) / static_cast<double>(whole);
  };
  score.right_count_share = share(right, score.frames);
  score.right_count_settled_share = share(right_settled, settled);
}

}  // namespace

TrackingScore tracking_score(const EstimatedRun& run, const Truth& truth, const std::vector<FrameMatches>& matches,
                             const TrackingConfig& config) {
  TrackingScore score;
  for (std::size_t body = 0; body < truth.bodies.size(); ++body) {
    score.bodies.push_back(score_body(run, truth, matches, static_cast<int>(body), config));
  }
  score.false_objects = find_false_objects(run, truth, matches);
  count_motions(run, truth, matches, config, score);
  if (!run.empty()) {
    score.false_per_1000_frames =
        1000.0 * static_cast<double>(score.false_objects.size()) / static_cast<double>(run.size());
  }
  return score;
}

}  // namespace pelorus
