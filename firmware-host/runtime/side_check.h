#pragma once
// Are the left and the right pictures of a recording exchanged? A point in front of both cameras lies further left in
// the right picture, so stereo matching finds much as given and next to nothing with the pictures exchanged; where it
// is the other way round, the recording's pictures are exchanged. Nothing else in a run shows it: the results look like
// results. Thread-bound.

#include <string>

#include "core/base/result.h"
#include "core/geometry/rectifier.h"
#include "drivers/stereo_source.h"

namespace pelorus {

// Points of one pair that match with a disparity of a few pixels or more.
struct SideMatches {
  int as_given = 0;
  int exchanged = 0;
};

enum class Sides { unclear, as_given, exchanged };

// Two SURF detections and up to 800 stereo matches.
[[nodiscard]] SideMatches match_sides(const SourcePair& pair, const Rectifier& rectifier);
// Unclear: too few matches either way (darkness, turbid water, all things far away), or no clear majority.
[[nodiscard]] Sides sides_of(const SideMatches& matches);

// An Error that says what to exchange when the first pairs of `source` are clearly exchanged. Reads on until two pairs
// are clear, a few pairs at most; pairs that cannot be read are passed over. `place` names the recording.
[[nodiscard]] Result<> check_sides(StereoSource& source, const std::string& place);

}  // namespace pelorus
