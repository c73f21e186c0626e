// Messages over the real bus: published, carried by multicast, received, logged and played back.
#include "services/lcm_publisher.h"

#include <gtest/gtest.h>

#include <bot_core/image_t.hpp>
#include <bot_core/pose_t.hpp>
#include <filesystem>
#include <thread>

#include "services/lcm_messages.h"
#include "tests/services/lcm_loopback.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

Rigid3 T_body_cam() {
  Rigid3 T = Rigid3::Identity();
  T.linear() << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // looking ahead
  T.translation() << 0.5, -0.1, 0.2;
  return T;
}

class LcmBus : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!test::lcm_available()) GTEST_SKIP() << "no multicast route: ip route add 224.0.0.0/4 dev lo";
    config_.url = test::loopback_url();
    config_.vehicle = "TEST";
  }
  LcmConfig config_;
};

Rigid3 transform(const double pos[3], const double q[4]) {
  Rigid3 T = Rigid3::Identity();
  T.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  T.translation() << pos[0], pos[1], pos[2];
  return T;
}

// Row by row, as the wire has it.
Matrix6d covariance(const double values[36]) {
  return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(values);
}

template <std::size_t N>
bool all_nan(const double (&values)[N]) {
  return std::all_of(values, values + N, [](double value) { return std::isnan(value); });
}

TEST_F(LcmBus, OdometryArrivesWithEveryFieldAsPublished) {
  test::Listener<vis_odom_t> listener(config_.url, "TEST.VIS_ODOM");
  LcmPublisher publisher(config_, T_body_cam());
  const Publication sent = test::rich_publication();
  publisher.publish(sent);
  ASSERT_TRUE(listener.wait_for(1));
  const vis_odom_t& got = listener.messages[0];
  EXPECT_EQ(got.utime, 1'600'000'000'123'456);
  EXPECT_NEAR(got.latency_ms, 80.321, 1e-6);
  EXPECT_EQ(got.publish_utime, 1'600'000'000'203'777);
  EXPECT_EQ(got.seq, 4711);
  EXPECT_EQ(got.state, vis_odom_t::STATE_DEGRADED);
  EXPECT_EQ(got.state_text, "DEGRADED");
  EXPECT_EQ(got.reason_text, "few points");
  EXPECT_TRUE(got.pose_valid);
  EXPECT_FALSE(got.deadline_missed);
  EXPECT_EQ(got.reset_counter, 3);
  EXPECT_EQ(got.points_static, 321);
  EXPECT_EQ(got.points_moving, 45);
  EXPECT_DOUBLE_EQ(got.world_confidence, 0.7);
  EXPECT_DOUBLE_EQ(got.step_s, 0.05);
  const BodyFrames frames(T_body_cam());
  EXPECT_TRUE(transform(got.pos_m, got.quat_wxyz).isApprox(frames.pose_of_body(sent.result.T_world_cam), 1e-12));
  // The step on the wire continues the pose: T_world_prev = T_world_curr * T_curr_prev.
  const Rigid3 T_prev_curr = transform(got.step_pos_m, got.step_quat_wxyz);
  EXPECT_TRUE(T_prev_curr.isApprox(frames.pose_of_body(sent.result.T_curr_prev.inverse()), 1e-12));
  const Matrix6d cov = frames.covariance(sent.result.cov_T_world_cam);
  for (int i = 0; i < 36; ++i) EXPECT_DOUBLE_EQ(got.cov_pose[i], cov(i / 6, i % 6));
  // Of the body's step: H = T_curr_prev inverted (its perturbation goes over by Ad(T_prev_curr)), then carried to the
  // body. The velocity is the step by its time.
  const Matrix6d Ad = adjoint(sent.result.T_curr_prev.inverse());
  const Matrix6d cov_step = frames.covariance(Ad * sent.result.cov_T_curr_prev * Ad.transpose());
  EXPECT_TRUE(covariance(got.cov_step).isApprox(cov_step, 1e-12));
  EXPECT_TRUE(covariance(got.cov_velocity).isApprox(cov_step / (0.05 * 0.05), 1e-12));
}

TEST_F(LcmBus, WithoutAPoseNumbersAreUnknownAndNoTrackIsTold) {
  test::Listener<vis_odom_t> odom(config_.url, "TEST.VIS_ODOM");
  test::Listener<vis_tracks_t> tracks(config_.url, "TEST.VIS_TRACKS");
  test::Listener<bot_core::pose_t> pose(config_.url, "TEST.POSE_BODY");
  LcmPublisher publisher(config_, T_body_cam());
  Publication sent = test::rich_publication();
  sent.result.pose_valid = false;
  sent.result.state = VisionState::lost;
  publisher.publish(sent);
  ASSERT_TRUE(odom.wait_for(1));
  ASSERT_TRUE(tracks.wait_for(1));
  const vis_odom_t& got = odom.messages[0];
  EXPECT_EQ(got.state_text, "LOST");
  EXPECT_EQ(got.quality_percent, -1);
  EXPECT_FALSE(got.pose_valid || got.velocity_valid);
  EXPECT_TRUE(all_nan(got.pos_m) && all_nan(got.quat_wxyz) && all_nan(got.cov_pose));
  EXPECT_TRUE(all_nan(got.vel_body_mps) && all_nan(got.rate_body_radps) && all_nan(got.cov_velocity));
  EXPECT_TRUE(all_nan(got.step_pos_m) && all_nan(got.step_quat_wxyz) && all_nan(got.cov_step));
  EXPECT_EQ(tracks.messages[0].n_tracks, 0);
  EXPECT_FALSE(pose.wait_for(1, 0.2)) << "POSE_BODY cannot say that it is invalid: it must be silent";
}

// The first pair has a pose and no motion yet.
TEST_F(LcmBus, WithoutAVelocityThePoseMessageIsSilentRatherThanAtRest) {
  test::Listener<vis_odom_t> odom(config_.url, "TEST.VIS_ODOM");
  test::Listener<bot_core::pose_t> pose(config_.url, "TEST.POSE_BODY");
  LcmPublisher publisher(config_, T_body_cam());
  Publication sent = test::rich_publication();
  const std::int64_t second_utime = utime_of(sent.result.capture_time);
  sent.result.capture_time = sent.result.capture_time + -sent.step;
  sent.step = Duration::zero();
  publisher.publish(sent);
  const Publication moving = test::rich_publication();
  publisher.publish(moving);
  ASSERT_TRUE(odom.wait_for(2));
  EXPECT_TRUE(odom.messages[0].pose_valid);
  EXPECT_FALSE(odom.messages[0].velocity_valid);
  ASSERT_TRUE(pose.wait_for(1));
  EXPECT_FALSE(pose.wait_for(2, 0.2));
  EXPECT_EQ(pose.messages[0].utime, second_utime);
  for (int i = 0; i < 3; ++i) {
    EXPECT_DOUBLE_EQ(pose.messages[0].vel[i], odom.messages[1].vel_body_mps[i]);
    EXPECT_DOUBLE_EQ(pose.messages[0].rotation_rate[i], odom.messages[1].rate_body_radps[i]);
  }
}

TEST_F(LcmBus, TracksArriveAndTheirMotionCarriesTheCentroid) {
  test::Listener<vis_tracks_t> listener(config_.url, "TEST.VIS_TRACKS");
  LcmPublisher publisher(config_, T_body_cam());
  const Publication sent = test::rich_publication();
  publisher.publish(sent);
  ASSERT_TRUE(listener.wait_for(1));
  const vis_tracks_t& got = listener.messages[0];
  ASSERT_EQ(got.n_tracks, 2);
  EXPECT_EQ(got.n_confirmed, 1);
  const vis_track_t& track = got.tracks[0];
  EXPECT_EQ(track.id, 5);
  EXPECT_EQ(track.phase_text, "confirmed");
  EXPECT_EQ(got.tracks[1].phase, vis_track_t::PHASE_COASTING);
  EXPECT_EQ(track.first_seen_utime, got.utime - 3'000'000);
  EXPECT_EQ(track.n_outline, 3);
  EXPECT_FLOAT_EQ(track.outline_u_px[1], 30.25F);
  const Rigid3 M_world = transform(track.step_pos_m, track.step_quat_wxyz);
  const Eigen::Vector3d centroid(track.centroid_world_m);
  const Eigen::Vector3d velocity(track.vel_world_mps);
  EXPECT_TRUE(velocity.isApprox((centroid - M_world.inverse() * centroid) / got.step_s, 1e-9));
  // Looking ahead: 4 m along the optical axis is 4 m ahead of the camera, 0.3 m right is starboard.
  EXPECT_NEAR(track.centroid_body_m[0], 4.0 + 0.5, 1e-9);
  EXPECT_NEAR(track.centroid_body_m[1], 0.3 - 0.1, 1e-9);
  EXPECT_NEAR(track.range_m, std::sqrt(16 + 0.09 + 0.04), 1e-9);
  const BodyFrames frames(T_body_cam());
  for (std::size_t k = 0; k < 2; ++k) {
    const ObjectState& object = sent.result.objects[k];
    EXPECT_TRUE(covariance(got.tracks[k].cov_pose).isApprox(frames.covariance(object.cov_T_world_obj), 1e-12));
    EXPECT_TRUE(covariance(got.tracks[k].cov_step).isApprox(frames.covariance(object.cov_M_world), 1e-12));
  }
}

TEST_F(LcmBus, HealthAndPictureArrive) {
  test::Listener<vis_health_t> health(config_.url, "TEST.VIS_HEALTH");
  test::Listener<bot_core::image_t> image(config_.url, "TEST.VIS_IMAGE_.*");
  LcmPublisher publisher(config_, T_body_cam());
  HealthReport report;
  report.time = Timestamp{5'000'000};
  report.counters.deadline_misses = 7;
  report.timing.latency_p99_ms = 101.5;
  report.state = VisionState::camera_fault;
  report.reason = StateReason::no_pictures;
  report.host.disk_free_gb = 78.5;
  report.wall_step_s = -3600.25;
  report.config_hash = "0123456789abcdef";
  report.privileges_text = "real time, memory locked, 2 threads pinned";
  std::uint64_t number = 100;
  CounterReport& c = report.counters;
  for (std::uint64_t* counter :
       {&c.pictures_incomplete, &c.packets_missing, &c.packets_resent, &c.camera_reopens, &c.can_sets_sent,
        &c.can_sets_dropped, &c.can_sets_unheard, &c.can_error_frames, &c.can_bus_offs, &c.recorder_pairs_written,
        &c.recorder_pairs_dropped, &c.recorder_pairs_failed}) {
    *counter = number++;
  }
  publisher.publish_health(report);
  PreviewPicture picture;
  picture.capture_time = Timestamp{9'000'000};
  picture.width = 640;
  picture.height = 480;
  picture.jpeg.assign(60000, 0xA5);
  publisher.publish_preview(picture);
  ASSERT_TRUE(health.wait_for(1));
  ASSERT_TRUE(image.wait_for(1));
  EXPECT_EQ(health.messages[0].utime, 5000);
  EXPECT_EQ(health.messages[0].deadline_misses, 7);
  EXPECT_DOUBLE_EQ(health.messages[0].latency_p99_ms, 101.5);
  EXPECT_EQ(health.messages[0].state_text, "CAMERA_FAULT");
  EXPECT_EQ(health.messages[0].reason_text, "no pictures");
  EXPECT_EQ(health.messages[0].config_hash, "0123456789abcdef");
  EXPECT_TRUE(std::isnan(health.messages[0].temperature_degc));
  EXPECT_DOUBLE_EQ(health.messages[0].disk_free_gb, 78.5);
  EXPECT_DOUBLE_EQ(health.messages[0].wall_step_s, -3600.25);
  const vis_health_t& got = health.messages[0];
  EXPECT_EQ(got.privileges_text, report.privileges_text);
  const std::vector<std::int64_t> counters{
      got.pictures_incomplete, got.packets_missing,        got.packets_resent,         got.camera_reopens,
      got.can_sets_sent,       got.can_sets_dropped,       got.can_sets_unheard,       got.can_error_frames,
      got.can_bus_offs,        got.recorder_pairs_written, got.recorder_pairs_dropped, got.recorder_pairs_failed};
  for (std::size_t i = 0; i < counters.size(); ++i) EXPECT_EQ(counters[i], 100 + static_cast<std::int64_t>(i));
  EXPECT_EQ(image.messages[0].size, 60000);
  EXPECT_EQ(image.messages[0].data, picture.jpeg);
  EXPECT_EQ(image.channels[0], "TEST.VIS_IMAGE_LEFT");
}

TEST(LcmTypes, PoseHasTheHashOfTheCommonPackage) {
  // Of bot_core.pose_t as lcm-gen makes it from the six fields every reader of POSE_BODY was built with.
  constexpr std::uint64_t kFields = 0x170b77d82958082f;
  EXPECT_EQ(static_cast<std::uint64_t>(bot_core::pose_t::getHash()), (kFields << 1) + (kFields >> 63));
}

TEST(LcmLink, WithoutANetworkCountsAndGoesOn) {
  LcmConfig config;
  config.url = "udpm://239.255.76.67:notaport?ttl=0";
  LcmPublisher publisher(config, T_body_cam());
  for (int i = 0; i < 5; ++i) publisher.publish(test::rich_publication());
  EXPECT_FALSE(publisher.link().works());
  EXPECT_EQ(publisher.link().errors(), 15U) << "three messages a result, none of which left";
  EXPECT_EQ(publisher.link().attempts(), 1U) << "one try a second, not one a message";
}

TEST_F(LcmBus, LoggerAndPlayerGiveBackWhatWasPublished) {
  const test::TemporaryFolder folder;
  const std::string log = (folder.path() / "dive.lcmlog").string();
  test::ChildProcess logger({"lcm-logger", "-q", "--lcm-url=" + config_.url, log});
  if (!logger.started()) GTEST_SKIP() << "lcm-logger is not installed (package liblcm-bin)";
  constexpr int kMessages = 20;
  {
    // The logger says nothing when it is ready: the first message in its file does.
    LcmPublisher publisher(config_, T_body_cam());
    HealthReport knock;
    std::error_code ignored;
    for (int i = 0; i < 100 && std::filesystem::file_size(log, ignored) + 1 <= 1; ++i) {
      publisher.publish_health(knock);
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    Publication publication = test::rich_publication();
    for (int i = 0; i < kMessages; ++i) {
      publication.result.seq = static_cast<std::uint64_t>(i);
      publisher.publish(publication);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // the logger writes every 100 ms
  }
  logger.send(SIGINT);
  EXPECT_EQ(logger.wait(), 0);

  const std::string other_url = test::loopback_url(1);
  test::Listener<vis_odom_t> listener(other_url, "TEST.VIS_ODOM");
  test::ChildProcess player({"lcm-logplayer", "-l", other_url, log});
  ASSERT_TRUE(player.started());
  EXPECT_TRUE(listener.wait_for(kMessages));
  EXPECT_EQ(player.wait(), 0);
  for (int i = 0; i < kMessages; ++i) {
    vis_odom_t& got = listener.messages[static_cast<std::size_t>(i)];
    EXPECT_EQ(got.seq, i);
    EXPECT_NEAR(got.latency_ms, 80.321, 1e-6);
  }
}

}  // namespace
}  // namespace pelorus
