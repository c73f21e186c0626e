#pragma once
// The small dive of this folder through run_replay, and the summary of its results that golden files hold.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "drivers/synthetic/scene_file.h"
#include "drivers/synthetic/synthetic_source.h"
#include "firmware-host/pelorus/replay/replay_run.h"
#include "firmware-host/pelorus/results/result_reader.h"
#include "tests/support/temporary_folder.h"

namespace pelorus::test {

inline std::string golden_path(const std::string& name) {
  return std::string(PELORUS_SOURCE_DIR "/tests/golden/") + name;
}

inline void replay_small_dive(const TemporaryFolder& folder, int threads, bool step_threads = true) {
  const auto scene = synthetic::load_scene(golden_path("small_dive.yaml"));
  ASSERT_TRUE(scene.ok()) << scene.error().message();
  synthetic::SyntheticSource source(scene.value(), threads);
  ReplayOptions options;
  options.out_folder = folder.path();
  options.threads = step_threads;
  const auto summary = run_replay(source, options);
  ASSERT_TRUE(summary.ok()) << summary.error().message();
  ASSERT_FALSE(summary.value().failure) << summary.value().failure->message();
}

}  // namespace pelorus::test
