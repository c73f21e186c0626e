// points.csv and outlines.csv: what a known world leaves in them, and back.
#include <gtest/gtest.h>

#include <array>

#include "core/base/image.h"
#include "firmware-host/pelorus/results/scene_reader.h"
#include "firmware-host/pelorus/results/scene_writer.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

using test::TemporaryFolder;

const StereoRig kRig{640, 480, 500, 320, 240, 0.12};
const BodyId kCrate{3};
const Eigen::Vector3d kFixed_world(0.3, -0.2, 4.0);
const Eigen::Vector3d kCorner_obj(0.1, 0.2, -0.1);

// A camera that goes on and turns, a crate that moves on its own.
FrameResult frame(int i) {
  FrameResult result;
  result.seq = static_cast<std::uint64_t>(i);
  result.capture_time = Timestamp{1000 + i};
  result.pose_valid = true;
  result.T_world_cam.translation() = Eigen::Vector3d(0.05 * i, 0, 0.01 * i);
  result.T_world_cam.linear() = so3_exp({0, 0.01 * i, 0});
  result.objects_size = 1;
  ObjectState& crate = result.objects[0];
  crate.id = kCrate;
  crate.phase = ObjectPhase::confirmed;
  crate.motion_measured = true;
  crate.T_world_obj.translation() = Eigen::Vector3d(-0.1 * i, 0.1, 3);
  crate.T_world_obj.linear() = so3_exp({0, 0, 0.1 * i});
  crate.centroid_world = crate.T_world_obj.translation();
  return result;
}

PointView seen(std::uint64_t track, BodyId body, const FrameResult& result, const Eigen::Vector3d& p_world) {
  PointView view;
  view.track = TrackId{track};
  view.body = body;
  view.curr.p_cam = result.T_world_cam.inverse() * p_world;
  view.curr.z_px = kRig.project(view.curr.p_cam);
  return view;
}

class SceneFiles : public ::testing::Test {
 protected:
  SceneFiles() : gray_(640, 480) {
    for (int v = 0; v < 480; ++v) std::fill(gray_.row(v), gray_.row(v) + 640, std::uint8_t{90});
    Result<SceneWriter> created = SceneWriter::create(folder_.path(), kRig);
    EXPECT_TRUE(created.ok());
    writer_.emplace(std::move(created.value()));
  }
  void append(const FrameResult& result, const std::vector<PointView>& points) {
    ASSERT_TRUE(writer_->append(result, points, gray_.view()).ok());
  }
  std::vector<ScenePoint> points() {
    EXPECT_TRUE(writer_->finish().ok());
    Result<std::vector<ScenePoint>> read = read_points(folder_.path());
    EXPECT_TRUE(read.ok()) << read.error().message();
    return read.value();
  }

  TemporaryFolder folder_;
  Image gray_;
  std::optional<SceneWriter> writer_;
};

TEST_F(SceneFiles, ViewsOfAPointComeTogetherInTheFrameOfItsBody) {
  for (int i = 0; i < 5; ++i) {
    const FrameResult result = frame(i);
    append(result, {seen(1, kWorldBody, result, kFixed_world),
                    seen(2, kCrate, result, result.objects[0].T_world_obj * kCorner_obj)});
  }
  const std::vector<ScenePoint> read = points();
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].body, kWorldBody);
  EXPECT_LT((read[0].p_body - kFixed_world).norm(), 1e-6);
  EXPECT_EQ(read[1].body, kCrate);
  EXPECT_LT((read[1].p_body - kCorner_obj).norm(), 1e-6);
  for (const ScenePoint& point : read) {
    EXPECT_EQ(point.views, 5);
    EXPECT_LT(point.spread_m, 1e-6);
    EXPECT_EQ(point.gray, 90);
    EXPECT_EQ(point.first_seen.ns, 1000);
    EXPECT_EQ(point.last_seen.ns, 1004);
  }
}

TEST_F(SceneFiles, NearViewsWeighMoreAndTheSpreadTellsOfDisagreement) {
  FrameResult result = frame(0);
  const std::array<double, 3> depths_m = {2, 2, 4};
  for (int i = 0; i < 3; ++i) {
    result.capture_time.ns += 1;
    const auto at = static_cast<std::size_t>(i);
    // The far view is off by a decimeter; its weight is a 16th of a near one's.
    const Eigen::Vector3d p(0, i == 2 ? 0.1 : 0.0, depths_m[at]);
    result.T_world_cam = Rigid3::Identity();
    result.T_world_cam.translation().z() = 2 - depths_m[at];
    append(result, {seen(1, kWorldBody, result, result.T_world_cam * p)});
  }
  const std::vector<ScenePoint> read = points();
  ASSERT_EQ(read.size(), 1U);
  EXPECT_NEAR(read[0].p_body.y(), 0.1 / 33.0, 1e-6);
  EXPECT_NEAR(read[0].spread_m, 0.1 * std::sqrt(1.0 / 33.0 * (1 - 1.0 / 33.0)), 1e-4);
}

TEST_F(SceneFiles, AFewViewsAnUnexplainedPointACoastingBodyAndALostFrameLeaveNothing) {
  for (int i = 0; i < 6; ++i) {
    FrameResult result = frame(i);
    result.objects[0].motion_measured = false;
    std::vector<PointView> views = {seen(1, kNoBody, result, kFixed_world), seen(2, kCrate, result, kFixed_world)};
    if (i < 2) views.push_back(seen(3, kWorldBody, result, kFixed_world));
    append(result, views);
  }
  for (int i = 6; i < 12; ++i) {
    FrameResult result = frame(i);
    result.pose_valid = false;
    append(result, {seen(4, kWorldBody, result, kFixed_world)});
  }
  EXPECT_TRUE(points().empty());
}

TEST_F(SceneFiles, APointThatChangesItsBodyIsTwoPoints) {
  for (int i = 0; i < 8; ++i) {
    const FrameResult result = frame(i);
    append(result, {seen(1, i < 4 ? kWorldBody : kCrate, result, kFixed_world)});
  }
  const std::vector<ScenePoint> read = points();
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].body, kWorldBody);
  EXPECT_EQ(read[1].body, kCrate);
}

TEST_F(SceneFiles, APointNoLongerFollowedIsOnDiskBeforeTheEnd) {
  for (int i = 0; i < 4; ++i) append(frame(i), {seen(1, kWorldBody, frame(i), kFixed_world)});
  append(frame(4), {});
  const Result<std::vector<ScenePoint>> read = read_points(folder_.path());
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read.value().size(), 1U);
}

TEST_F(SceneFiles, OutlinesLieOnTheBodyAndComeBackInOrder) {
  FrameResult result = frame(3);
  ObjectState& crate = result.objects[0];
  const std::array<Eigen::Vector3d, 3> corners_cam = {Eigen::Vector3d(-0.3, 0, 0), Eigen::Vector3d(0.3, 0, 0),
                                                      Eigen::Vector3d(0, 0.3, 0)};
  const double z_m = (result.T_world_cam.inverse() * crate.centroid_world).z();
  for (const Eigen::Vector3d& corner : corners_cam) {
    const Eigen::Vector3d z_px = kRig.project({corner.x(), corner.y(), z_m});
    crate.outline[static_cast<std::size_t>(crate.outline_size++)] = {static_cast<float>(z_px.x()),
                                                                     static_cast<float>(z_px.y())};
  }
  append(result, {});
  const Result<std::vector<SceneOutline>> read = read_outlines(folder_.path());
  ASSERT_TRUE(read.ok());
  ASSERT_EQ(read.value().size(), 1U);
  EXPECT_EQ(read.value()[0].body, kCrate);
  ASSERT_EQ(read.value()[0].corners_obj.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d p_cam = result.T_world_cam.inverse() * crate.T_world_obj * read.value()[0].corners_obj[i];
    EXPECT_LT((p_cam - Eigen::Vector3d(corners_cam[i].x(), corners_cam[i].y(), z_m)).norm(), 1e-4);
  }
}

TEST_F(SceneFiles, DamageIsAnErrorWithItsLineAndAbsenceIsNone) {
  const std::string header = "object_id,track,p_x,p_y,p_z,spread_m,views,first_ns,last_ns,gray\n";
  test::write_text(folder_.path() / "points.csv", header + "0,1,0,0,1,0,3,1,2,90\n0,2,0,zero,1,0,3,1,2,90\n");
  Result<std::vector<ScenePoint>> read = read_points(folder_.path());
  ASSERT_FALSE(read.ok());
  EXPECT_NE(read.error().message().find("points.csv:3"), std::string::npos) << read.error().message();
  test::write_text(folder_.path() / "points.csv", header + "0,1,0,0,1,0,3,1,2,900\n");
  EXPECT_FALSE(read_points(folder_.path()).ok());
  test::write_text(folder_.path() / "points.csv", "object_id,track\n1,2\n");
  EXPECT_FALSE(read_points(folder_.path()).ok());
  std::filesystem::remove(folder_.path() / "points.csv");
  read = read_points(folder_.path());
  ASSERT_TRUE(read.ok());
  EXPECT_TRUE(read.value().empty());
}

}  // namespace
}  // namespace pelorus
