// Exports of a hand-made run; MCAP is judged by a foreign reader in mcap_reader/.
#include <gtest/gtest.h>

#include <cmath>

#include "firmware-host/pelorus/export/mcap_export.h"
#include "firmware-host/pelorus/export/partial_file.h"
#include "firmware-host/pelorus/export/trajectory_text.h"
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
