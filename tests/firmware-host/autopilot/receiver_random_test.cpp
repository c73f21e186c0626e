// Random and damaged frames into the receiver. The oracle is the service's own decoder, written from the contract's
// table and not from the receiver. Under ./run asan this also proves that no byte outside a frame is touched.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "tests/firmware-host/autopilot/receiver_fixture.h"

namespace pelorus {
namespace {

using test::kSetInterval_us;
using test::Link;
using test::steady_estimate;

bool counts_as_good(pelorus_can_event event) {
  return event == PELORUS_CAN_PART || event == PELORUS_CAN_SET || event == PELORUS_CAN_SET_JUMP ||
         event == PELORUS_CAN_BAD_STATE || event == PELORUS_CAN_REPEATED;
}

// The frame in a heap block of exactly its size, so that a read beyond it is caught by the address sanitizer.
pelorus_can_event receive_exact(pelorus_can_receiver& rx, const CanFrame& frame, std::uint64_t now_us) {
  const auto block = std::make_unique<std::uint8_t[]>(frame.size);
  std::copy_n(frame.bytes.begin(), frame.size, block.get());
  return pelorus_can_receive(&rx, frame.id, frame.size == 0 ? nullptr : block.get(), frame.size, now_us);
}

bool is_good(const CanFrame& frame) {
  CanEstimate ignored;
  CanFrame seen = frame;
  seen.fd = frame.id - kCanDefaultBaseId >= 10;  // the receiver is not told the format, only the length
  return decode_frame(seen, kCanDefaultBaseId, ignored).outcome == CanDecodeOutcome::ok;
}

CanFrame random_frame(std::mt19937& random) {
  const auto below = [&](unsigned end) { return std::uniform_int_distribution<unsigned>(0, end - 1)(random); };
  CanFrame frame;
  frame.id = below(8) == 0 ? static_cast<std::uint32_t>(random()) : kCanDefaultBaseId - 2 + below(16);
  constexpr std::array<std::uint8_t, 6> kUsual{8, 8, 8, 32, 64, 64};
  frame.size = static_cast<std::uint8_t>(below(4) == 0 ? below(65) : kUsual[below(6)]);
  for (std::uint8_t& byte : frame.bytes) byte = static_cast<std::uint8_t>(random());
  return frame;
}

class ReceiverUnderFire : public testing::TestWithParam<CanTransport> {};
INSTANTIATE_TEST_SUITE_P(Transports, ReceiverUnderFire, testing::Values(CanTransport::classic, CanTransport::fd),
                         [](const auto& instance) {
                           return instance.param == CanTransport::classic ? "Classic" : "Fd";
                         });

TEST_P(ReceiverUnderFire, NeverTakesARandomFrameThatTheContractRefuses) {
  std::mt19937 random(11);
  Link link(GetParam());
  int good = 0;
  for (int i = 0; i < 400'000; ++i) {
    const CanFrame frame = random_frame(random);
    link.now_us += random() % 3000;
    const pelorus_can_event event = receive_exact(link.rx, frame, link.now_us);
    if (!counts_as_good(event)) continue;
    ASSERT_TRUE(is_good(frame)) << "frame " << i;
    ++good;
  }
  const double accidental = GetParam() == CanTransport::classic ? 400'000.0 / 256 : 1;
  EXPECT_LT(good, accidental) << "only what passes an 8-bit CRC by accident";
  EXPECT_EQ(link.rx.counts.sets == 0 || GetParam() == CanTransport::fd, true) << "a whole set cannot come by accident";
}

// A live stream with damage: flipped bits, lost, repeated, swapped, cut and foreign frames. Every estimate that is
// handed out must be one that was sent, whole, in order and in time.
TEST_P(ReceiverUnderFire, EveryEstimateHandedOutIsOneThatWasSent) {
  std::mt19937 random(12);
  const auto chance = [&](double p) { return std::uniform_real_distribution<double>(0, 1)(random) < p; };
  Link link(GetParam());
  std::uint64_t handed_out = 0;
  double newest_sent_mps = 0;
  for (int set_number = 0; set_number < 20'000; ++set_number) {
    link.now_us += kSetInterval_us;
    // The number of the set rides in the position, in steps no smaller than the resolution.
    CanEstimate e = steady_estimate();
    newest_sent_mps = 0.001 * (set_number % 30'000);
    e.vel_x_mps = newest_sent_mps;
    e.step_x_m = newest_sent_mps * e.interval_s;
    e.step_y_m = e.step_z_m = e.turn_x_rad = e.turn_y_rad = e.turn_z_rad = 0;
    const CanSet set = encode_set(e, {GetParam(), kCanDefaultBaseId, ++link.counter, chance(0.2)});
    for (CanFrame frame : set) {
      if (chance(0.01)) continue;
      if (chance(0.01)) frame.bytes[random() % frame.size] ^= static_cast<std::uint8_t>(1U << (random() % 8));
      if (chance(0.005)) frame.size = static_cast<std::uint8_t>(random() % 64);
      if (chance(0.005)) frame.id ^= 1;
      if (chance(0.01)) (void)receive_exact(link.rx, random_frame(random), link.now_us);
      const pelorus_can_event event = receive_exact(link.rx, frame, link.now_us);
      ASSERT_TRUE(!counts_as_good(event) || is_good(frame));
      if (chance(0.01)) (void)receive_exact(link.rx, frame, link.now_us);
    }
    const pelorus_can_estimate* seen = link.latest();
    if (seen == nullptr) continue;
    ++handed_out;
    ASSERT_EQ(seen->valid & PELORUS_CAN_VELOCITY, static_cast<std::uint32_t>(PELORUS_CAN_VELOCITY));
    // At most one timeout old: six sets.
    const double behind_mps = newest_sent_mps - static_cast<double>(seen->velocity_mps[0]);
    ASSERT_GT(behind_mps, -0.0006);
    ASSERT_LT(behind_mps, 0.001 * 6 + 0.0006);
    const double phase = static_cast<double>(seen->velocity_mps[0]) / 0.001;
    ASSERT_NEAR(phase, std::round(phase), 0.01) << "a velocity that nobody sent";
  }
  EXPECT_GT(handed_out, 15'000U) << "protection that refuses everything is none";
}

}  // namespace
}  // namespace pelorus
