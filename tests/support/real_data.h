#pragma once
// Recorded data sets for tests. They are not part of the project: PELORUS_DATA_DIR names their folder, by default
// ../shared/data beside the project. A test skips where they are absent, and fails when PELORUS_REQUIRE_DATA is set
// (continuous integration), so that nothing is skipped there unseen.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace pelorus {

inline std::filesystem::path real_data_dir() {
  const char* given = std::getenv("PELORUS_DATA_DIR");
  return given != nullptr ? std::filesystem::path(given)
                          : std::filesystem::path(PELORUS_SOURCE_DIR) / ".." / "shared" / "data";
}

}  // namespace pelorus

// First statement of a test: declares `path`, the named folder of the recorded data, or skips the test.
#define PELORUS_USE_REAL_DATA(path, folder)                                                           \
  const std::filesystem::path path = ::pelorus::real_data_dir() / (folder);                           \
  if (!std::filesystem::exists(path)) {                                                               \
    if (std::getenv("PELORUS_REQUIRE_DATA") != nullptr) FAIL() << path << " is required and missing"; \
    GTEST_SKIP() << "recorded data absent: " << path << " (set PELORUS_DATA_DIR)";                    \
  }
