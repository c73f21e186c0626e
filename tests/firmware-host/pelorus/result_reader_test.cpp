#include "firmware-host/pelorus/results/result_reader.h"

#include <gtest/gtest.h>

#include "firmware-host/pelorus/results/result_files.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

using test::read_text;
using test::TemporaryFolder;
using test::write_text;

FrameResult frame(std::uint64_t seq) {
  FrameResult result;
  result.seq = seq;
  result.capture_time = Timestamp{1403715273262142976 + static_cast<std::int64_t>(seq) * 50'000'000};
  result.state = VisionState::tracking;
  result.pose_valid = true;
  result.T_world_cam.translation() = Eigen::Vector3d(0.1, -0.2, 1.0 / 3.0) * static_cast<double>(seq);
  result.T_world_cam.linear() = so3_exp({0.1, 0.2, -0.3 * static_cast<double>(seq)});
  result.T_curr_prev.linear() = so3_exp({0, 0.01, 0});
  result.cov_T_curr_prev = Matrix6d::Identity() * 1e-6;
  result.cov_T_curr_prev(0, 4) = result.cov_T_curr_prev(4, 0) = 2e-7;
  return result;
}

void add_object(FrameResult& result) {
  ObjectState& object = result.objects[0];
  result.objects_size = 1;
  object.id = BodyId{4};
  object.phase = ObjectPhase::coasting;
  object.T_world_obj.translation() = Eigen::Vector3d(1, 2, 3);
  object.M_world.linear() = so3_exp({0, 0.02, 0});
  object.centroid_world = Eigen::Vector3d(1.1, 2.2, 3.3);
  object.extent_m = Eigen::Vector3d(0.3, 0.4, 0.5);
  object.cov_M_world = Matrix6d::Identity() * 1e-4;
  object.points = 17;
}

void write_run(const TemporaryFolder& folder) {
  Result<ResultWriter> writer = ResultWriter::create(folder.path());
  ASSERT_TRUE(writer.ok());
  for (std::uint64_t seq = 0; seq < 3; ++seq) {
    FrameResult result = frame(seq);
    if (seq == 1) result.pose_valid = false;
    if (seq == 1) result.state = VisionState::lost;
    if (seq == 2) add_object(result);
    ASSERT_TRUE(writer.value().append(result, {0, 0, 1000 * static_cast<std::int64_t>(seq + 1)}).ok());
  }
}

// Replaces the whole file.
void spoil(const TemporaryFolder& folder, const std::string& file, const std::string& from, const std::string& to) {
  std::string text = read_text(folder.path() / file);
  ASSERT_NE(text.find(from), std::string::npos) << from;
  text.replace(text.find(from), from.size(), to);
  write_text(folder.path() / file, text);
}

TEST(ReadRun, GivesBackWhatTheWriterWasGiven) {
  const TemporaryFolder folder;
  write_run(folder);
  const Result<EstimatedRun> run = read_run(folder.path());
  ASSERT_TRUE(run.ok()) << run.error().message();
  ASSERT_EQ(run.value().size(), 3U);
  const EstimatedFrame& last = run.value()[2];
  const FrameResult written = frame(2);
  EXPECT_EQ(last.capture_time, written.capture_time);
  EXPECT_TRUE(last.T_world_cam->isApprox(written.T_world_cam, 1e-10));
  EXPECT_TRUE(last.T_curr_prev->isApprox(written.T_curr_prev, 1e-10));
  EXPECT_TRUE(last.cov_T_curr_prev.isApprox(written.cov_T_curr_prev, 1e-10));
  EXPECT_FALSE(run.value()[1].T_world_cam);
  EXPECT_EQ(run.value()[1].state, VisionState::lost);
}

TEST(ReadRun, GivesBackObjectsOfTheirFrame) {
  const TemporaryFolder folder;
  write_run(folder);
  const Result<EstimatedRun> run = read_run(folder.path());
  ASSERT_TRUE(run.ok()) << run.error().message();
  EXPECT_TRUE(run.value()[0].objects.empty());
  ASSERT_EQ(run.value()[2].objects.size(), 1U);
  const EstimatedObject& object = run.value()[2].objects[0];
  FrameResult written = frame(2);
  add_object(written);
  EXPECT_EQ(object.id, written.objects[0].id);
  EXPECT_EQ(object.phase, ObjectPhase::coasting);
  EXPECT_EQ(object.points, 17);
  EXPECT_TRUE(object.M_world.isApprox(written.objects[0].M_world, 1e-10));
  EXPECT_TRUE(object.centroid_world.isApprox(written.objects[0].centroid_world, 1e-10));
  EXPECT_TRUE(object.extent_m.isApprox(written.objects[0].extent_m, 1e-10));
  EXPECT_TRUE(object.cov_M_centroid.isApprox(motion_covariance_at_centroid(written.objects[0]), 1e-8));
}

TEST(ReadRun, LineCutOffIsAnErrorWithItsNumber) {
  const TemporaryFolder folder;
  write_run(folder);
  std::string text = read_text(folder.path() / "frames.csv");
  write_text(folder.path() / "frames.csv", text.substr(0, text.size() - 40));
  const Result<EstimatedRun> run = read_run(folder.path());
  ASSERT_FALSE(run.ok());
  EXPECT_NE(run.error().place.find("frames.csv:4"), std::string::npos) << run.error().message();
  EXPECT_NE(run.error().cure.find("cut off"), std::string::npos);
}

TEST(ReadRun, WordInPlaceOfANumberIsAnErrorWithItsLine) {
  const TemporaryFolder folder;
  write_run(folder);
  spoil(folder, "objects.csv", ",17,", ",many,");
  const Result<EstimatedRun> run = read_run(folder.path());
  ASSERT_FALSE(run.ok());
  EXPECT_NE(run.error().place.find("objects.csv:2"), std::string::npos) << run.error().message();
  EXPECT_NE(run.error().detail.find("many"), std::string::npos);
}

TEST(ReadRun, NotANumberIsNotANumber) {
  const TemporaryFolder folder;
  write_run(folder);
  spoil(folder, "camera.tum", "0.2", "nan");
  EXPECT_FALSE(read_run(folder.path()).ok());
}

TEST(ReadRun, QuaternionWithoutUnitLengthIsAnError) {
  const TemporaryFolder folder;
  write_text(folder.path() / "camera.tum", "1.000000000 0 0 0 0 0 0 1\n2.000000000 0 0 0 0 0 0 2\n");
  const Result<EstimatedRun> run = read_run(folder.path());
  ASSERT_FALSE(run.ok());
  EXPECT_NE(run.error().place.find("camera.tum:2"), std::string::npos) << run.error().message();
}

TEST(ReadRun, UnknownStateIsAnError) {
  const TemporaryFolder folder;
  write_run(folder);
  spoil(folder, "frames.csv", "LOST", "ASLEEP");
  const Result<EstimatedRun> run = read_run(folder.path());
  ASSERT_FALSE(run.ok());
  EXPECT_NE(run.error().place.find("frames.csv:3"), std::string::npos) << run.error().message();
}

TEST(ReadRun, MissingColumnIsNamed) {
  const TemporaryFolder folder;
  write_run(folder);
  spoil(folder, "objects.csv", "object_id", "track_id");
  const Result<EstimatedRun> run = read_run(folder.path());
  ASSERT_FALSE(run.ok());
  EXPECT_NE(run.error().detail.find("object_id"), std::string::npos) << run.error().message();
}

TEST(ReadRun, TimeThatStandsStillIsAnError) {
  const TemporaryFolder folder;
  write_text(folder.path() / "camera.tum", "1.0 0 0 0 0 0 0 1\n1.0 0 0 0 0 0 0 1\n");
  EXPECT_FALSE(read_run(folder.path()).ok());
}

TEST(ReadRun, TrajectoryAloneOfAnotherSystemIsARun) {
  const TemporaryFolder folder;
  write_text(folder.path() / "camera.tum",
             "# made elsewhere\n1403715273.262142976 1 2 3 0 0 0 1\n1403715274.5 1 2 3 0 0 0 1\n");
  const Result<EstimatedRun> run = read_run(folder.path());
  ASSERT_TRUE(run.ok()) << run.error().message();
  ASSERT_EQ(run.value().size(), 2U);
  EXPECT_EQ(run.value()[0].capture_time.ns, 1403715273262142976);
  EXPECT_EQ(run.value()[1].capture_time.ns, 1403715274500000000);
}

TEST(ReadRun, ObjectsWithoutOurExtraColumnsAreRead) {
  const TemporaryFolder folder;
  write_text(folder.path() / "camera.tum", "1.0 0 0 0 0 0 0 1\n");
  write_text(folder.path() / "objects.csv",
             "timestamp_ns,object_id,state,p_x,p_y,p_z,q_w,q_x,q_y,q_z,m_x,m_y,m_z,mq_w,mq_x,mq_y,mq_z,points,"
             "sigma_t_m,sigma_r_rad\n1000000000,1,confirmed,4,5,6,1,0,0,0,0,0,0,1,0,0,0,20,0.01,0.002\n");
  const Result<EstimatedRun> run = read_run(folder.path());
  ASSERT_TRUE(run.ok()) << run.error().message();
  const EstimatedObject& object = run.value()[0].objects.at(0);
  EXPECT_EQ(object.centroid_world, Eigen::Vector3d(4, 5, 6));
  EXPECT_DOUBLE_EQ(object.cov_M_centroid(0, 0), 1e-4);
  EXPECT_DOUBLE_EQ(object.cov_M_centroid(5, 5), 4e-6);
}

// Cut at the end of a line: nothing but the counts of frames.csv tells.
TEST(ReadRun, FilesThatLackRowsAreAnError) {
  for (const char* file : {"camera.tum", "objects.csv"}) {
    const TemporaryFolder folder;
    write_run(folder);
    const std::string text = read_text(folder.path() / file);
    const std::string without_last = text.substr(0, text.rfind('\n', text.size() - 2) + 1);
    write_text(folder.path() / file, without_last);
    const Result<EstimatedRun> run = read_run(folder.path());
    ASSERT_FALSE(run.ok()) << file;
    EXPECT_EQ(run.error().code, ErrorCode::bad_input);
    EXPECT_NE(run.error().place.find(file), std::string::npos) << run.error().message();
    EXPECT_NE(run.error().message().find("cut off"), std::string::npos) << run.error().message();
  }
}

TEST(ReadRun, MissingObjectsThatFramesTellOfAreAnError) {
  const TemporaryFolder folder;
  write_run(folder);
  std::filesystem::remove(folder.path() / "objects.csv");
  const Result<EstimatedRun> run = read_run(folder.path());
  ASSERT_FALSE(run.ok());
  EXPECT_NE(run.error().place.find("objects.csv"), std::string::npos) << run.error().message();
}

void remove_end(const std::filesystem::path& file, std::size_t bytes) {
  const std::string text = read_text(file);
  write_text(file, text.substr(0, text.size() - bytes));
}

// As a kill and a power cut leave them: each file ends somewhere else, in the middle of a line too.
TEST(ReadRun, AMarkedRunEndsWithTheLastFrameThatAllFilesHold) {
  for (const char* file : {"camera.tum", "objects.csv", "frames.csv"}) {
    for (const std::size_t bytes : {1U, 7U}) {
      const TemporaryFolder folder;
      write_run(folder);
      remove_end(folder.path() / file, bytes);
      write_text(folder.path() / "INCOMPLETE", "killed\n");
      const Result<EstimatedRun> run = read_run(folder.path());
      ASSERT_TRUE(run.ok()) << file << run.error().message();
      EXPECT_EQ(run.value().size(), 2U) << file;
      EXPECT_TRUE(run.value()[0].T_world_cam);
    }
  }
  for (const char* emptied : {"objects.csv", "timing.csv", "points.csv"}) {
    const TemporaryFolder folder;
    write_run(folder);
    write_text(folder.path() / emptied, "");
    write_text(folder.path() / "INCOMPLETE", "killed\n");
    EXPECT_TRUE(read_run(folder.path()).ok()) << emptied;
    EXPECT_TRUE(read_step_times(folder.path()).ok()) << emptied;
  }
}

TEST(ReadRun, OfAMarkedRunTheCutIsTold) {
  const TemporaryFolder folder;
  write_run(folder);
  write_text(folder.path() / "INCOMPLETE", "killed\n");
  std::string cut = "?";
  ASSERT_TRUE(read_run(folder.path(), &cut).ok());
  EXPECT_EQ(cut, "") << "nothing was";
  remove_end(folder.path() / "objects.csv", 7);
  ASSERT_TRUE(read_run(folder.path(), &cut).ok());
  EXPECT_EQ(cut, "cut to its first 2 of 3 frames, where objects.csv ends");
}

// No kill takes a row out of the middle, or puts one in.
TEST(ReadRun, AMarkedRunWithAHoleIsDamaged) {
  const TemporaryFolder folder;
  write_run(folder);
  const std::string text = read_text(folder.path() / "camera.tum");
  write_text(folder.path() / "camera.tum", text.substr(text.find('\n') + 1));
  write_text(folder.path() / "INCOMPLETE", "killed\n");
  EXPECT_FALSE(read_run(folder.path()).ok());
}

TEST(ReadRun, AMarkedRunWithoutAWholeFrameHoldsNone) {
  const TemporaryFolder folder;
  write_run(folder);
  write_text(folder.path() / "camera.tum", "");
  write_text(folder.path() / "INCOMPLETE", "killed\n");
  const Result<EstimatedRun> run = read_run(folder.path());
  ASSERT_FALSE(run.ok());
  EXPECT_NE(run.error().message().find("holds no frame"), std::string::npos) << run.error().message();
}

TEST(ReadRun, AnEmptyTrajectoryBesideFramesIsAnError) {
  const TemporaryFolder folder;
  write_run(folder);
  write_text(folder.path() / "camera.tum", "");
  const Result<EstimatedRun> run = read_run(folder.path());
  ASSERT_FALSE(run.ok());
  EXPECT_NE(run.error().message().find("holds 0 poses, frames.csv tells of 2"), std::string::npos)
      << run.error().message();
}

TEST(ReadRun, FolderWithoutARunSaysSo) {
  const TemporaryFolder folder;
  const Result<EstimatedRun> run = read_run(folder.path());
  ASSERT_FALSE(run.ok());
  EXPECT_NE(run.error().detail.find("camera.tum"), std::string::npos);
}

TEST(ReadStepTimes, MedianIsTheMiddleStep) {
  const TemporaryFolder folder;
  write_run(folder);
  const auto times = read_step_times(folder.path());
  ASSERT_TRUE(times.ok() && times.value());
  EXPECT_DOUBLE_EQ(times.value()->median_ms, 2.0);
  EXPECT_DOUBLE_EQ(times.value()->p99_ms, 3.0);
}

TEST(ReadStepTimes, RunWithoutTimesHasNone) {
  const TemporaryFolder folder;
  const auto times = read_step_times(folder.path());
  ASSERT_TRUE(times.ok());
  EXPECT_FALSE(times.value());
}

}  // namespace
}  // namespace pelorus
