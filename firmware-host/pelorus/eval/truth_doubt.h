#pragma once
// truth_doubt: signs that a run was not made from the data set whose truth it is held against. A recording has no name
// that a run could keep, so times and the camera's path have to speak: dives with the same times and the same path are
// not told apart. Pure.

#include <optional>
#include <string>

#include "core/evaluation/evaluation.h"

namespace pelorus {

// Absent: nothing speaks against it. Else one sentence for people.
[[nodiscard]] std::optional<std::string> truth_doubt(const Evaluation& evaluation);

// Frames of the run whose time has a true pose.
[[nodiscard]] std::size_t frames_with_truth(const Truth& truth);

}  // namespace pelorus
