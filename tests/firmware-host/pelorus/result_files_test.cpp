#include "firmware-host/pelorus/results/result_files.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

using test::read_text;
using test::TemporaryFolder;

FrameResult result_with_object() {
  FrameResult result;
  result.seq = 7;
  result.capture_time = Timestamp{1403715273262142976};
  result.state = VisionState::tracking;
  result.pose_valid = true;
  result.T_world_cam.translation() = Eigen::Vector3d(1.0 / 3.0, 0, 0);
  result.objects_size = 1;
  result.objects[0].id = BodyId{3};
  result.objects[0].phase = ObjectPhase::confirmed;
  return result;
}

long count_lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

long commas_in_line(const std::string& text, int line) {
  std::istringstream stream(text);
  std::string content;
  for (int i = 0; i <= line; ++i) std::getline(stream, content);
  return std::count(content.begin(), content.end(), ',');
}

ResultWriter writer_in(const TemporaryFolder& folder) {
  Result<ResultWriter> writer = ResultWriter::create(folder.path());
  EXPECT_TRUE(writer.ok());
  return std::move(writer.value());
}

TEST(ResultWriter, EveryRowHasTheColumnsOfItsHeader) {
  const TemporaryFolder folder;
  ResultWriter writer = writer_in(folder);
  ASSERT_TRUE(writer.append(result_with_object(), {}).ok());
  for (const char* name : {"objects.csv", "frames.csv", "timing.csv"}) {
    const std::string text = read_text(folder.path() / name);
    EXPECT_EQ(count_lines(text), 2) << name;
    EXPECT_EQ(commas_in_line(text, 0), commas_in_line(text, 1)) << name;
  }
}

TEST(ResultWriter, ObjectColumnsStartAsTheInterfaceSays) {
  const TemporaryFolder folder;
  ResultWriter writer = writer_in(folder);
  const std::string promised =
      "timestamp_ns,object_id,state,p_x,p_y,p_z,q_w,q_x,q_y,q_z,m_x,m_y,m_z,mq_w,mq_x,mq_y,mq_z,points,sigma_t_m,"
      "sigma_r_rad,";
  EXPECT_EQ(read_text(folder.path() / "objects.csv").rfind(promised, 0), 0U);
}

TEST(ResultWriter, CameraFileKeepsNanosecondsAndTwelveDigits) {
  const TemporaryFolder folder;
  ResultWriter writer = writer_in(folder);
  ASSERT_TRUE(writer.append(result_with_object(), {}).ok());
  EXPECT_EQ(read_text(folder.path() / "camera.tum"), "1403715273.262142976 0.333333333333 0 0 0 0 0 1\n");
}

TEST(ResultWriter, FrameWithoutPoseIsAbsentFromTheCameraFileAndPresentInTheFrames) {
  const TemporaryFolder folder;
  ResultWriter writer = writer_in(folder);
  FrameResult lost = result_with_object();
  lost.pose_valid = false;
  lost.state = VisionState::lost;
  ASSERT_TRUE(writer.append(lost, {}).ok());
  EXPECT_EQ(read_text(folder.path() / "camera.tum"), "");
  EXPECT_EQ(count_lines(read_text(folder.path() / "frames.csv")), 2);
}

TEST(ResultWriter, WallTimesChangeTimingOnly) {
  const TemporaryFolder fast;
  const TemporaryFolder slow;
  ResultWriter fast_writer = writer_in(fast);
  ResultWriter slow_writer = writer_in(slow);
  FrameResult result = result_with_object();
  ASSERT_TRUE(fast_writer.append(result, {1, 2, 3}).ok());
  result.report.step_microseconds = 99;
  for (StageReport& stage : result.report.stages) stage.microseconds = 77;
  ASSERT_TRUE(slow_writer.append(result, {4, 5, 6}).ok());
  for (const char* name : {"camera.tum", "objects.csv", "frames.csv"}) {
    EXPECT_EQ(read_text(fast.path() / name), read_text(slow.path() / name)) << name;
  }
  EXPECT_NE(read_text(fast.path() / "timing.csv"), read_text(slow.path() / "timing.csv"));
}

TEST(ResultWriter, FullDeviceIsAnErrorThatNamesTheFile) {
  const TemporaryFolder folder;
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  std::filesystem::create_symlink("/dev/full", folder.path() / "objects.csv");
  const Result<ResultWriter> writer = ResultWriter::create(folder.path());
  ASSERT_FALSE(writer.ok());
  EXPECT_EQ(writer.error().code, ErrorCode::io);
  EXPECT_NE(writer.error().message().find("objects.csv"), std::string::npos);
}

TEST(ResultWriter, MotionCovarianceAtTheCentroidForgetsTheLeverArm) {
  ObjectState object;
  object.centroid_world = Eigen::Vector3d(1000, 0, 0);
  // Rotation noise about an axis through the centroid, seen from the world's origin: large translation terms.
  const Vector6d sigma = (Vector6d() << 0.01, 0.01, 0.01, 0.001, 0.001, 0.001).finished();
  Rigid3 T_world_centroid = Rigid3::Identity();
  T_world_centroid.translation() = object.centroid_world;
  const Matrix6d Ad = adjoint(T_world_centroid);
  const Matrix6d at_centroid = sigma.cwiseAbs2().asDiagonal();
  object.cov_M_world = Ad * at_centroid * Ad.transpose();
  EXPECT_GT(object.cov_M_world(1, 1), 0.5);
  EXPECT_LT((motion_covariance_at_centroid(object) - at_centroid).norm(), 1e-9);
}

TEST(PrepareOutputFolder, RefusesAFolderWithContentAndOverwriteRemovesAnEarlierRunOnly) {
  const TemporaryFolder folder;
  test::write_text(folder.path() / "camera.tum", "old");
  test::write_text(folder.path() / "notes.txt", "mine");
  const Result<Ok> refused = prepare_output_folder(folder.path(), false);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message().find("--overwrite"), std::string::npos);
  EXPECT_EQ(read_text(folder.path() / "camera.tum"), "old");
  ASSERT_TRUE(prepare_output_folder(folder.path(), true).ok());
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "camera.tum"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "notes.txt"));
}

TEST(PrepareOutputFolder, RefusesAFileInItsPlace) {
  const TemporaryFolder folder;
  test::write_text(folder.path() / "file", "x");
  const Result<Ok> refused = prepare_output_folder(folder.path() / "file", true);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().detail.find("is a file"), std::string::npos);
  EXPECT_FALSE(prepare_output_folder(folder.path() / "file" / "below", true).ok());
}

}  // namespace
}  // namespace pelorus
