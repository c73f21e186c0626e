#include "drivers/device_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

namespace pelorus {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kPeriod = 50 * kMs;
constexpr std::int64_t kStart = 1'700'000'000'000 * kMs;

// A camera whose clock has an offset and a drift, behind a transport that delays by at least `least_delay`.
struct Simulated {
  double drift = 0;  // 1e-6 = one microsecond a second
  std::int64_t device_origin = 123'456'789;
  std::int64_t least_delay = 3 * kMs;
  std::int64_t extra_delay_ms = 10;  // at most, besides
  std::int64_t jump = 0;             // of the device's clock, from now on
  std::mt19937 random{7};
  int frame = -1;

  // Advances to the next frame; returns the error of the mapped stamp against the truth.
  std::int64_t step(DeviceClock& clock, std::int64_t host_delay = 0) {
    ++frame;
    const std::int64_t since = frame * kPeriod;
    exposed = Timestamp{kStart + since};
    const auto device = device_origin + since + std::llround(drift * static_cast<double>(since)) + jump;
    const std::int64_t noise =
        static_cast<std::int64_t>(random() % static_cast<unsigned>(extra_delay_ms * 1000 + 1)) * 1000;
    mapped = clock.map(device, exposed + Duration(least_delay + noise + host_delay));
    return mapped.time.ns - exposed.ns;
  }
  Timestamp exposed;
  DeviceClock::Mapped mapped;
};

TEST(DeviceClock, FollowsAFreeRunningClockToItsLeastDelay) {
  for (const double drift : {-80e-6, 0.0, 80e-6}) {
    DeviceClock clock(DeviceClockKind::free_running);
    Simulated camera;
    camera.drift = drift;
    for (int i = 0; i < 200; ++i) static_cast<void>(camera.step(clock));
    for (int i = 0; i < 4000; ++i) {
      // 80 ppm over two spans of 5 s are 0.8 ms; the least of 100 delays of up to 10 ms is 0.1 ms, rarely 0.7.
      ASSERT_NEAR(static_cast<double>(camera.step(clock) - camera.least_delay), 0.0, 1.6e6) << drift << " " << i;
    }
    EXPECT_EQ(clock.jumps(), 0U);
  }
}

TEST(DeviceClock, StampsAlwaysIncrease) {
  DeviceClock clock(DeviceClockKind::free_running);
  Simulated camera;
  static_cast<void>(camera.step(clock, 90 * kMs));  // the first frame is the worst possible one
  Timestamp last = camera.mapped.time;
  for (int i = 0; i < 100; ++i) {
    static_cast<void>(camera.step(clock));
    EXPECT_GT(camera.mapped.time, last);
    last = camera.mapped.time;
  }
  EXPECT_LT(camera.mapped.time - camera.exposed, Duration(5 * kMs));
}

TEST(DeviceClock, APtpClockIsTakenExactly) {
  for (const std::int64_t tai_s : {std::int64_t{0}, std::int64_t{37}}) {
    DeviceClock clock(DeviceClockKind::ptp);
    Simulated camera;
    camera.device_origin = kStart + tai_s * 1'000'000'000;
    for (int i = 0; i < 100; ++i) EXPECT_EQ(camera.step(clock), 0);
    EXPECT_TRUE(clock.ptp_locked());
  }
}

TEST(DeviceClock, AClockThatIsNotTheHostsIsNotTakenForPtp) {
  DeviceClock clock(DeviceClockKind::ptp);
  Simulated camera;
  for (int i = 0; i < 100; ++i) static_cast<void>(camera.step(clock));
  EXPECT_FALSE(clock.ptp_locked());
  EXPECT_NEAR(static_cast<double>(camera.step(clock) - camera.least_delay), 0.0, 1e6);
}

TEST(DeviceClock, AJumpCostsOneStampAndIsCounted) {
  for (const std::int64_t jump : {3'600'000 * kMs, -3'600'000 * kMs, 500 * kMs, -500 * kMs}) {
    for (const DeviceClockKind kind : {DeviceClockKind::free_running, DeviceClockKind::ptp}) {
      DeviceClock clock(kind);
      Simulated camera;
      if (kind == DeviceClockKind::ptp) camera.device_origin = kStart;
      for (int i = 0; i < 100; ++i) static_cast<void>(camera.step(clock));
      camera.jump = jump;
      for (int i = 0; i < 40; ++i) {
        const std::int64_t error = camera.step(clock);
        ASSERT_LT(std::abs(error), 15 * kMs) << jump << " " << i;
        EXPECT_EQ(camera.mapped.from_arrival, i == 0);
      }
      EXPECT_EQ(clock.jumps(), 1U);
      camera.jump = 0;
      for (int i = 0; i < 40; ++i) ASSERT_LT(std::abs(camera.step(clock)), 15 * kMs);
      EXPECT_EQ(clock.jumps(), 2U);
    }
  }
}

// SIGSTOP for 300 ms, then everything that waited arrives at once: the stamps are right, the arrivals are not.
TEST(DeviceClock, AStoppedHostIsNoJump) {
  DeviceClock clock(DeviceClockKind::free_running);
  Simulated camera;
  for (int i = 0; i < 100; ++i) static_cast<void>(camera.step(clock));
  for (int waiting = 6; waiting > 0; --waiting) {
    EXPECT_NEAR(static_cast<double>(camera.step(clock, waiting * kPeriod) - camera.least_delay), 0.0, 1e6);
  }
  EXPECT_EQ(clock.jumps(), 0U);
}

}  // namespace
}  // namespace pelorus
