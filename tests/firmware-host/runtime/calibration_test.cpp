#include "firmware-host/runtime/calibration.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <string>

#include "core/geometry/rectifier.h"
#include "firmware-host/runtime/calibration_writer.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

namespace fs = std::filesystem;

StereoCalibration sample(LensKind lens = LensKind::radtan) {
  StereoCalibration c;
  c.left = {752, 480, 458.654, 457.296, 367.215, 248.375, lens, {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05}};
  c.right = {752, 480, 457.587, 456.134, 379.999, 255.238, lens, {-0.28368365, 0.07451284, -0.00010473, -3.559e-05}};
  if (lens == LensKind::rational) c.left.distortion[5] = c.right.distortion[5] = 0.125;
  if (lens == LensKind::equidistant) c.left.distortion = c.right.distortion = {-0.013, 0.02, -0.012, 0.0023};
  c.T_right_left.linear() = so3_exp({0.0071, -0.0141, 0.0023});
  c.T_right_left.translation() = Eigen::Vector3d(-0.11007, 0.00040, -0.00085);
  c.T_body_left = se3_exp((Vector6d() << -0.02, -0.06, 0.01, 0.1, -0.2, 1.5).finished());
  c.body_known = true;
  return c;
}

class Calibration : public testing::Test {
 protected:
  StereoCalibration load(const fs::path& path) {
    auto loaded = load_calibration(path.string());
    EXPECT_TRUE(loaded.ok()) << (loaded.ok() ? "" : loaded.error().message());
    if (!loaded.ok()) return {};
    EXPECT_FALSE(loaded.value().assumptions.empty());
    EXPECT_FALSE(loaded.value().origin.empty());
    return loaded.value().calibration;
  }

  void expect_error(const fs::path& path, const std::string& place, const std::string& detail) {
    const auto loaded = load_calibration(path.string());
    ASSERT_FALSE(loaded.ok()) << "no error where '" << detail << "' was expected";
    EXPECT_NE(loaded.error().place.find(place), std::string::npos) << loaded.error().message();
    EXPECT_NE(loaded.error().detail.find(detail), std::string::npos) << loaded.error().message();
    EXPECT_FALSE(loaded.error().cure.empty()) << loaded.error().message();
    EXPECT_NE(exit_code(loaded.error().code), 0);
  }

  fs::path write(const std::string& name, const std::string& content) {
    test::write_text(folder_.path() / name, content);
    return folder_.path() / name;
  }

  test::TemporaryFolder folder_;
};

void expect_same(const CameraIntrinsics& a, const CameraIntrinsics& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_DOUBLE_EQ(a.fx_px, b.fx_px);
  EXPECT_DOUBLE_EQ(a.fy_px, b.fy_px);
  EXPECT_DOUBLE_EQ(a.cx_px, b.cx_px);
  EXPECT_DOUBLE_EQ(a.cy_px, b.cy_px);
  EXPECT_EQ(a.lens, b.lens);
  EXPECT_EQ(a.distortion, b.distortion);
}

void expect_same(const StereoCalibration& a, const StereoCalibration& b) {
  expect_same(a.left, b.left);
  expect_same(a.right, b.right);
  EXPECT_TRUE(a.T_right_left.isApprox(b.T_right_left, 1e-12)) << a.T_right_left.matrix() << "\n"
                                                              << b.T_right_left.matrix();
}

struct FormatCase {
  CalibrationFormat format;
  LensKind lens;
  const char* path;
  bool keeps_body;
};

class RoundTrip : public testing::TestWithParam<FormatCase> {};

TEST_P(RoundTrip, ReadsBackWhatWasWritten) {
  const FormatCase& round = GetParam();
  const test::TemporaryFolder folder;
  const fs::path out = folder.path() / round.path;
  const StereoCalibration c = sample(round.lens);
  const auto written = write_calibration(c, round.format, out);
  ASSERT_TRUE(written.ok()) << written.error().message();
  const auto loaded = load_calibration(out.string());
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  expect_same(c, loaded.value().calibration);
  EXPECT_EQ(loaded.value().calibration.body_known, round.keeps_body);
  if (!round.keeps_body) return;
  EXPECT_TRUE(loaded.value().calibration.T_body_left.isApprox(c.T_body_left, 1e-12));
}

INSTANTIATE_TEST_SUITE_P(
    Calibration, RoundTrip,
    testing::Values(FormatCase{CalibrationFormat::opencv, LensKind::radtan, "stereo.yaml", false},
                    FormatCase{CalibrationFormat::opencv, LensKind::rational, "stereo.yml", false},
                    FormatCase{CalibrationFormat::opencv, LensKind::equidistant, "stereo.yaml", false},
                    FormatCase{CalibrationFormat::kalibr, LensKind::radtan, "camchain.yaml", true},
                    FormatCase{CalibrationFormat::kalibr, LensKind::equidistant, "camchain.yaml", true},
                    FormatCase{CalibrationFormat::ros, LensKind::radtan, "ros", false},
                    FormatCase{CalibrationFormat::ros, LensKind::rational, "ros", false},
                    FormatCase{CalibrationFormat::ros, LensKind::equidistant, "ros", false},
                    FormatCase{CalibrationFormat::euroc, LensKind::radtan, "euroc", true},
                    FormatCase{CalibrationFormat::euroc, LensKind::rational, "euroc", true}));

// Independent of our own writer: OpenCV writes, both of its formats.
TEST_F(Calibration, ReadsWhatOpenCvWrites) {
  const StereoCalibration c = sample();
  const auto K = [](const CameraIntrinsics& i) {
    return cv::Mat((cv::Mat_<double>(3, 3) << i.fx_px, 0, i.cx_px, 0, i.fy_px, i.cy_px, 0, 0, 1));
  };
  const auto D = [](const CameraIntrinsics& i) {
    return cv::Mat(1, 5, CV_64F, const_cast<double*>(i.distortion.data())).clone();
  };
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = c.T_right_left.linear();
  const Eigen::Vector3d t = c.T_right_left.translation();
  for (const char* name : {"stereo.yml", "stereo.xml"}) {
    const fs::path file = folder_.path() / name;
    cv::FileStorage out(file.string(), cv::FileStorage::WRITE);
    out << "cameraMatrixL" << K(c.left) << "distCoeffsL" << D(c.left) << "cameraMatrixR" << K(c.right) << "distCoeffsR"
        << D(c.right) << "R" << cv::Mat(3, 3, CV_64F, const_cast<double*>(rows.data())) << "T"
        << (cv::Mat_<double>(3, 1) << t.x(), t.y(), t.z()) << "imageSize" << cv::Size(752, 480);
    out.release();
    expect_same(c, load(file));
  }
}

TEST_F(Calibration, ReadsOpenCvIntrinsicsAndExtrinsicsOfTwoFiles) {
  write(
      "cal/intrinsics.yml",
      "%YAML:1.0\n---\nM1: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 450., 0., 370., 0., 451., "
      "240., 0., 0., 1. ]\nD1: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [ -0.3, 0.1, 0., 0., 0. ]\n"
      "M2: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 450., 0., 372., 0., 451., 240., 0., 0., 1. "
      "]\nD2: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [ -0.3, 0.1, 0., 0., 0. ]\n");
  write("cal/extrinsics.yml",
        "%YAML:1.0\n---\nR: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 1., 0., 0., 0., 1., 0., 0., "
        "0., 1. ]\nT: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ -1.2e-01, 0., 0. ]\n");
  const StereoCalibration c = load(folder_.path() / "cal");
  EXPECT_EQ(c.left.width, 0);  // not in these files
  EXPECT_EQ(c.right.cx_px, 372.0);
  EXPECT_EQ(c.left.distortion[0], -0.3);
  EXPECT_EQ(c.T_right_left.translation().x(), -0.12);
}

const std::string kKalibrRight =
    "cam1:\n  camera_model: pinhole\n  distortion_coeffs: [-0.28, 0.07, 0.0, 0.0]\n  distortion_model: radtan\n"
    "  intrinsics: [457.5, 456.1, 379.9, 255.2]\n  resolution: [752, 480]\n";
const std::string kKalibrLeft =
    "cam0:\n  camera_model: pinhole\n  distortion_coeffs: [-0.28, 0.07, 0.0, 0.0]\n  distortion_model: radtan\n"
    "  intrinsics: [458.6, 457.2, 367.2, 248.3]\n  resolution: [752, 480]\n";

std::string kalibr_extrinsics(const std::string& x) {
  return "  T_cn_cnm1:\n  - [1.0, 0.0, 0.0, " + x +
         "]\n  - [0.0, 1.0, 0.0, 0.0]\n  - [0.0, 0.0, 1.0, 0.0]\n"
         "  - [0.0, 0.0, 0.0, 1.0]\n";
}

TEST_F(Calibration, ReadsKalibrInItsDirection) {
  const StereoCalibration c = load(write("camchain.yaml", kKalibrLeft + kKalibrRight + kalibr_extrinsics("-0.11")));
  EXPECT_EQ(c.T_right_left.translation().x(), -0.11);
  EXPECT_FALSE(c.body_known);
  // The right camera stands on the right of the left one.
  EXPECT_GT((c.T_right_left.inverse().translation()).x(), 0);
}

TEST_F(Calibration, RefusesSwappedCamerasAndNoBaselineWithFileAndLine) {
  expect_error(write("swapped.yaml", kKalibrLeft + kKalibrRight + kalibr_extrinsics("0.11")), "swapped.yaml:14",
               "negative baseline");
  expect_error(write("same.yaml", kKalibrLeft + kKalibrRight + kalibr_extrinsics("0.0")), "same.yaml:14",
               "no baseline");
  expect_error(write("mm.yaml", kKalibrLeft + kKalibrRight + kalibr_extrinsics("-110")), "mm.yaml:14", "absurd");
  expect_error(write("none.yaml", kKalibrLeft + kKalibrRight), "none.yaml", "'T_cn_cnm1' is missing");
  expect_error(write("alone.yaml", kKalibrLeft), "alone.yaml", "no cam1");
}

TEST_F(Calibration, RefusesUnknownModelsAndWrongSizesWithFileAndLine) {
  std::string text = kKalibrLeft + kKalibrRight + kalibr_extrinsics("-0.11");
  std::string other = text;
  other.replace(other.find("pinhole"), 7, "omni");
  expect_error(write("omni.yaml", other), "omni.yaml:2", "unknown camera model 'omni'");
  other = text;
  other.replace(other.find("radtan"), 6, "fov");
  expect_error(write("fov.yaml", other), "fov.yaml:4", "unknown lens model 'fov'");
  other = text;
  other.replace(other.find("458.6, "), 7, "");
  expect_error(write("three.yaml", other), "three.yaml:5", "has 3 numbers instead of 4");
  other = text;
  other.replace(other.find("458.6"), 5, "0.002");
  expect_error(write("focal.yaml", other), "focal.yaml", "left camera: focal length 0.002 px is absurd");
  other = text;
  other.replace(other.find("[752, 480]"), 10, "[640, 480]");
  expect_error(write("sizes.yaml", other), "sizes.yaml", "image sizes differ: 640x480 and 752x480");
  other = text;
  other.replace(other.find("[0.0, 1.0, 0.0, 0.0]"), 20, "[0.0, 2.0, 0.0, 0.0]");
  expect_error(write("scaled.yaml", other), "scaled.yaml:14", "not a rotation matrix");
}

TEST_F(Calibration, RefusesIncompleteOpenCvFiles) {
  expect_error(write("m1.yaml", "M1: [1, 2, 3]\nD1: [0]\n"), "m1.yaml:1", "has 3 numbers instead of 9");
  expect_error(write("d1.yaml", "M1: [450, 0, 370, 0, 450, 240, 0, 0, 1]\n"), "d1.yaml", "left distortion");
  expect_error(write("k.yaml", "M1: [450, 370, 0, 0, 450, 240, 0, 1, 1]\n"), "k.yaml:1", "is no camera matrix");
  expect_error(write("broken.xml", "<?xml version=\"1.0\"?>\n<opencv_storage>\n<M1"), "broken.xml",
               "not a valid OpenCV file");
  expect_error(write("other.yaml", "hello: world\n"), "other.yaml", "no stereo calibration of a known format");
  expect_error(folder_.path() / "absent.yaml", "absent.yaml", "does not exist");
}

TEST_F(Calibration, ARosCameraAloneAsksForTheOther) {
  const fs::path out = folder_.path() / "ros";
  ASSERT_TRUE(write_calibration(sample(), CalibrationFormat::ros, out).ok());
  expect_same(sample(), load(out / "left.yaml"));
  expect_same(sample(), load(out / "right.yaml"));
  expect_same(sample(), load(out.string() + "/left.yaml," + out.string() + "/right.yaml"));
  fs::remove(out / "right.yaml");
  expect_error(out / "left.yaml", "left.yaml", "the other one is not beside it");
}

TEST_F(Calibration, ReadsKittiFiles) {
  const StereoCalibration c =
      load(write("calib.txt", "P0: 60 0 31.5 0 0 60 23.5 0 0 0 1 0\nP1: 60 0 31.5 -30 0 60 23.5 0 0 0 1 0\n"));
  EXPECT_TRUE(c.rectified);
  EXPECT_EQ(c.T_right_left.translation().x(), -0.5);
}

TEST_F(Calibration, WhatAFormatCannotHoldIsAnErrorNotALoss) {
  EXPECT_FALSE(
      write_calibration(sample(LensKind::rational), CalibrationFormat::kalibr, folder_.path() / "a.yaml").ok());
  StereoCalibration c = sample();
  c.left.distortion[4] = 0.01;
  EXPECT_FALSE(write_calibration(c, CalibrationFormat::kalibr, folder_.path() / "b.yaml").ok());
  c.left.width = c.right.width = 0;
  EXPECT_FALSE(write_calibration(c, CalibrationFormat::euroc, folder_.path() / "c").ok());
  write("file", "x");
  EXPECT_FALSE(write_calibration(sample(), CalibrationFormat::ros, folder_.path() / "file").ok());
}

// The same rig whatever the file: rectification must not depend on the detour.
TEST_F(Calibration, ConversionKeepsTheEffectiveRig) {
  const auto direct = Rectifier::create(sample(), "direct");
  ASSERT_TRUE(write_calibration(sample(), CalibrationFormat::ros, folder_.path() / "r").ok());
  const auto detour = Rectifier::create(load(folder_.path() / "r"), "detour");
  EXPECT_NEAR(direct.value().rig().f_px, detour.value().rig().f_px, 1e-9);
  EXPECT_NEAR(direct.value().rig().baseline_m, detour.value().rig().baseline_m, 1e-12);
}

}  // namespace
}  // namespace pelorus
