#include "drivers/can/can_socket.h"

#include <gtest/gtest.h>
#include <linux/can/error.h>

#include "tests/support/can_wire.h"

namespace pelorus {
namespace {

CanFrame numbered(std::uint32_t id, bool fd = false) {
  CanFrame frame;
  frame.id = id;
  frame.fd = fd;
  frame.size = fd ? 64 : 8;
  for (std::size_t i = 0; i < frame.size; ++i) frame.bytes[i] = static_cast<std::uint8_t>(id + i);
  return frame;
}

TEST(CanSocket, AnInterfaceThatIsNotThereIsAnErrorWithItsName) {
  const auto opened = CanSocket::open({.interface = "nosuchcan0"});
  ASSERT_FALSE(opened.ok());
  EXPECT_EQ(opened.error().code, ErrorCode::device);
  EXPECT_EQ(opened.error().place, "nosuchcan0");
  EXPECT_FALSE(CanSocket::open({.interface = ""}).ok());
  EXPECT_FALSE(CanSocket::open({.interface = "longer_than_any_interface"}).ok());
}

TEST(CanSocket, FramesOfBothFormatsArriveAsTheyWereSent) {
  test::CanWire wire;
  CanSocket socket = wire.near_end();
  CanFrame extended = numbered(0x1234567);
  extended.extended = true;
  for (const CanFrame& frame : {numbered(0x123), numbered(0x124, true), extended}) {
    ASSERT_EQ(socket.send(frame), CanSendOutcome::sent);
    const auto seen = wire.take_all();
    ASSERT_EQ(seen.size(), 1U);
    EXPECT_EQ(seen[0].id, frame.id);
    EXPECT_EQ(seen[0].fd, frame.fd);
    EXPECT_EQ(seen[0].extended, frame.extended);
    EXPECT_EQ(seen[0].size, frame.size);
    EXPECT_EQ(seen[0].bytes, frame.bytes);
    EXPECT_EQ(seen[0].type, CanFrameType::data);
  }
}

TEST(CanSocket, ErrorFramesAreToldFromData) {
  test::CanWire wire;
  CanSocket socket = wire.near_end();
  wire.inject(CAN_ERR_FLAG | CAN_ERR_BUSOFF);
  wire.inject(0x123 | CAN_RTR_FLAG);
  CanFrame frame;
  ASSERT_EQ(socket.receive(frame), CanReceiveOutcome::frame);
  EXPECT_EQ(frame.type, CanFrameType::error);
  EXPECT_EQ(frame.id, static_cast<std::uint32_t>(CAN_ERR_BUSOFF));
  ASSERT_EQ(socket.receive(frame), CanReceiveOutcome::frame);
  EXPECT_EQ(frame.type, CanFrameType::remote);
  EXPECT_EQ(socket.receive(frame), CanReceiveOutcome::none) << "and does not wait for more";
}

TEST(CanSocket, AFullQueueIsAnOutcomeAndWhatItHoldsIsKnown) {
  test::CanWire wire;
  CanSocket socket = wire.near_end();
  EXPECT_EQ(socket.unsent_bytes(), 0U);
  CanSendOutcome outcome = CanSendOutcome::sent;
  int sent = 0;
  while (sent < 100'000 && (outcome = socket.send(numbered(1))) == CanSendOutcome::sent) ++sent;
  EXPECT_EQ(outcome, CanSendOutcome::full);
  EXPECT_GT(socket.unsent_bytes(), 0U);
  EXPECT_EQ(wire.take_all().size(), static_cast<std::size_t>(sent));
  EXPECT_EQ(socket.unsent_bytes(), 0U);
  EXPECT_EQ(socket.send(numbered(1)), CanSendOutcome::sent);
}

TEST(CanSocket, AnInterfacePulledOutIsGoneForSendingAndReceiving) {
  test::CanWire wire;
  CanSocket socket = wire.near_end();
  wire.cut();
  CanFrame frame;
  EXPECT_EQ(socket.receive(frame), CanReceiveOutcome::gone);
  EXPECT_EQ(socket.send(numbered(1)), CanSendOutcome::gone);
}

}  // namespace
}  // namespace pelorus
