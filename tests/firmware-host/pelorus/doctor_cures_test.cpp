// What the whole round of checks says: on this computer, and on one that tells nothing of itself.
#include <gtest/gtest.h>

#include "firmware-host/pelorus/doctor/checkup.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

// Settings that name what is not there, and ask for what few computers grant.
std::vector<ServiceConfig> demanding_settings() {
  ServiceConfig recorded;
  recorded.source.path = "/nonexistent/dive";
  recorded.can.enabled = true;
  recorded.can.interface = "nosuchcan0";
  recorded.recorder.folder = "/nonexistent/recordings";
  recorded.lcm.url = "udpm://239.255.76.67:7667?ttl=8";
  ServiceConfig ethernet;
  ethernet.source.kind = "aravis";
  ethernet.source.calibration = "/nonexistent/stereo.yaml";
  ethernet.camera.left = "192.0.2.1";
  ethernet.camera.right = "192.0.2.2";
  ethernet.camera.clock = "ptp";
  ethernet.camera.packet_socket = false;
  ethernet.lcm.url = "nonsense";
  ServiceConfig usb;
  usb.source.kind = "v4l2";
  usb.camera.left = "/dev/nosuchvideo";
  usb.timing.deadline_tolerance_ms = 0.001;
  return {ServiceConfig{}, recorded, ethernet, usb};
}

TEST(DoctorCures, EveryWarningAndFailureHasOne) {
  const test::TemporaryFolder bare;
  int judged = 0;
  for (const ServiceConfig& config : demanding_settings()) {
    for (const std::filesystem::path& root : {std::filesystem::path("/"), bare.path()}) {
      CheckupOptions options;
      options.configured = true;
      options.timer_run = std::chrono::milliseconds(20);
      for (const HostCheck& check : check_host(config, HostFiles(root), options)) {
        if (check.verdict == Verdict::ok) continue;
        ++judged;
        EXPECT_FALSE(check.cure.empty()) << root << ": " << to_text(check.verdict) << " " << check.topic << ": "
                                         << check.found;
      }
    }
  }
  EXPECT_GT(judged, 10);
}

}  // namespace
}  // namespace pelorus
