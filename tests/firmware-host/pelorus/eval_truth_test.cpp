#include "firmware-host/pelorus/eval/eval_truth.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "firmware-host/pelorus/eval/eval_truth_layouts.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

using test::TemporaryFolder;
using test::write_text;

constexpr std::int64_t kStart_ns = 1'600'000'000'000'000'000;
constexpr std::int64_t kInterval_ns = 100'000'000;

EstimatedRun run_of(std::size_t frames, std::int64_t start_ns = kStart_ns) {
  EstimatedRun run(frames);
  for (std::size_t i = 0; i < frames; ++i) {
    run[i].capture_time = Timestamp{start_ns + static_cast<std::int64_t>(i) * kInterval_ns};
  }
  return run;
}

std::string stamp(std::size_t frame) {
  return std::to_string(kStart_ns + static_cast<std::int64_t>(frame) * kInterval_ns);
}

constexpr const char* kGroundTruth = "state_groundtruth_estimate0/data.csv";

TEST(EurocTruth, BodyPoseIsCarriedToTheCamera) {
  const TemporaryFolder folder;
  // The body turned by 90 degrees about z; the camera sits 0.1 m ahead along the body's x.
  write_text(folder.path() / kGroundTruth, "#time, p, q\n" + stamp(0) + ",1,2,3,0.70710678118,0,0,0.70710678118\n");
  Rigid3 T_body_cam = Rigid3::Identity();
  T_body_cam.translation() = Eigen::Vector3d(0.1, 0, 0);
  const auto truth = read_euroc_truth(folder.path(), T_body_cam, run_of(1));
  ASSERT_TRUE(truth.ok() && truth.value());
  EXPECT_LT((truth.value()->frames[0].T_truth_cam->translation() - Eigen::Vector3d(1, 2.1, 3)).norm(), 1e-9);
  EXPECT_FALSE(truth.value()->exact);
  EXPECT_FALSE(truth.value()->knows_bodies);
}

TEST(EurocTruth, PoseBetweenTwoSamplesIsInterpolatedAndAHoleIsNot) {
  const TemporaryFolder folder;
  const auto row = [](std::int64_t ns, const char* x) {
    return std::to_string(kStart_ns + ns) + "," + x + ",0,0,1,0,0,0\n";
  };
  write_text(folder.path() / kGroundTruth,
             row(-10'000'000, "1") + row(10'000'000, "3") + row(50'000'000, "3") + row(400'000'000, "9"));
  const auto truth = read_euroc_truth(folder.path(), Rigid3::Identity(), run_of(2));
  ASSERT_TRUE(truth.ok() && truth.value());
  EXPECT_NEAR(truth.value()->frames[0].T_truth_cam->translation().x(), 2.0, 1e-9);
  EXPECT_FALSE(truth.value()->frames[1].T_truth_cam) << "350 ms without a sample";
}

TEST(EurocTruth, BodyThatRestsForAStepIsNotMoving) {
  const TemporaryFolder folder;
  std::string camera;
  std::string object;
  const double x_m[] = {0, 0.02, 0.04, 0.04};
  for (std::size_t i = 0; i < 4; ++i) {
    camera += stamp(i) + "," + std::to_string(0.1 * static_cast<double>(i)) + ",0,0,1,0,0,0\n";
    object += stamp(i) + "," + std::to_string(x_m[i]) + ",0,4,1,0,0,0," + std::to_string(100 * i) + "\n";
  }
  write_text(folder.path() / kGroundTruth, camera);
  write_text(folder.path() / "object1/data.csv", object);
  const auto truth = read_euroc_truth(folder.path(), Rigid3::Identity(), run_of(4));
  ASSERT_TRUE(truth.ok() && truth.value());
  ASSERT_TRUE(truth.value()->knows_bodies);
  const auto view = [&](std::size_t frame) { return truth.value()->frames[frame].find(0); };
  EXPECT_TRUE(view(0)->moving && view(1)->moving && view(2)->moving);
  EXPECT_FALSE(view(3)->moving);
  EXPECT_EQ(view(3)->visible_px, 300);
  EXPECT_NEAR(view(2)->T_cam_body.translation().x(), 0.04 - 0.2, 1e-9);
  EXPECT_EQ(truth.value()->bodies[0], "object1") << "no body.csv";
  EXPECT_FALSE(view(2)->half_size_m);
}

TEST(EurocTruth, BodyFileGivesNameAndBox) {
  const TemporaryFolder folder;
  write_text(folder.path() / kGroundTruth, stamp(0) + ",0,0,0,1,0,0,0\n");
  write_text(folder.path() / "object1/data.csv", stamp(0) + ",0,0,4,1,0,0,0,500\n");
  write_text(folder.path() / "object1/body.csv", "#name, size_x [m], size_y [m], size_z [m]\ncrate,0.8,0.5,0.4\n");
  const auto truth = read_euroc_truth(folder.path(), Rigid3::Identity(), run_of(1));
  ASSERT_TRUE(truth.ok() && truth.value()) << (truth.ok() ? "" : truth.error().message());
  EXPECT_EQ(truth.value()->bodies[0], "crate");
  EXPECT_TRUE(truth.value()->frames[0].find(0)->half_size_m->isApprox(Eigen::Vector3d(0.4, 0.25, 0.2)));
  write_text(folder.path() / "object1/body.csv", "crate,0.8,wide,0.4\n");
  EXPECT_FALSE(read_euroc_truth(folder.path(), Rigid3::Identity(), run_of(1)).ok());
}

TEST(EurocTruth, RowCutOffNamesFileAndLine) {
  const TemporaryFolder folder;
  write_text(folder.path() / kGroundTruth, stamp(0) + ",1,2,3,1,0,0,0\n" + stamp(1) + ",1,2\n");
  const auto truth = read_euroc_truth(folder.path(), Rigid3::Identity(), run_of(1));
  ASSERT_FALSE(truth.ok());
  EXPECT_NE(truth.error().place.find("data.csv:2"), std::string::npos) << truth.error().message();
}

TEST(EurocTruth, AbsentFileIsNoTruthRatherThanAnError) {
  const TemporaryFolder folder;
  const auto truth = read_euroc_truth(folder.path(), Rigid3::Identity(), run_of(1));
  ASSERT_TRUE(truth.ok());
  EXPECT_FALSE(truth.value());
}

// A KITTI raw drive of 30 frames at 10 Hz from 2011-09-26 13:04:32 UTC, the camera at rest at the origin.
class KittiRawTruth : public testing::Test {
 protected:
  static constexpr std::int64_t kRawStart_ns = 1'317'042'272'000'000'000;
  void SetUp() override {
    std::string times;
    std::string poses;
    const cv::Mat image(8, 8, CV_8U, cv::Scalar(0));
    for (int i = 0; i < 30; ++i) {
      std::array<char, 64> text{};
      std::snprintf(text.data(), text.size(), "2011-09-26 13:04:%02d.%d00000000\n", 32 + i / 10, i % 10);
      times += text.data();
      poses += "1 0 0 0 0 1 0 0 0 0 1 0\n";
      for (const char* side : {"image_00", "image_01"}) {
        std::snprintf(text.data(), text.size(), "%010d.png", i);
        std::filesystem::create_directories(folder_.path() / side / "data");
        ASSERT_TRUE(cv::imwrite((folder_.path() / side / "data" / text.data()).string(), image));
      }
    }
    for (const char* side : {"image_00", "image_01"}) write_text(folder_.path() / side / "timestamps.txt", times);
    write_text(folder_.path() / "poses_cam0_from_oxts.txt", poses);
  }
  void write_labels(double speed_m_per_s) {
    std::string labels = "0 -1 DontCare -1 -1 -10 219 188 245 218 -1000 -1000 -1000 -10 -1 -1 -1\n";
    for (int i = 0; i < 30; ++i) {
      labels += std::to_string(i) + " 7 Van 0 0 -1.8 300 160 400 260 2 1.8 4.4 " +
                std::to_string(-4 + speed_m_per_s * 0.1 * i) + " 1.8 13 0\n";
    }
    write_text(folder_.path() / "tracking_label_02.txt", labels);
  }
  Result<std::optional<Truth>> read() { return read_kitti_raw_truth(folder_.path(), run_of(30, kRawStart_ns)); }

  TemporaryFolder folder_;
};

TEST_F(KittiRawTruth, LabelsBecomeNamedBoxesAboutTheirCentre) {
  write_labels(4);
  const auto truth = read();
  ASSERT_TRUE(truth.ok() && truth.value()) << (truth.ok() ? "" : truth.error().message());
  ASSERT_EQ(truth.value()->bodies, std::vector<std::string>{"Van 7"});
  const TrueBodyView* view = truth.value()->frames[0].find(0);
  ASSERT_NE(view, nullptr);
  EXPECT_LT((view->T_cam_body.translation() - Eigen::Vector3d(-4, 0.8, 13)).norm(), 1e-9);
  EXPECT_TRUE(view->half_size_m->isApprox(Eigen::Vector3d(2.2, 1.0, 0.9)));
  EXPECT_TRUE(view->moving);
  EXPECT_TRUE(truth.value()->frames[29].T_truth_cam);
}

TEST_F(KittiRawTruth, ParkedCarIsNotMoving) {
  write_labels(0.1);
  const auto truth = read();
  ASSERT_TRUE(truth.ok() && truth.value());
  EXPECT_FALSE(truth.value()->frames[10].find(0)->moving);
}

TEST_F(KittiRawTruth, DamagedLabelNamesFileAndLine) {
  write_text(folder_.path() / "tracking_label_02.txt", "0 7 Van 0 0 -1.8 300 160 400 260 2 1.8 4.4 wide 1.8 13 0\n");
  const auto truth = read();
  ASSERT_FALSE(truth.ok());
  EXPECT_NE(truth.error().place.find("tracking_label_02.txt:1"), std::string::npos);
}

TEST_F(KittiRawTruth, WithoutLabelsNothingIsKnownOfBodies) {
  const auto truth = read();
  ASSERT_TRUE(truth.ok() && truth.value());
  EXPECT_FALSE(truth.value()->knows_bodies);
}

}  // namespace
}  // namespace pelorus
