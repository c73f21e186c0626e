#include "services/can/can_publisher.h"

#include <gtest/gtest.h>
#include <linux/can/error.h>
#include <linux/if_packet.h>

#include <map>
#include <thread>

#include "firmware-host/autopilot/pelorus_can.h"
#include "tests/support/can_wire.h"
#include "tests/support/private_network.h"

namespace pelorus {
namespace {

// Interfaces come and go: each open gets a new wire, or none.
class Bus {
 public:
  CanPublisher::Open opener() {
    return [this](const CanSocketOptions& options) -> Result<CanSocket> {
      ++opens;
      asked = options;
      if (!present) return Error{ErrorCode::device, options.interface, "no such interface", ""};
      wire = std::make_unique<test::CanWire>();
      return wire->near_end();
    };
  }
  bool present = true;
  int opens = 0;
  CanSocketOptions asked;
  std::unique_ptr<test::CanWire> wire;
};

// The loopback of a private network by a packet socket, which refuses frames as a CAN socket does while its interface
// is down; only the kernel's SocketCAN itself is not in it.
class DownableInterface {
 public:
  static bool permitted() {
    static const bool entered = test::enter_private_network({});
    return entered;
  }
  void put(bool up) const { ASSERT_TRUE(test::set_up(control_.get(), "lo", up)); }
  static CanPublisher::Open opener() {
    return [](const CanSocketOptions&) -> Result<CanSocket> {
      UniqueFd fd(::socket(AF_PACKET, SOCK_RAW, 0));
      sockaddr_ll address{};
      address.sll_family = AF_PACKET;
      address.sll_ifindex = static_cast<int>(if_nametoindex("lo"));
      EXPECT_EQ(::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
      return CanSocket::adopt(std::move(fd));
    };
  }

 private:
  UniqueFd control_{::socket(AF_INET, SOCK_DGRAM, 0)};
};

CanConfig quick(bool fd = false) {
  CanConfig config;
  config.enabled = true;
  config.fd = fd;
  config.retry_ms = 0;  // every call looks again
  return config;
}

Publication publication(int k) {
  Publication p;
  p.result.seq = static_cast<std::uint64_t>(k);
  p.result.capture_time = Timestamp{1'000'000'000 + 50'000'000LL * k};
  p.result.state = VisionState::tracking;
  p.result.pose_valid = true;
  p.result.world_confidence = 1;
  p.result.report.points_static = 200;
  p.result.T_world_cam.translation().x() = 0.05 * k;
  p.result.T_curr_prev.translation().x() = -0.05;
  p.step = k > 0 ? std::chrono::milliseconds(50) : Duration{};
  p.released = p.result.capture_time + std::chrono::milliseconds(100);
  return p;
}

CanPublisher publisher_on(Bus& bus, const CanConfig& config = quick()) {
  return CanPublisher(config, Rigid3::Identity(), std::chrono::milliseconds(100), 0xABCD1234, bus.opener());
}

int state_of(const CanFrame& frame) { return frame.bytes[1] >> 4; }

TEST(CanPublisher, EveryResultIsOneSetThatTheAutopilotTakes) {
  for (const bool fd : {false, true}) {
    Bus bus;
    CanPublisher publisher = publisher_on(bus, quick(fd));
    pelorus_can_receiver rx;
    pelorus_can_config config = pelorus_can_default_config();
    config.fd = fd;
    pelorus_can_start(&rx, &config);
    std::uint64_t now_us = 0;
    for (int k = 0; k < 20; ++k) {
      publisher.publish(publication(k));
      now_us += 50'000;
      for (const CanFrame& frame : bus.wire->take_all()) {
        (void)pelorus_can_receive(&rx, frame.id, frame.bytes.data(), frame.size, now_us);
      }
    }
    const pelorus_can_estimate* seen = pelorus_can_latest(&rx, now_us);
    ASSERT_NE(seen, nullptr);
    EXPECT_EQ(rx.counts.sets, 20U);
    EXPECT_EQ(rx.counts.jumps + rx.counts.lost + rx.counts.incomplete + rx.counts.bad_crc, 0U);
    EXPECT_NEAR(static_cast<double>(seen->velocity_mps[0]), 1.0, 1e-3);
    EXPECT_NEAR(static_cast<double>(seen->step_m[0]), 0.05, 1e-4);
    EXPECT_EQ(seen->quality, 100);
    EXPECT_GE(seen->age_us, 100'000U);
    EXPECT_LT(seen->age_us, 150'000U) << "the age at release and the microseconds since";
    EXPECT_EQ(publisher.status().sets_sent, 20U);
    EXPECT_EQ(publisher.status().sets_dropped, 0U);
  }
}

TEST(CanPublisher, SlowFramesComeWithEveryNthEstimateAndNameTheCalibration) {
  Bus bus;
  CanPublisher publisher = publisher_on(bus);
  std::map<std::uint32_t, int> frames;
  CanEstimate seen;
  for (int k = 0; k < 20; ++k) {
    publisher.publish(publication(k));
    for (const CanFrame& frame : bus.wire->take_all()) {
      ++frames[frame.id - kCanDefaultBaseId];
      EXPECT_EQ(decode_frame(frame, kCanDefaultBaseId, seen).outcome, CanDecodeOutcome::ok);
    }
  }
  EXPECT_EQ(frames[0], 20);
  EXPECT_EQ(frames[6], 4);
  EXPECT_EQ(frames[8], 4);
  EXPECT_EQ(frames[9], 20);
  EXPECT_EQ(seen.calibration_hash, double{0xABCD1234});
  EXPECT_NEAR(seen.latency_s, 0.1, 1e-9);
}

TEST(CanPublisher, ALostSystemStillSpeaks) {
  Bus bus;
  CanPublisher publisher = publisher_on(bus);
  Publication lost = publication(1);
  lost.result.state = VisionState::lost;
  lost.result.pose_valid = false;
  publisher.publish(lost);
  const auto frames = bus.wire->take_all();
  ASSERT_EQ(frames.size(), 7U);
  EXPECT_EQ(state_of(frames[0]), static_cast<int>(VisionState::lost));
}

// The bus takes nothing: the kernel holds one set, and every later one is dropped, not queued behind it.
TEST(CanPublisher, NothingWaitsBehindOlderData) {
  Bus bus;
  CanPublisher publisher = publisher_on(bus);
  for (int k = 1; k <= 10; ++k) publisher.publish(publication(k));
  EXPECT_EQ(publisher.status().sets_sent, 1U);
  EXPECT_EQ(publisher.status().sets_dropped, 8U) << "the tenth is still in work";
  EXPECT_LT(publisher.tend(), std::chrono::milliseconds(10)) << "wants to try again soon";
  EXPECT_EQ(bus.wire->take_all().size(), 7U);
  EXPECT_GT(publisher.tend(), std::chrono::milliseconds(10)) << "has sent it now";
  const auto frames = bus.wire->take_all();
  ASSERT_GE(frames.size(), 7U);
  EXPECT_EQ(frames[0].bytes[1] & 0x0F, 10) << "the newest";
  EXPECT_EQ(publisher.status().sets_sent, 2U);
  publisher.publish(publication(11));
  EXPECT_EQ(bus.wire->take_all()[0].bytes[1] & 0x0F, 11);
  EXPECT_EQ(publisher.status().sets_dropped, 8U);
}

TEST(CanPublisher, ASetThatHadToWaitTellsItsTrueAge) {
  Bus bus;
  CanPublisher publisher = publisher_on(bus);
  publisher.publish(publication(1));
  publisher.publish(publication(2));  // waits behind the first
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  (void)bus.wire->take_all();
  (void)publisher.tend();
  CanEstimate seen;
  for (const CanFrame& frame : bus.wire->take_all()) (void)decode_frame(frame, kCanDefaultBaseId, seen);
  EXPECT_GE(seen.age_s, 0.130 - 1e-4);
}

TEST(CanPublisher, AnInterfaceThatIsAbsentAtTheStartIsFoundLater) {
  Bus bus;
  bus.present = false;
  CanPublisher publisher = publisher_on(bus);
  publisher.publish(publication(1));
  EXPECT_EQ(publisher.status().bus.state, CanBusState::absent);
  EXPECT_EQ(publisher.status().sets_unheard, 1U);
  EXPECT_NE(publisher.status().trouble.find("no such interface"), std::string::npos);
  bus.present = true;
  publisher.publish(publication(2));
  EXPECT_EQ(publisher.status().bus.state, CanBusState::active);
  EXPECT_EQ(publisher.status().trouble, "");
  const auto frames = bus.wire->take_all();
  ASSERT_FALSE(frames.empty());
  EXPECT_EQ(frames[0].bytes[1] & 0x0F, 2) << "the counter went on, so that receivers see the gap";
}

TEST(CanPublisher, AnInterfacePulledOutIsOpenedAgainWhenItIsBack) {
  Bus bus;
  CanPublisher publisher = publisher_on(bus);
  publisher.publish(publication(1));
  bus.present = false;
  bus.wire->cut();
  publisher.publish(publication(2));
  publisher.publish(publication(3));
  EXPECT_EQ(publisher.status().bus.state, CanBusState::absent);
  bus.present = true;
  publisher.publish(publication(4));
  EXPECT_EQ(bus.wire->take_all().size(), 7U);
  EXPECT_EQ(publisher.status().bus.state, CanBusState::active);
  EXPECT_EQ(publisher.status().opened, 2U);
}

// Not "too slow a bus": CAN_SETS_DROPPED and the frames' DROPPED stay as they are.
TEST(CanPublisher, SetsForAnInterfaceThatIsDownAreUnheard) {
  if (!DownableInterface::permitted()) GTEST_SKIP() << "no private network: unshare() is not permitted";
  const DownableInterface interface;
  CanPublisher publisher(quick(), Rigid3::Identity(), std::chrono::milliseconds(100), 0, DownableInterface::opener());
  publisher.publish(publication(1));
  EXPECT_EQ(publisher.status().sets_sent, 1U);
  interface.put(false);
  for (int k = 2; k <= 4; ++k) {
    publisher.publish(publication(k));
    (void)publisher.tend();
  }
  EXPECT_EQ(publisher.status().bus.state, CanBusState::down);
  EXPECT_EQ(publisher.status().sets_unheard, 3U);
  interface.put(true);
  publisher.publish(publication(5));
  EXPECT_EQ(publisher.status().bus.state, CanBusState::active);
  EXPECT_EQ(publisher.status().sets_sent, 2U);
  EXPECT_EQ(publisher.status().sets_dropped, 0U);
}

TEST(CanPublisher, ASetThatIsCutOffByTheLossOfItsInterfaceIsUnheard) {
  Bus bus;
  CanPublisher publisher = publisher_on(bus);
  publisher.publish(publication(1));
  publisher.publish(publication(2));  // waits behind the first
  bus.wire->cut();
  (void)publisher.tend();
  publisher.publish(publication(3));  // on a new wire
  EXPECT_EQ(publisher.status().sets_sent, 2U);
  EXPECT_EQ(publisher.status().sets_unheard, 1U);
  EXPECT_EQ(publisher.status().sets_dropped, 0U);
}

TEST(CanPublisher, LooksForALostInterfaceNoMoreOftenThanAsked) {
  Bus bus;
  bus.present = false;
  CanConfig config = quick();
  config.retry_ms = 60'000;
  CanPublisher publisher = publisher_on(bus, config);
  for (int k = 0; k < 10; ++k) publisher.publish(publication(k));
  EXPECT_EQ(bus.opens, 1);
}

TEST(CanPublisher, BusOffIsReportedAndItsEndToo) {
  Bus bus;
  CanPublisher publisher = publisher_on(bus);
  bus.wire->inject(CAN_ERR_FLAG | CAN_ERR_BUSOFF);
  publisher.publish(publication(1));
  EXPECT_EQ(publisher.status().bus.state, CanBusState::bus_off);
  EXPECT_EQ(publisher.status().sets_sent, 0U) << "a controller that is off swallows frames";
  EXPECT_EQ(publisher.status().sets_unheard, 1U);
  EXPECT_NE(status_text(publisher.status(), "can0").find("can0 bus-off"), std::string::npos);
  (void)bus.wire->take_all();
  bus.wire->inject(CAN_ERR_FLAG | CAN_ERR_RESTARTED);
  publisher.publish(publication(2));
  EXPECT_EQ(publisher.status().bus.state, CanBusState::active);
  EXPECT_EQ(publisher.status().bus.bus_offs, 1U);
  EXPECT_EQ(publisher.status().sets_sent, 1U);
}

TEST(CanPublisher, ASetThatWaitsForAControllerThatIsOffIsUnheard) {
  Bus bus;
  CanPublisher publisher = publisher_on(bus);
  publisher.publish(publication(1));  // the kernel keeps it
  bus.wire->inject(CAN_ERR_FLAG | CAN_ERR_BUSOFF);
  for (int k = 2; k <= 5; ++k) publisher.publish(publication(k));
  EXPECT_EQ(publisher.status().sets_unheard, 3U) << "the fifth is still in work";
  EXPECT_EQ(publisher.status().sets_dropped, 0U);
}

TEST(CanPublisher, AsksForErrorFramesOnlyAndForFdWhenConfigured) {
  Bus bus;
  CanConfig config = quick(true);
  config.interface = "vcan7";
  CanPublisher publisher = publisher_on(bus, config);
  EXPECT_FALSE(bus.asked.receive_data);
  EXPECT_TRUE(bus.asked.fd);
  EXPECT_EQ(bus.asked.interface, "vcan7");
}

}  // namespace
}  // namespace pelorus
