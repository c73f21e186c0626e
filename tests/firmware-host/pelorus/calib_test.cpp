#include "firmware-host/pelorus/calib.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <string>
#include <vector>

#include "firmware-host/runtime/replay_source.h"
#include "tests/drivers/replay/recording_fixture.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

class Calib : public RecordingFixture {
 protected:
  // As main does: parse, then run. Usage errors of the parser count as 2.
  static int run(std::vector<std::string> arguments) {
    CLI::App app{"test"};
    const Verb verb = add_calib(app);
    std::reverse(arguments.begin(), arguments.end());
    try {
      app.parse(arguments);
    } catch (const CLI::ParseError&) {
      return 2;
    }
    const auto outcome = verb.run();
    return outcome.ok() ? outcome.value() : exit_code(outcome.error().code);
  }
};

TEST_F(Calib, ChecksADataSetAndDrawsItsRows) {
  const fs::path root = euroc();
  const fs::path picture = folder_ / "rows.png";
  testing::internal::CaptureStdout();
  EXPECT_EQ(run({"calib", "check", root.string(), "--out", picture.string()}), 0);
  const std::string text = testing::internal::GetCapturedStdout();
  for (const char* word : {"baseline 0.11000 m", "view", "assumed", "64x48", "radtan", "rows"})
    EXPECT_NE(text.find(word), std::string::npos) << word << " in\n" << text;
  EXPECT_EQ(cv::imread(picture.string()).cols, 2 * kWidth);
}

TEST_F(Calib, ConvertsAndTheResultChecks) {
  const fs::path root = euroc();
  for (const char* format : {"opencv", "kalibr", "ros", "euroc"}) {
    const fs::path out = folder_ / (std::string(format) + ".yaml");
    EXPECT_EQ(run({"calib", "convert", root.string(), "--to", format, "--out", out.string()}), 0) << format;
    EXPECT_EQ(run({"calib", "check", root.string(), "--calib", out.string()}), 0) << format;
    EXPECT_EQ(run({"calib", "check", out.string(), "--image-left", (root / "mav0/cam0/data" / png(0)).string(),
                   "--image-right", (root / "mav0/cam1/data" / png(0)).string()}),
              0)
        << format;
    auto source = open_source(root.string(), out.string());
    ASSERT_TRUE(source.ok()) << source.error().message();
    EXPECT_NEAR(source.value()->calibration().T_right_left.translation().x(), -0.11, 1e-12) << format;
  }
}

TEST_F(Calib, ConvertReplacesNothingUnlessToldTo) {
  const fs::path root = euroc();
  for (const char* format : {"opencv", "ros"}) {
    const fs::path out = folder_ / (std::string(format) + ".out");
    const fs::path file = format == std::string("ros") ? out / "right.yaml" : out;
    write(file, "mine");
    const std::vector<std::string> convert{"calib", "convert", root.string(), "--to", format, "--out", out.string()};
    EXPECT_EQ(run(convert), 6) << format;
    EXPECT_EQ(test::read_text(file), "mine") << format;
    EXPECT_FALSE(fs::exists(out / "left.yaml")) << "one half of it";
    std::vector<std::string> overwriting = convert;
    overwriting.push_back("--overwrite");
    EXPECT_EQ(run(overwriting), 0) << format;
    EXPECT_EQ(run({"calib", "check", root.string(), "--calib", out.string()}), 0) << format;
  }
}

// Files that may not grow stand for a full disk.
TEST_F(Calib, AFullDiskLeavesNoFileUnderTheFinalName) {
  const fs::path root = euroc();
  fs::create_directory(folder_ / "full");
  const auto former = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  getrlimit(RLIMIT_FSIZE, &limit);
  const rlimit none{0, limit.rlim_max};
  setrlimit(RLIMIT_FSIZE, &none);
  std::vector<int> codes;
  for (const char* format : {"opencv", "euroc"}) {
    codes.push_back(
        run({"calib", "convert", root.string(), "--to", format, "--out", (folder_ / "full" / format).string()}));
  }
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, former);
  EXPECT_EQ(codes, (std::vector<int>{6, 6}));
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "full")) {
    EXPECT_TRUE(entry.is_directory()) << entry.path();
  }
}

TEST_F(Calib, TheImagesTellTheSizeThatTheCalibrationLacks) {
  const fs::path root = kitti_odometry();
  const fs::path out = folder_ / "camchain.yaml";
  EXPECT_EQ(run({"calib", "convert", (root / "calib.txt").string(), "--to", "kalibr", "--out", out.string()}), 4);
  EXPECT_EQ(run({"calib", "convert", root.string(), "--to", "kalibr", "--out", out.string()}), 0);
  EXPECT_NE(test::read_text(out).find("[64, 48]"), std::string::npos) << test::read_text(out);
}

TEST_F(Calib, AnUnknownFormatIsToldWithTheKnownOnes) {
  CLI::App app{"test"};
  const Verb verb = add_calib(app);
  std::vector<std::string> arguments{"x", "--out", "foo", "--to", "x", "convert", "calib"};
  try {
    app.parse(arguments);
    FAIL() << "foo is a format";
  } catch (const CLI::ParseError& e) {
    EXPECT_STREQ(e.what(), "--to: 'foo' is unknown (give one of: euroc, kalibr, opencv, ros)");
  }
}

TEST_F(Calib, ExitCodesTellWhatWasWrong) {
  const fs::path root = euroc();
  EXPECT_EQ(run({"calib"}), 2);
  EXPECT_EQ(run({"calib", "convert", root.string(), "--to", "matlab", "--out", "x"}), 2);
  EXPECT_EQ(run({"calib", "check", (folder_ / "absent").string()}), 6);
  EXPECT_EQ(run({"calib", "check", root.string(), "--pair", "99"}), 2);
  const fs::path sensor = root / "mav0/cam1/sensor.yaml";
  EXPECT_EQ(run({"calib", "check", (root / "mav0").string(), "--out", "/proc/none/rows.png"}), 6);
  write(sensor, sensor_yaml(T_BS_at(-0.11)));
  EXPECT_EQ(run({"calib", "check", root.string()}), 4);
  write_image(folder_ / "small.png", 3, 32, 32);
  EXPECT_EQ(run({"calib", "check", kitti_odometry().string(), "--image-left", (folder_ / "small.png").string(),
                 "--image-right", (folder_ / "none.png").string()}),
            3);
}

}  // namespace
}  // namespace pelorus
