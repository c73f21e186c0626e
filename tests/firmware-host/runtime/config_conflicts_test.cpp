// Rules between settings, as the loader tells them.
#include <gtest/gtest.h>

#include <string>

#include "firmware-host/runtime/config_fields.h"
#include "tests/firmware-host/runtime/config_file.h"

namespace pelorus {
namespace {

using ConfigConflicts = test::ConfigFile;

TEST_F(ConfigConflicts, LiveCamerasNeedADeviceACalibrationAndATolerance) {
  EXPECT_NE(problems_of("source:\n  kind: aravis\n  calibration: c\n").find("camera.left"), std::string::npos);
  const std::string camera = "camera:\n  left: 10.0.0.1\n  right: 10.0.0.2\n";
  EXPECT_NE(problems_of("source:\n  kind: aravis\n" + camera).find("source.calibration"), std::string::npos);
  const std::string source = "source:\n  kind: aravis\n  calibration: c\n";
  EXPECT_EQ(problems_of(source + camera), "none");
  EXPECT_NE(problems_of(source + camera + "  tolerance_ms: 25\n").find("half the period"), std::string::npos);
}

TEST_F(ConfigConflicts, SettingsThatContradictEachOtherAreRefused) {
  const std::string message = problems_of("stereo:\n  min_disparity_px: 50\n  max_disparity_px: 20\n");
  EXPECT_NE(message.find("must be below max_disparity_px"), std::string::npos) << message;
  EXPECT_NE(problems_of("surf:\n  sampling_step_px: 3\n"), "none");
  EXPECT_NE(problems_of("ego_motion:\n  start_sigma_px: 9\n"), "none");
  EXPECT_NE(problems_of("ego_motion:\n  min_static_points: 900\n"), "none");
  EXPECT_TRUE(config_conflicts(config_).empty()) << "nothing was applied, and the defaults agree";
}

TEST_F(ConfigConflicts, ContradictionsHaveTheLineOfTheirKeyAndStandWithAllOtherProblems) {
  const std::string message = problems_of(
      "stereo:\n  max_disparity_px: 20\n  min_disparity_px: 50\nego_motion:\n  min_static_points: 900\n"
      "  start_sigma: 1\nsource:\n  kind: aravis\n");
  EXPECT_NE(message.find("6 problems"), std::string::npos) << message;
  for (const std::string& part :
       {line(3) + " stereo.min_disparity_px must be below", line(5) + " ego_motion.min_static_points must not",
        line(6) + " unknown key", line(8) + " source.calibration must name", line(8) + " camera.left is not given",
        line(8) + " camera.right is not given"}) {
    EXPECT_NE(message.find(part), std::string::npos) << part << "\n" << message;
  }
}

TEST_F(ConfigConflicts, AValueThatCannotBeReadContradictsNothing) {
  const std::string message = problems_of("ego_motion:\n  min_static_points: 900\n  degraded_static_points: many\n");
  EXPECT_NE(message.find(line(3)), std::string::npos) << message;
  EXPECT_EQ(message.find("must not be above"), std::string::npos) << message;
}

TEST_F(ConfigConflicts, AnAddressThatIsNoneOfLcmIsAProblemWhereLcmIsUsed) {
  EXPECT_NE(problems_of("lcm:\n  url: nonsense\n").find(line(2) + " lcm.url is no address"), std::string::npos);
  EXPECT_EQ(problems_of("lcm:\n  url: nonsense\n  enabled: false\n"), "none");
  for (const char* url : {"udpm://239.255.76.67:7667?ttl=1", "udpm://", "memq://", "\"\""}) {
    EXPECT_EQ(problems_of("lcm:\n  url: " + std::string(url) + "\n"), "none") << url;
  }
}

// What keeps the service from starting keeps its configuration from being good, in the same words.
TEST_F(ConfigConflicts, CamerasThatCannotBeMadeAreAProblem) {
  const std::string source = "source:\n  calibration: c\n  kind: ";
  const std::string same = problems_of(source + "v4l2\ncamera:\n  left: /dev/video0\n  right: /dev/video0\n");
  EXPECT_NE(same.find(line(6) + " camera.right is the left camera again (name the other one)"), std::string::npos)
      << same;
  EXPECT_NE(problems_of(source + "aravis\ncamera:\n  left: 10.0.0.1\n").find("camera.right is not given"),
            std::string::npos);
  const std::string v4l2 = problems_of(source + "v4l2\ncamera:\n  left: a\n  trigger: Line1\n  gain_db: 3\n");
  EXPECT_NE(v4l2.find(line(6) + " camera.trigger cannot be set through V4L2"), std::string::npos) << v4l2;
  EXPECT_NE(v4l2.find(line(7) + " camera.gain_db cannot be set"), std::string::npos) << v4l2;
}

}  // namespace
}  // namespace pelorus
