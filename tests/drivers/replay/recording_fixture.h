#pragma once
// Small data sets of every layout, written to a folder that vanishes with the fixture.

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "drivers/replay/dataset.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {

inline std::unique_ptr<StereoSource> open(const std::filesystem::path& path) {
  auto source = open_dataset(path);
  EXPECT_TRUE(source.ok()) << (source.ok() ? "" : source.error().message());
  return source.ok() ? std::move(source.value()) : nullptr;
}

// An error must say where, what and the cure.
inline void expect_error(const std::filesystem::path& path, const std::string& place, const std::string& detail) {
  const auto source = open_dataset(path);
  ASSERT_FALSE(source.ok()) << "no error where " << detail << " was expected";
  const Error& e = source.error();
  EXPECT_NE(e.place.find(place), std::string::npos) << e.message();
  EXPECT_NE(e.detail.find(detail), std::string::npos) << e.message();
  EXPECT_FALSE(e.cure.empty()) << e.message();
}

inline std::vector<std::uint64_t> all_seqs(StereoSource& source) {
  std::vector<std::uint64_t> seqs;
  SourcePair pair;
  while (true) {
    const auto more = source.next(pair);
    EXPECT_TRUE(more.ok()) << (more.ok() ? "" : more.error().message());
    if (!more.ok() || !more.value()) return seqs;
    seqs.push_back(pair.seq);
  }
}

class RecordingFixture : public testing::Test {
 protected:
  static constexpr std::int64_t kStart_ns = 1'403'715'273'262'142'976;
  static constexpr std::int64_t kPeriod_ns = 50'000'000;
  static constexpr int kPairs = 8;
  static constexpr int kWidth = 64;
  static constexpr int kHeight = 48;

  static void write(const std::filesystem::path& file, const std::string& content) {
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << content;
  }

  static void write_image(const std::filesystem::path& file, int gray, int width = kWidth, int height = kHeight) {
    std::filesystem::create_directories(file.parent_path());
    cv::Mat image(height, width, CV_8U, cv::Scalar(gray));
    for (int v = 0; v < height; ++v)
      for (int u = 0; u < width; ++u)
        image.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(gray + (u * 7 + v * 13) % 50);
    cv::imwrite(file.string(), image);
  }

  static std::int64_t time_ns(int i) { return kStart_ns + i * kPeriod_ns; }
  static std::string png(int i) { return std::to_string(time_ns(i)) + ".png"; }

  static std::string sensor_yaml(const std::string& T_BS, const std::string& model = "radial-tangential") {
    return "%YAML:1.0\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [" + T_BS +
           "]\nrate_hz: 20\nresolution: [64, 48]\ncamera_model: pinhole\nintrinsics: [60.0, 60.0, 31.5, 23.5]\n"
           "distortion_model: " +
           model + "\ndistortion_coefficients: [-0.28, 0.07, 0.0, 0.0]\n";
  }
  static std::string T_BS_at(double x_m) {
    return "1, 0, 0, " + std::to_string(x_m) + ", 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1";
  }

  std::filesystem::path euroc() {
    const std::filesystem::path root = folder_ / "euroc";
    for (int k = 0; k < 2; ++k) {
      const std::filesystem::path camera = root / "mav0" / ("cam" + std::to_string(k));
      std::string csv = "#timestamp [ns],filename\r\n";
      for (int i = 0; i < kPairs; ++i) {
        csv += std::to_string(time_ns(i)) + "," + png(i) + "\r\n";
        write_image(camera / "data" / png(i), 20 * i + k);
      }
      write(camera / "data.csv", csv);
      write(camera / "sensor.yaml", sensor_yaml(T_BS_at(0.11 * k)));
    }
    return root;
  }

  std::filesystem::path kitti_odometry() {
    const std::filesystem::path root = folder_ / "odometry";
    std::string times;
    for (int i = 0; i < kPairs; ++i) {
      char name[16];
      std::snprintf(name, sizeof name, "%06d.png", i);
      write_image(root / "image_0" / name, 20 * i);
      write_image(root / "image_1" / name, 20 * i + 1);
      std::snprintf(name, sizeof name, "%e", 0.1 * i);
      times += std::string(name) + "\n";
    }
    write(root / "times.txt", times);
    write(root / "calib.txt", "P0: 60 0 31.5 0 0 60 23.5 0 0 0 1 0\nP1: 60 0 31.5 -30 0 60 23.5 0 0 0 1 0\n");
    return root;
  }

  std::filesystem::path kitti_raw() {
    const std::filesystem::path root = folder_ / "2011_09_26" / "drive";
    std::string times;
    for (int i = 0; i < kPairs; ++i) {
      char name[48];
      std::snprintf(name, sizeof name, "%010d.png", i);
      write_image(root / "image_00" / "data" / name, 20 * i);
      write_image(root / "image_01" / "data" / name, 20 * i + 1);
      std::snprintf(name, sizeof name, "2011-09-26 13:04:%02d.351950336", 32 + i);
      times += std::string(name) + "\n";
    }
    write(root / "image_00" / "timestamps.txt", times);
    write(root.parent_path() / "calib_cam_to_cam.txt",
          "calib_time: 09-Jan-2012 13:57:47\nS_rect_00: 6.4e+01 4.8e+01\n"
          "P_rect_00: 60 0 31.5 0 0 60 23.5 0 0 0 1 0\nP_rect_01: 60 0 31.5 -30 0 60 23.5 0 0 0 1 0\n");
    return root;
  }

  const test::TemporaryFolder temporary_;
  const std::filesystem::path folder_ = temporary_.path();
};

}  // namespace pelorus
