#pragma once
// pelorusd as a process of its own on a recorded dive, with a listener on its bus: for tests of the service as a whole.

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <pelorus/vis_health_t.hpp>
#include <pelorus/vis_odom_t.hpp>
#include <string>
#include <vector>

#include "drivers/synthetic/scene_file.h"
#include "firmware-host/pelorus/replay/replay_dive.h"
#include "tests/services/lcm_loopback.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace pelorus::test {

inline constexpr int kDiveFrames = 25;
inline constexpr double kDiveRate_hz = 10;

// Patient, so that a loaded machine does not fail a test that is about something else.
inline const std::string kPatient = "timing:\n  latency_ms: 400\n  deadline_tolerance_ms: 1000\n";
inline const std::string kForever = kPatient + "# repeat\n";

// The golden dive, a little longer, as an EuRoC folder; rendered once for the whole program.
inline const std::filesystem::path& rendered_dive() {
  static const TemporaryFolder folder;
  static const std::filesystem::path dive = [] {
    std::string scene = read_text(PELORUS_SOURCE_DIR "/tests/golden/small_dive.yaml");
    scene.replace(scene.find("frames: 16"), 10, "frames: " + std::to_string(kDiveFrames));
    write_text(folder.path() / "scene.yaml", scene);
    const auto rendered = render_dive((folder.path() / "scene.yaml").string(), 0, folder.path() / "dive");
    EXPECT_TRUE(rendered.ok()) << rendered.error().message();
    return folder.path() / "dive";
  }();
  return dive;
}

// A copy to be damaged.
inline std::filesystem::path copied_dive(const TemporaryFolder& folder) {
  std::filesystem::copy(rendered_dive(), folder.path() / "dive", std::filesystem::copy_options::recursive);
  return folder.path() / "dive";
}

// Names of the pictures of one camera, in order of time.
inline std::vector<std::filesystem::path> pictures(const std::filesystem::path& dive, int camera) {
  std::vector<std::filesystem::path> all;
  for (const auto& entry :
       std::filesystem::directory_iterator(dive / "mav0" / ("cam" + std::to_string(camera)) / "data")) {
    all.push_back(entry.path());
  }
  std::sort(all.begin(), all.end());
  return all;
}

class RunningService {
 public:
  // `settings`: further sections of the configuration, `lcm`: further lines of that one. The listener is there before
  // the service.
  RunningService(const std::filesystem::path& dive, const std::string& settings, int bus, const std::string& lcm = "")
      : RunningService("source:\n  path: \"" + dive.string() + "\"\n" + repeat(settings), settings, bus, lcm) {}
  // `source`: the whole section.
  RunningService(const std::string& source, const std::string& settings, int bus, const std::string& lcm = "")
      : url_(loopback_url(bus)), odom(url_, "TEST.VIS_ODOM"), health(url_, "TEST.VIS_HEALTH") {
    write_text(config(), source + "lcm:\n  url: \"" + url_ + "\"\n  vehicle: TEST\n" + lcm + settings);
    process = std::make_unique<ChildProcess>(std::vector<std::string>{PELORUSD, "--config", config().string()},
                                             folder_.path() / "log");
  }

  [[nodiscard]] std::string log() const { return read_text(folder_.path() / "log"); }
  [[nodiscard]] const std::string& url() const { return url_; }
  // Takes messages until one says so, or 20 s are over.
  bool wait_for_state(const std::string& state, const std::string& reason = "") {
    return odom.wait(
        [&] {
          for (; seen_ < odom.messages.size(); ++seen_) {
            const vis_odom_t& m = odom.messages[seen_];
            if (m.state_text == state && (reason.empty() || m.reason_text == reason)) return true;
          }
          return false;
        },
        20);
  }
  // Until the process ends and all its messages are here; its exit code.
  int finish() {
    int code = -2;
    odom.wait([&] { return (code = process->wait_at_most(0)) != -2; }, 30);
    odom.wait([] { return false; }, 0.2);
    health.wait([] { return false; }, 0.2);
    return code;
  }

 private:
  // Sections may be given once: `repeat` belongs to the source.
  static std::string repeat(const std::string& settings) {
    return settings.find("# repeat") != std::string::npos ? "  repeat: true\n" : "";
  }
  [[nodiscard]] std::filesystem::path config() const { return folder_.path() / "pelorus.yaml"; }

  TemporaryFolder folder_;
  std::string url_;

 public:
  Listener<vis_odom_t> odom;
  Listener<vis_health_t> health;
  std::unique_ptr<ChildProcess> process;

 private:
  std::size_t seen_ = 0;
};

}  // namespace pelorus::test
