// Behavior of the whole chain, frame by frame, as a file that shows in a diff. Numbers may differ by what another
// processor's rounding does to an estimate; states, objects and phases may not. After a wanted change:
// `cmake --build --preset ci --target golden_update`, and give the reason in the commit.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "tests/golden/small_dive.h"

namespace pelorus {
namespace {

// In the units of the file: mm and millidegrees.
constexpr double kTolerance = 2.0;

std::string numbers(const Eigen::Vector3d& v) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), " %.1f %.1f %.1f", v.x(), v.y(), v.z());
  return text.data();
}

// One line per frame: state, camera position [mm] and rotation vector [mdeg], then each object with its centroid [mm].
std::string summary_of(const EstimatedRun& run) {
  constexpr double kMilliDegPerRad = 180e3 / 3.14159265358979;
  std::string text;
  for (const EstimatedFrame& frame : run) {
    text += std::to_string(frame.seq) + " " + to_text(frame.state);
    if (frame.T_world_cam) {
      text += numbers(1e3 * frame.T_world_cam->translation());
      text += numbers(kMilliDegPerRad * so3_log(frame.T_world_cam->linear()));
    }
    for (const EstimatedObject& object : frame.objects) {
      text += " | object " + std::to_string(object.id.value) + " " + to_text(object.phase);
      text += numbers(1e3 * object.centroid_world);
    }
    text += "\n";
  }
  return text;
}

// The first difference, or nothing.
std::string difference(const std::string& golden, const std::string& now) {
  std::istringstream golden_lines(golden);
  std::istringstream now_lines(now);
  std::string golden_line, now_line;
  while (true) {
    const bool more_golden = static_cast<bool>(std::getline(golden_lines, golden_line));
    const bool more_now = static_cast<bool>(std::getline(now_lines, now_line));
    if (!more_golden && !more_now) return "";
    if (more_golden != more_now) return "one has more frames than the other";
    std::istringstream a(golden_line);
    std::istringstream b(now_line);
    std::string x, y;
    while (true) {
      const bool more_x = static_cast<bool>(a >> x);
      const bool more_y = static_cast<bool>(b >> y);
      if (!more_x && !more_y) break;
      char* end = nullptr;
      const double number = more_x ? std::strtod(x.c_str(), &end) : 0;
      const bool numeric = more_x && more_y && *end == '\0';
      const bool same =
          more_x == more_y && (x == y || (numeric && std::abs(number - std::atof(y.c_str())) <= kTolerance));
      if (!same) return "golden: " + golden_line + "\n   now: " + now_line;
    }
  }
}

TEST(GoldenReplay, SmallDiveComesOutAsRecorded) {
  const test::TemporaryFolder folder;
  test::replay_small_dive(folder, 0);
  const auto run = read_run(folder.path());
  ASSERT_TRUE(run.ok()) << run.error().message();
  const std::string now = summary_of(run.value());
  const std::string file = test::golden_path("small_dive.txt");
  if (std::getenv("PELORUS_GOLDEN_UPDATE") != nullptr) {
    test::write_text(file, now);
    GTEST_SKIP() << "recorded anew: " << file;
  }
  ASSERT_TRUE(std::filesystem::exists(file)) << file << " is not recorded: build the target golden_update";
  EXPECT_EQ(difference(test::read_text(file), now), "") << "after a wanted change: build the target golden_update";
}

TEST(GoldenReplay, ComparisonSeesWhatMatters) {
  const std::string line = "3 TRACKING 1.0 2.0 3.0 | object 1 confirmed 4.0 5.0 6.0\n";
  EXPECT_EQ(difference(line, line), "");
  EXPECT_EQ(difference(line, "3 TRACKING 1.5 2.0 3.0 | object 1 confirmed 4.0 5.0 6.0\n"), "");
  EXPECT_NE(difference(line, "3 TRACKING 9.0 2.0 3.0 | object 1 confirmed 4.0 5.0 6.0\n"), "");
  EXPECT_NE(difference(line, "3 DEGRADED 1.0 2.0 3.0 | object 1 confirmed 4.0 5.0 6.0\n"), "");
  EXPECT_NE(difference(line, "3 TRACKING 1.0 2.0 3.0 | object 1 coasting 4.0 5.0 6.0\n"), "");
  EXPECT_NE(difference(line, "3 TRACKING 1.0 2.0 3.0\n"), "");
  EXPECT_NE(difference(line, line + line), "");
}

}  // namespace
}  // namespace pelorus
