#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/firmware-host/autopilot/receiver_fixture.h"

namespace pelorus {
namespace {

using test::kSetInterval_us;
using test::Link;
using test::receive;
using test::steady_estimate;

bool is_a_deviation(const CanSignal& signal) {
  return signal.coding == CanCoding::log_sigma || signal.coding == CanCoding::float16;
}
bool carried(const CanFrameSpec& spec, CanTransport transport) { return spec.fd == (transport == CanTransport::fd); }
std::uint32_t all_bits(CanTransport transport) {
  const std::uint32_t all = (1U << 10) - 1;
  return transport == CanTransport::fd ? all : all & ~static_cast<std::uint32_t>(PELORUS_CAN_TURN);
}

class Receiver : public testing::TestWithParam<CanTransport> {};
INSTANTIATE_TEST_SUITE_P(Transports, Receiver, testing::Values(CanTransport::classic, CanTransport::fd),
                         [](const auto& instance) {
                           return instance.param == CanTransport::classic ? "Classic" : "Fd";
                         });

TEST(ReceiverCrc, AgreesWithTheCheckValuesItsHeaderNames) {
  const auto* text = reinterpret_cast<const std::uint8_t*>("123456789");
  EXPECT_EQ(pelorus_can_crc8('1', text + 1, 8), 0xDF);
  EXPECT_EQ(pelorus_can_crc16(static_cast<std::uint16_t>('1' | '2' << 8), text + 2, 7), 0x29B1);
}

TEST_P(Receiver, HandsNothingOutBeforeEnoughGoodSets) {
  Link link(GetParam());
  EXPECT_EQ(link.latest(), nullptr);
  EXPECT_EQ(link.send_next(steady_estimate()), PELORUS_CAN_SET);
  EXPECT_EQ(pelorus_can_link_state(&link.rx, link.now_us), PELORUS_CAN_LINK_STARTING);
  EXPECT_EQ(link.latest(), nullptr);
  (void)link.send_next(steady_estimate());
  EXPECT_EQ(pelorus_can_link_state(&link.rx, link.now_us), PELORUS_CAN_LINK_UP);
  EXPECT_NE(link.latest(), nullptr);
}

// Both ends over random estimates: what comes out is what went in, to the resolution of the contract.
TEST_P(Receiver, ReadsWhatTheEncoderWroteToTheResolutionOfTheContract) {
  const bool fd = GetParam() == CanTransport::fd;
  Link link(GetParam());
  link.bring_up();
  std::mt19937 random(3);
  const auto draw = [&](double most) { return std::uniform_real_distribution<double>(-most, most)(random); };
  for (int i = 0; i < 500; ++i) {
    CanEstimate e = steady_estimate();
    // A velocity that belongs to the step, since FD carries the step only.
    const Eigen::Vector3d way(draw(1), draw(1), draw(1));
    const Eigen::Vector3d turn(draw(0.3), draw(0.3), draw(0.3));
    Rigid3 T_prev_curr = Rigid3::Identity();
    T_prev_curr.linear() = so3_exp(turn);
    T_prev_curr.translation() = way;
    const Eigen::Vector3d vel = se3_log(T_prev_curr).head<3>() / e.interval_s;
    e.step_x_m = way.x(), e.step_y_m = way.y(), e.step_z_m = way.z();
    e.turn_x_rad = turn.x(), e.turn_y_rad = turn.y(), e.turn_z_rad = turn.z();
    e.vel_x_mps = vel.x(), e.vel_y_mps = vel.y(), e.vel_z_mps = vel.z();
    e.roll_rad = draw(3.1), e.pitch_rad = draw(1.5), e.yaw_rad = draw(3.1);
    e.position_x_m = draw(5000), e.position_y_m = draw(5000), e.position_z_m = draw(5000);
    e.age_s = 0.08 + draw(0.07);
    e.object_bearing_rad = draw(3.1), e.object_elevation_rad = draw(1.5), e.object_range_m = 150 + draw(149);
    e.object_closing_mps = draw(20);
    ASSERT_EQ(link.send_next(e, true), PELORUS_CAN_SET);
    const pelorus_can_estimate* seen = link.latest();
    ASSERT_NE(seen, nullptr);
    const double step_m = fd ? 1e-6 : 0.5e-4 + 1e-6;
    const double vel_mps = fd ? 2e-5 : 0.5e-3 + 1e-5;
    EXPECT_NEAR(static_cast<double>(seen->step_m[0]), way.x(), step_m);
    EXPECT_NEAR(static_cast<double>(seen->step_m[2]), way.z(), step_m);
    EXPECT_NEAR(static_cast<double>(seen->velocity_mps[0]), vel.x(), vel_mps);
    EXPECT_NEAR(static_cast<double>(seen->velocity_mps[1]), vel.y(), vel_mps);
    EXPECT_NEAR(static_cast<double>(seen->velocity_mps[2]), vel.z(), vel_mps);
    EXPECT_NEAR(static_cast<double>(seen->roll_rad), e.roll_rad, 0.51e-4);
    EXPECT_NEAR(static_cast<double>(seen->pitch_rad), e.pitch_rad, 0.51e-4);
    EXPECT_NEAR(static_cast<double>(seen->yaw_rad), e.yaw_rad, 0.51e-4);
    EXPECT_NEAR(static_cast<double>(seen->position_m[0]), e.position_x_m, fd ? 3e-4 : 0.0055);
    EXPECT_NEAR(static_cast<double>(seen->position_m[2]), e.position_z_m, fd ? 3e-4 : 0.0055);
    EXPECT_NEAR(seen->age_us * 1e-6, e.age_s, 0.51e-4);
    EXPECT_NEAR(static_cast<double>(seen->body_bearing_rad), e.object_bearing_rad, 0.51e-4);
    EXPECT_NEAR(static_cast<double>(seen->body_elevation_rad), e.object_elevation_rad, 0.51e-4);
    EXPECT_NEAR(static_cast<double>(seen->body_range_m), e.object_range_m, 0.0051);
    EXPECT_NEAR(static_cast<double>(seen->body_closing_mps), e.object_closing_mps, 0.51e-3);
    EXPECT_EQ(seen->calibration_hash, 0xC0FFEE42U);
  }
}

TEST_P(Receiver, TellsEveryOtherFieldToo) {
  Link link(GetParam());
  link.bring_up();
  CanEstimate e = steady_estimate();
  e.sets_dropped = 1234;
  (void)link.send_next(e, true);
  const pelorus_can_estimate* seen = link.latest();
  ASSERT_NE(seen, nullptr);
  EXPECT_EQ(seen->valid, all_bits(GetParam()));
  EXPECT_EQ(seen->state, PELORUS_CAN_STATE_TRACKING);
  EXPECT_EQ(seen->quality, 87);
  EXPECT_EQ(seen->bodies, 2);
  EXPECT_EQ(seen->body_id, 17);
  EXPECT_EQ(seen->body_phase, 1);
  EXPECT_EQ(seen->body_confidence_percent, 80);
  EXPECT_EQ(seen->version, kCanContractVersion);
  EXPECT_EQ(seen->sender_dropped, 1234);
  EXPECT_NEAR(static_cast<double>(seen->interval_s), 0.05, 1e-6);
  EXPECT_NEAR(static_cast<double>(seen->latency_s), 0.08, 1e-6);
  const auto sigma = [](float variance) { return std::sqrt(static_cast<double>(variance)); };
  const bool fd = GetParam() == CanTransport::fd;
  EXPECT_NEAR(sigma(seen->attitude_variance_rad2), 0.004, 0.004 * 0.045);
  EXPECT_GE(sigma(seen->attitude_variance_rad2), 0.004 * (1 - 1e-5));
  EXPECT_NEAR(sigma(seen->position_variance_m2), 0.25, 0.25 * 0.045);
  EXPECT_NEAR(sigma(seen->velocity_variance_m2ps2[0]), fd ? 0.01 : 0.02, 0.001);
  EXPECT_NEAR(sigma(seen->step_variance_m2[2]), 0.001, 0.000045);
  EXPECT_TRUE(!fd || std::abs(sigma(seen->turn_variance_rad2[1]) - 0.00025) < 1e-7);
  EXPECT_EQ(seen->measured_us, seen->received_us - 79'900);
}

TEST_P(Receiver, SilenceEndsInATimeoutAndTwoGoodSetsEndIt) {
  Link link(GetParam());
  link.bring_up();
  link.now_us += 300'000;
  EXPECT_NE(link.latest(), nullptr);
  link.now_us += 1;
  EXPECT_EQ(link.latest(), nullptr);
  EXPECT_EQ(pelorus_can_link_state(&link.rx, link.now_us), PELORUS_CAN_LINK_TIMEOUT);
  EXPECT_EQ(link.rx.counts.timeouts, 1U);
  (void)link.send_next(steady_estimate());
  EXPECT_EQ(link.latest(), nullptr) << "one set may be a stale one that waited for the bus";
  (void)link.send_next(steady_estimate());
  EXPECT_NE(link.latest(), nullptr);
}

TEST_P(Receiver, AMeasurementGrowsOldByItself) {
  Link link(GetParam(), [](pelorus_can_config& c) { c.max_age_us = 200'000; });
  link.bring_up();
  const pelorus_can_estimate* seen = link.latest();
  ASSERT_NE(seen, nullptr);
  EXPECT_EQ(pelorus_can_age_us(seen, link.now_us), 79'900U);
  EXPECT_EQ(pelorus_can_age_us(seen, link.now_us + 1234), 81'134U);
  link.now_us += 120'100;
  EXPECT_NE(link.latest(), nullptr);
  link.now_us += 1;
  EXPECT_EQ(link.latest(), nullptr) << "older than max_age_us, though the link is up";
  EXPECT_EQ(pelorus_can_link_state(&link.rx, link.now_us), PELORUS_CAN_LINK_UP);
  link.now_us -= 1000;
  (void)link.send_next(steady_estimate());
}

TEST_P(Receiver, OneLostSetIsForgivenButItsStepIsNot) {
  Link link(GetParam());
  link.bring_up();
  ASSERT_NE(link.latest(), nullptr);
  EXPECT_TRUE(link.latest()->valid & PELORUS_CAN_STEP);
  ++link.counter;
  EXPECT_EQ(link.send_next(steady_estimate()), PELORUS_CAN_SET);
  const pelorus_can_estimate* seen = link.latest();
  ASSERT_NE(seen, nullptr);
  EXPECT_FALSE(seen->valid & (PELORUS_CAN_STEP | PELORUS_CAN_TURN)) << "the way since a set that was not received";
  EXPECT_TRUE(std::isnan(seen->step_m[0]));
  EXPECT_TRUE(seen->valid & PELORUS_CAN_VELOCITY);
  EXPECT_EQ(link.rx.counts.lost, 1U);
}

TEST_P(Receiver, TheStepAfterALostEstimateSpansMoreThanItsReceiverKnows) {
  Link link(GetParam());
  link.bring_up();
  CanEstimate lost;
  lost.state = VisionState::lost;
  lost.quality_percent = 0;
  lost.age_s = 0.1;
  (void)link.send_next(lost);
  (void)link.send_next(steady_estimate());
  ASSERT_NE(link.latest(), nullptr);
  EXPECT_FALSE(link.latest()->valid & PELORUS_CAN_STEP);
  EXPECT_TRUE(link.latest()->valid & PELORUS_CAN_VELOCITY);
  (void)link.send_next(steady_estimate());
  EXPECT_TRUE(link.latest()->valid & PELORUS_CAN_STEP);
}

TEST_P(Receiver, AJumpOfTheCounterTakesTheLinkDown) {
  Link link(GetParam());
  link.bring_up();
  link.counter += 2;
  EXPECT_EQ(link.send_next(steady_estimate()), PELORUS_CAN_SET_JUMP);
  EXPECT_EQ(link.latest(), nullptr);
  EXPECT_EQ(link.rx.counts.jumps, 1U);
  (void)link.send_next(steady_estimate());
  EXPECT_NE(link.latest(), nullptr);
}

TEST_P(Receiver, ARepeatedSetIsNoNewEstimate) {
  Link link(GetParam());
  link.bring_up();
  const std::uint64_t received_us = link.latest()->received_us;
  link.now_us += 10'000;
  EXPECT_EQ(link.send(steady_estimate(), link.counter), PELORUS_CAN_REPEATED);
  EXPECT_EQ(link.latest()->received_us, received_us) << "a frozen sender must not look alive";
}

TEST_P(Receiver, ASenderThatRepeatsItselfForEverTimesOut) {
  Link link(GetParam());
  link.bring_up();
  for (int i = 0; i < 7; ++i) {
    link.now_us += kSetInterval_us;
    (void)link.send(steady_estimate(), link.counter);
  }
  EXPECT_EQ(link.latest(), nullptr);
}

TEST_P(Receiver, CountersRollOverWithoutAJump) {
  Link link(GetParam());
  for (int i = 0; i < 600; ++i) EXPECT_EQ(link.send_next(steady_estimate()), PELORUS_CAN_SET);
  EXPECT_EQ(link.rx.counts.jumps, 0U);
  EXPECT_EQ(link.rx.counts.lost, 0U);
  EXPECT_EQ(link.rx.counts.sets, 600U);
}

TEST_P(Receiver, ALostSystemIsHeardButItsNumbersAreNot) {
  Link link(GetParam());
  link.bring_up();
  CanEstimate lying = steady_estimate();  // a sender that forgot to mark its fields
  lying.state = VisionState::lost;
  (void)link.send_next(lying, true);
  const pelorus_can_estimate* seen = link.latest();
  ASSERT_NE(seen, nullptr) << "liveness and validity are two things";
  EXPECT_EQ(seen->state, PELORUS_CAN_STATE_LOST);
  EXPECT_FALSE(seen->valid & (PELORUS_CAN_VELOCITY | PELORUS_CAN_ATTITUDE | PELORUS_CAN_STEP | PELORUS_CAN_POSITION |
                              PELORUS_CAN_BODY));
  EXPECT_TRUE(std::isnan(seen->velocity_mps[0]));
  EXPECT_TRUE(std::isnan(seen->position_m[0]));
}

TEST_P(Receiver, NumbersWithoutAnAgeAQualityOrAKnownStateAreNotVouchedFor) {
  for (int fault = 0; fault < 3; ++fault) {
    Link link(GetParam());
    link.bring_up();
    CanEstimate e = steady_estimate();
    if (fault == 0) e.age_s = kCanUnknown;
    if (fault == 1) e.quality_percent = 0;
    if (fault == 2) e.state = static_cast<VisionState>(9);
    (void)link.send_next(e);
    ASSERT_NE(link.latest(), nullptr);
    EXPECT_FALSE(link.latest()->valid & PELORUS_CAN_VELOCITY) << fault;
  }
}

TEST_P(Receiver, EachInvalidFieldTakesOnlyItsOwnValueAway) {
  Link link(GetParam());
  link.bring_up();
  CanEstimate e = steady_estimate();
  e.roll_rad = kCanUnknown;
  (void)link.send_next(e, true);
  ASSERT_NE(link.latest(), nullptr);
  EXPECT_FALSE(link.latest()->valid & PELORUS_CAN_ATTITUDE);
  EXPECT_TRUE(std::isnan(link.latest()->pitch_rad));
  EXPECT_TRUE(link.latest()->valid & PELORUS_CAN_VELOCITY);
  e = steady_estimate();
  e.object_range_m = kCanUnknown;
  e.position_y_m = kCanUnknown;
  (void)link.send_next(e, true);
  EXPECT_FALSE(link.latest()->valid & (PELORUS_CAN_BODY | PELORUS_CAN_BODY_CLOSING | PELORUS_CAN_POSITION));
  EXPECT_TRUE(link.latest()->valid & PELORUS_CAN_ATTITUDE);
}

// Whatever is not vouched for cannot be used by mistake.
TEST_P(Receiver, AFieldWithoutItsBitIsNoNumber) {
  const auto is_nan_3 = [](const float(&v)[3]) { return std::isnan(v[0]) && std::isnan(v[1]) && std::isnan(v[2]); };
  for (const CanFrameSpec& spec : can_contract()) {
    for (const CanSignal& signal : spec.signals) {
      if (signal.field == nullptr || signal.beyond == CanBeyond::wraps) continue;
      Link link(GetParam());
      link.bring_up();
      CanEstimate e = steady_estimate();
      e.*signal.field = kCanUnknown;
      (void)link.send_next(e, true);
      const pelorus_can_estimate* seen = link.latest();
      ASSERT_NE(seen, nullptr);
      if (is_a_deviation(signal) && carried(spec, GetParam())) {
        EXPECT_NE(seen->valid, all_bits(GetParam())) << "a number without its deviation: " << spec.name << signal.name;
      }
      const auto lacks = [&](unsigned bit) { return (seen->valid & bit) == 0; };
      EXPECT_EQ(lacks(PELORUS_CAN_VELOCITY), is_nan_3(seen->velocity_mps)) << spec.name << signal.name;
      EXPECT_EQ(lacks(PELORUS_CAN_STEP), is_nan_3(seen->step_m)) << spec.name << signal.name;
      EXPECT_EQ(lacks(PELORUS_CAN_STEP), is_nan_3(seen->step_variance_m2)) << spec.name << signal.name;
      EXPECT_EQ(lacks(PELORUS_CAN_TURN), is_nan_3(seen->turn_rad)) << spec.name << signal.name;
      EXPECT_EQ(lacks(PELORUS_CAN_POSITION), is_nan_3(seen->position_m)) << spec.name << signal.name;
      EXPECT_EQ(lacks(PELORUS_CAN_ATTITUDE), std::isnan(seen->roll_rad) && std::isnan(seen->yaw_rad)) << signal.name;
      EXPECT_EQ(lacks(PELORUS_CAN_VELOCITY), is_nan_3(seen->velocity_variance_m2ps2)) << spec.name << signal.name;
      EXPECT_EQ(lacks(PELORUS_CAN_ATTITUDE), std::isnan(seen->attitude_variance_rad2)) << spec.name << signal.name;
      EXPECT_EQ(lacks(PELORUS_CAN_POSITION), std::isnan(seen->position_variance_m2)) << spec.name << signal.name;
      EXPECT_EQ(lacks(PELORUS_CAN_BODY), std::isnan(seen->body_range_m)) << spec.name << signal.name;
      EXPECT_EQ(lacks(PELORUS_CAN_BODY_CLOSING), std::isnan(seen->body_closing_mps)) << spec.name << signal.name;
    }
  }
}

TEST_P(Receiver, AResetIsToldUntilItWasHandedOut) {
  Link link(GetParam());
  link.bring_up();
  ASSERT_NE(link.latest(), nullptr);
  EXPECT_FALSE(link.latest()->reset);
  CanEstimate e = steady_estimate();
  e.resets = 1;
  (void)link.send_next(e);  // nobody looks at this one
  (void)link.send_next(e);
  EXPECT_TRUE(link.latest()->reset);
  (void)link.send_next(e);
  EXPECT_FALSE(link.latest()->reset);
}

TEST_P(Receiver, AClockThatRunsBackTakesTheLinkDown) {
  Link link(GetParam());
  link.bring_up();
  ASSERT_NE(link.latest(), nullptr);
  link.now_us += 10'000;
  ASSERT_NE(link.latest(), nullptr);
  EXPECT_EQ(pelorus_can_latest(&link.rx, link.now_us - 1), nullptr) << "even where the estimate is not from the future";
  EXPECT_EQ(link.rx.counts.timeouts, 1U);
}

TEST_P(Receiver, AfterATimeoutTheCounterMayBeginAnywhereEvenWhereItEnded) {
  for (const unsigned onward : {0U, 1U, 7U}) {
    Link link(GetParam());
    link.bring_up();
    link.now_us += 400'000;
    EXPECT_EQ(link.latest(), nullptr);
    link.counter += onward;
    EXPECT_EQ(link.send(steady_estimate(), link.counter), PELORUS_CAN_SET) << onward;
    EXPECT_EQ(link.latest(), nullptr) << "one set is not enough";
    EXPECT_EQ(link.send_next(steady_estimate()), PELORUS_CAN_SET);
    EXPECT_NE(link.latest(), nullptr);
    EXPECT_EQ(link.rx.counts.jumps, 0U);
  }
}

TEST_P(Receiver, ListensToOneTransportAndOneBaseOnly) {
  Link link(GetParam(), [](pelorus_can_config& c) { c.base_id = 0x300; });
  EXPECT_EQ(link.send_next(steady_estimate(), true), PELORUS_CAN_NOT_OURS);
  Link other(GetParam());
  const CanTransport wrong = GetParam() == CanTransport::fd ? CanTransport::classic : CanTransport::fd;
  for (const CanFrame& frame : encode_set(steady_estimate(), {.transport = wrong, .with_slow = true})) {
    EXPECT_EQ(receive(other.rx, frame, 1), PELORUS_CAN_NOT_OURS);
  }
}

TEST(ClassicReceiver, AFrameThatComesTwiceIsTakenOnceAndTheFirstCounts) {
  Link link;
  link.bring_up();
  link.now_us += kSetInterval_us;
  CanEstimate other = steady_estimate();
  other.vel_x_mps = -9;
  const CanSet set = encode_set(steady_estimate(), {.counter = ++link.counter});
  const CanSet forged = encode_set(other, {.counter = link.counter});
  EXPECT_EQ(receive(link.rx, set.frames[0], link.now_us), PELORUS_CAN_PART);
  EXPECT_EQ(receive(link.rx, forged.frames[0], link.now_us), PELORUS_CAN_REPEATED);
  for (std::size_t i = 1; i < 7; ++i) (void)receive(link.rx, set.frames[i], link.now_us);
  ASSERT_NE(link.latest(), nullptr);
  EXPECT_NEAR(static_cast<double>(link.latest()->velocity_mps[0]), 1.234, 1e-3);
  EXPECT_EQ(link.rx.counts.repeated, 1U);
}

TEST(ClassicReceiver, APositionOfAnEarlierSetIsNotTakenForANewOne) {
  Link link;
  link.bring_up();
  (void)link.send_next(steady_estimate(), true);
  ASSERT_TRUE(link.latest()->valid & PELORUS_CAN_POSITION);
  (void)link.send_next(steady_estimate(), false);
  EXPECT_FALSE(link.latest()->valid & (PELORUS_CAN_POSITION | PELORUS_CAN_NODE));
  EXPECT_TRUE(std::isnan(link.latest()->position_m[0]));
}

TEST(FdReceiver, VariancesFromTheLeastToInfinity) {
  Link link(CanTransport::fd);
  link.bring_up();
  CanEstimate e = steady_estimate();
  e.step_var_x_mm2 = 1e-6;  // subnormal in binary16
  (void)link.send_next(e);
  EXPECT_NEAR(static_cast<double>(link.latest()->step_variance_m2[0]), 1e-12, 0.06e-12);
  e.step_var_x_mm2 = 1e9;  // more than binary16 holds: infinity, and then nothing is known of the step
  (void)link.send_next(e);
  EXPECT_FALSE(link.latest()->valid & (PELORUS_CAN_STEP | PELORUS_CAN_VELOCITY));
}

TEST(FdReceiver, WithoutAnIntervalThereIsNoVelocity) {
  for (const double interval_s : {kCanUnknown, 0.0, 5.0}) {
    Link link(CanTransport::fd);
    link.bring_up();
    CanEstimate e = steady_estimate();
    e.interval_s = interval_s;
    (void)link.send_next(e);
    ASSERT_NE(link.latest(), nullptr);
    EXPECT_FALSE(link.latest()->valid & (PELORUS_CAN_VELOCITY | PELORUS_CAN_INTERVAL)) << interval_s;
    EXPECT_TRUE(std::isnan(link.latest()->interval_s));
  }
}

TEST(ClassicReceiver, ASetMissingAnyOneFrameIsNotASet) {
  for (int missing = 0; missing < 7; ++missing) {
    Link link;
    link.bring_up();
    const std::uint32_t sets = link.rx.counts.sets;
    link.now_us += kSetInterval_us;
    const CanSet set = encode_set(steady_estimate(), {.counter = ++link.counter});
    for (int i = 0; i < set.size; ++i) {
      if (i != missing) (void)receive(link.rx, set.frames[static_cast<std::size_t>(i)], link.now_us);
    }
    EXPECT_EQ(link.rx.counts.sets, sets) << missing;
    (void)link.send_next(steady_estimate());
    EXPECT_EQ(link.rx.counts.incomplete, 1U);
    EXPECT_EQ(link.rx.counts.lost, 1U);
  }
}

TEST(ClassicReceiver, FramesOfDifferentEstimatesNeverMakeASet) {
  Link link;
  link.bring_up();
  const std::uint32_t sets = link.rx.counts.sets;
  const CanSet a = encode_set(steady_estimate(), {.counter = link.counter + 1});
  const CanSet b = encode_set(steady_estimate(), {.counter = link.counter + 2});
  for (std::size_t i = 0; i < 7; ++i) (void)receive(link.rx, i % 2 == 0 ? a.frames[i] : b.frames[i], link.now_us);
  EXPECT_EQ(link.rx.counts.sets, sets);
}

TEST(ClassicReceiver, AnyOrderOfFramesMakesTheSameSet) {
  std::mt19937 random(5);
  Link link;
  link.bring_up();
  for (int i = 0; i < 50; ++i) {
    link.now_us += kSetInterval_us;
    CanSet set = encode_set(steady_estimate(), {.counter = ++link.counter});
    std::shuffle(set.frames.begin(), set.frames.begin() + set.size, random);
    pelorus_can_event last = PELORUS_CAN_NOT_OURS;
    for (const CanFrame& frame : set) last = receive(link.rx, frame, link.now_us);
    EXPECT_EQ(last, PELORUS_CAN_SET);
  }
}

TEST(ClassicReceiver, FramesSixteenEstimatesApartDoNotMeet) {
  Link link([] { return CanTransport::classic; }(), [](pelorus_can_config& c) { c.timeout_us = 10'000'000; });
  link.bring_up();
  const std::uint32_t sets = link.rx.counts.sets;
  const CanSet a = encode_set(steady_estimate(), {.counter = link.counter + 1});
  for (std::size_t i = 0; i < 4; ++i) (void)receive(link.rx, a.frames[i], link.now_us);
  link.now_us += 16 * kSetInterval_us;
  for (std::size_t i = 4; i < 7; ++i) (void)receive(link.rx, a.frames[i], link.now_us);
  EXPECT_EQ(link.rx.counts.sets, sets);
  EXPECT_EQ(link.rx.counts.incomplete, 1U);
}

TEST(ClassicReceiver, FramesOfOneSetThatContradictEachOtherAreDropped) {
  Link link;
  link.bring_up();
  const std::uint32_t sets = link.rx.counts.sets;
  CanEstimate lost = steady_estimate();
  lost.state = VisionState::lost;
  const CanSet a = encode_set(steady_estimate(), {.counter = link.counter + 1});
  const CanSet b = encode_set(lost, {.counter = link.counter + 1});
  for (std::size_t i = 0; i < 6; ++i) (void)receive(link.rx, a.frames[i], link.now_us);
  EXPECT_EQ(receive(link.rx, b.frames[6], link.now_us), PELORUS_CAN_BAD_STATE);
  EXPECT_EQ(link.rx.counts.sets, sets);
}

}  // namespace
}  // namespace pelorus
