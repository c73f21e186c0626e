#pragma once
// How completely and how exclusively moving bodies are tracked: coverage, identity switches, time to detection, false
// objects, right number of motions. A body is "on show" in a frame when it moves and more than min_visible_px pixels
// of it are seen (unknown counts as seen); frame 0 of a run is left out: no motion has happened yet. Pure.

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/evaluation/association.h"
#include "core/evaluation/records.h"

namespace pelorus {

struct TrackingConfig {
  int min_visible_px = 400;
  double identity_pause_s = 2.0;  // a body not on show for longer than this may come back as a new object
  double settling_s = 1.0;        // time in which a body that came into view need not yet be counted
};

struct BodyScore {
  std::size_t frames_on_show = 0;
  std::size_t frames_covered = 0;  // of these, with a confirmed object
  std::set<BodyId> ids;            // confirmed objects that were this body
  int identity_switches = 0;
  std::optional<double> time_to_detection_s;  // from first on show to first covered; absent = never

  [[nodiscard]] double coverage() const {
    return frames_on_show == 0 ? 0 : static_cast<double>(frames_covered) / static_cast<double>(frames_on_show);
  }
};

// A confirmed object that was never matched with a moving body.
struct FalseObject {
  BodyId id;
  std::size_t frames = 0;    // confirmed
  bool duplicate = false;    // it was near a moving body that another object had already
  std::string resting_body;  // body at rest that it sat on; empty = none
};

struct TrackingScore {
  std::vector<BodyScore> bodies;  // one per body of the truth
  std::size_t frames = 0;         // judged: with a pose and truth
  std::vector<FalseObject> false_objects;
  double false_per_1000_frames = 0;
  // Share of frames whose number of confirmed objects equals the number of bodies on show. An object kept on a body
  // that rests or is hardly seen right now is not held against it. (Judd & Gammell 2018: correct motion count.)
  // Absent where there is no such frame.
  std::optional<double> right_count_share;
  // The same without the frames within settling_s of a body coming into view or starting to move.
  std::optional<double> right_count_settled_share;
};

[[nodiscard]] TrackingScore tracking_score(const EstimatedRun& run, const Truth& truth,
                                           const std::vector<FrameMatches>& matches, const TrackingConfig& config);

}  // namespace pelorus
