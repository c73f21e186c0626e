#pragma once
// Dives for the verbs that need more than one run over the same frames: a scene is rendered once, as an EuRoC ASL
// folder with its truth, and replayed from there. Thread-bound.

#include <cstdint>
#include <filesystem>
#include <string>

#include "core/base/result.h"

namespace pelorus {

// Renders into `folder`, replacing what is there; max_frames 0 = the scene's. Shows a progress bar. False: interrupted
// (ReplayInterrupt), nothing left behind.
[[nodiscard]] Result<bool> render_dive(const std::string& scene, std::uint64_t max_frames,
                                       const std::filesystem::path& folder);

}  // namespace pelorus
