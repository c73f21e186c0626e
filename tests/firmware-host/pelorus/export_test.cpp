// Exports of a hand-made run; MCAP is judged by a foreign reader in mcap_reader/.
#include <gtest/gtest.h>

#include <cmath>

#include "firmware-host/pelorus/export/mcap_export.h"
#include "firmware-host/pelorus/export/ply_text.h"
#include "firmware-host/pelorus/export/trajectory_text.h"
#include "firmware-host/runtime/partial_file.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

using test::TemporaryFolder;

// Three frames, the second without a pose; the camera turned by 90 degrees about z; body 4 in the last two.
EstimatedRun small_run() {
  EstimatedRun run(3);
  for (std::size_t i = 0; i < run.size(); ++i) {
    run[i].seq = 10 + i;
    run[i].capture_time = Timestamp{1'700'000'000'000'000'007 + static_cast<std::int64_t>(i) * 50'000'000};
    run[i].state = i == 1 ? VisionState::lost : VisionState::tracking;
    if (i == 1) continue;
    Rigid3 T = Rigid3::Identity();
    T.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    T.translation() = Eigen::Vector3d(1, 2, 3 + static_cast<double>(i));
    run[i].T_world_cam = T;
  }
  for (std::size_t i = 1; i < run.size(); ++i) {
    EstimatedObject object;
    object.id = BodyId{4};
    object.phase = ObjectPhase::confirmed;
    object.T_world_obj.translation() = Eigen::Vector3d(0.5, -0.25, static_cast<double>(i));
    object.points = 33;
    run[i].objects.push_back(object);
  }
  return run;
}

TEST(Export, TumHasExactTimesAndLeavesOutFramesWithoutPose) {
  EXPECT_EQ(tum_text(poses_of(small_run(), std::nullopt)),
            "1700000000.000000007 1 2 3 0 0 0.707106781187 0.707106781187\n"
            "1700000000.100000007 1 2 5 0 0 0.707106781187 0.707106781187\n");
  EXPECT_EQ(tum_text(poses_of(small_run(), BodyId{4})),
            "1700000000.050000007 0.5 -0.25 1 0 0 0 1\n"
            "1700000000.100000007 0.5 -0.25 2 0 0 0 1\n");
  EXPECT_TRUE(poses_of(small_run(), BodyId{5}).empty());
}

TEST(Export, KittiHasThreeRowsOfTheMatrixAndTimesBesides) {
  const std::vector<TimedPose> poses = poses_of(small_run(), std::nullopt);
  EXPECT_EQ(kitti_text(poses), "0 -1 0 1 1 0 0 2 0 0 1 3\n0 -1 0 1 1 0 0 2 0 0 1 5\n");
  EXPECT_EQ(kitti_times_text(poses), "0.000000000\n0.100000000\n");
}

TEST(Export, PlyHasThePointsOfOneBodyInBinary) {
  const auto point = [](BodyId body, const Eigen::Vector3d& p_body, double spread_m, int views, int gray) {
    ScenePoint made;
    made.body = body;
    made.p_body = p_body;
    made.spread_m = spread_m;
    made.views = views;
    made.gray = gray;
    return made;
  };
  const std::vector<ScenePoint> points{point(BodyId{2}, {1.5, -2.0, 0.25}, 0.5, 9, 200),
                                       point(kWorldBody, {7, 8, 9}, 0.125, 3, 300),
                                       point(BodyId{2}, {0, 0, 4}, 0, 2, -4)};
  EXPECT_EQ(bodies_of(points), (std::vector<BodyId>{kWorldBody, BodyId{2}}));
  const std::string text = ply_text(points, BodyId{2});
  const std::string header =
      "ply\nformat binary_little_endian 1.0\ncomment frame: body 2, fixed at its birth; meters\nelement vertex 2\n"
      "property float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
      "property uchar blue\nproperty float spread_m\nproperty int views\nend_header\n";
  ASSERT_EQ(text.substr(0, header.size()), header);
  constexpr std::size_t kVertex = 12 + 3 + 4 + 4;
  ASSERT_EQ(text.size(), header.size() + 2 * kVertex);
  const std::string expected(
      "\x00\x00\xC0\x3F\x00\x00\x00\xC0\x00\x00\x80\x3E\xC8\xC8\xC8\x00\x00\x00\x3F\x09\x00\x00\x00", kVertex);
  EXPECT_EQ(text.substr(header.size(), kVertex), expected);
  EXPECT_EQ(text[header.size() + kVertex + 12], '\0') << "gray is held to its range";
  EXPECT_NE(ply_text(points, kWorldBody).find("element vertex 1\n"), std::string::npos);
}

TEST(Export, CsvHasARowForTheCameraAndForEachBody) {
  EXPECT_EQ(csv_text(small_run()),
            "timestamp_ns,seq,state,body,phase,p_x,p_y,p_z,q_w,q_x,q_y,q_z,points\n"
            "1700000000000000007,10,TRACKING,camera,,1,2,3,0.707106781187,0,0,0.707106781187,\n"
            "1700000000050000007,11,LOST,4,confirmed,0.5,-0.25,1,1,0,0,0,33\n"
            "1700000000100000007,12,TRACKING,camera,,1,2,5,0.707106781187,0,0,0.707106781187,\n"
            "1700000000100000007,12,TRACKING,4,confirmed,0.5,-0.25,2,1,0,0,0,33\n");
}

TEST(Export, AFileGetsItsNameOnlyWhenItIsWhole) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "file";
  {
    Result<PartialFile> file = PartialFile::create(path, false);
    ASSERT_TRUE(file.ok());
    file.value().write("half");
    EXPECT_FALSE(std::filesystem::exists(path));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));  // given up
  Result<PartialFile> file = PartialFile::create(path, false);
  ASSERT_TRUE(file.ok());
  file.value().write("whole");
  ASSERT_TRUE(file.value().finish().ok());
  EXPECT_EQ(test::read_text(path), "whole");
  EXPECT_FALSE(PartialFile::create(path, false).ok());
  EXPECT_TRUE(PartialFile::create(path, true).ok());
  EXPECT_EQ(test::read_text(path), "whole");  // until the new one is
  EXPECT_FALSE(PartialFile::create(folder.path() / "none" / "file", false).ok());
}

TEST(Export, AFullDeviceIsToldAndLeavesNothing) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "run.mcap";
  std::filesystem::create_symlink("/dev/full", path.string() + ".partial");
  const Result<> done = export_mcap(small_run(), path, false);
  ASSERT_FALSE(done.ok());
  EXPECT_NE(done.error().message().find("No space left"), std::string::npos) << done.error().message();
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Export, TheSameRunGivesTheSameMcapBytes) {
  const TemporaryFolder folder;
  ASSERT_TRUE(export_mcap(small_run(), folder.path() / "a.mcap", false).ok());
  ASSERT_TRUE(export_mcap(small_run(), folder.path() / "b.mcap", false).ok());
  const std::string a = test::read_text(folder.path() / "a.mcap");
  EXPECT_EQ(a, test::read_text(folder.path() / "b.mcap"));
  EXPECT_EQ(a.substr(0, 8), "\x89MCAP0\r\n");
  EXPECT_EQ(a.substr(a.size() - 8), "\x89MCAP0\r\n");
  EXPECT_NE(a.find("\"child_frame_id\":\"body_4\""), std::string::npos);
}

}  // namespace
}  // namespace pelorus
