// Error frames as the kernel's drivers build them: classes in the identifier, details in the bytes (linux/can/error.h).

#include "drivers/can/bus_health.h"

#include <gtest/gtest.h>
#include <linux/can/error.h>

namespace pelorus {
namespace {

CanFrame error_frame(std::uint32_t classes, std::uint8_t controller = 0) {
  CanFrame frame;
  frame.type = CanFrameType::error;
  frame.id = classes;
  frame.size = CAN_ERR_DLC;
  frame.bytes[1] = controller;
  return frame;
}

TEST(BusHealth, FollowsAControllerThroughWarningPassiveBusOffAndRestart) {
  CanBusHealth health;
  health.state = CanBusState::active;
  note_error_frame(error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING), health);
  EXPECT_EQ(health.state, CanBusState::warning);
  note_error_frame(error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE | CAN_ERR_CRTL_TX_WARNING), health);
  EXPECT_EQ(health.state, CanBusState::passive);
  note_error_frame(error_frame(CAN_ERR_BUSOFF), health);
  EXPECT_EQ(health.state, CanBusState::bus_off);
  note_error_frame(error_frame(CAN_ERR_RESTARTED), health);
  EXPECT_EQ(health.state, CanBusState::active);
  EXPECT_EQ(health.bus_offs, 1U);
  EXPECT_EQ(health.restarts, 1U);
  EXPECT_EQ(health.error_frames, 4U);
}

TEST(BusHealth, AnOverrunOrAMissingAcknowledgeIsCountedAndChangesNoState) {
  CanBusHealth health;
  health.state = CanBusState::active;
  note_error_frame(error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW), health);
  note_error_frame(error_frame(CAN_ERR_ACK | CAN_ERR_PROT | CAN_ERR_TX_TIMEOUT), health);
  EXPECT_EQ(health.state, CanBusState::active);
  EXPECT_EQ(health.overruns, 1U);
  EXPECT_EQ(health.not_acknowledged, 1U);
  EXPECT_EQ(health.protocol_errors, 1U);
  EXPECT_EQ(health.tx_timeouts, 1U);
}

TEST(BusHealth, TakesErrorCountersOnlyWhenTheFrameTellsThem) {
  CanBusHealth health;
  CanFrame frame = error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING);
  frame.bytes[6] = 99;
  frame.bytes[7] = 12;
  note_error_frame(frame, health);
  EXPECT_EQ(health.tx_error_counter, 0);
  frame.id |= 0x200;  // CAN_ERR_CNT
  note_error_frame(frame, health);
  EXPECT_EQ(health.tx_error_counter, 99);
  EXPECT_EQ(health.rx_error_counter, 12);
}

TEST(BusHealth, ADataFrameSaysNothingAboutTheBus) {
  CanBusHealth health;
  CanFrame frame = error_frame(CAN_ERR_BUSOFF);
  frame.type = CanFrameType::data;
  note_error_frame(frame, health);
  EXPECT_EQ(health.error_frames, 0U);
  EXPECT_EQ(health.state, CanBusState::absent);
}

}  // namespace
}  // namespace pelorus
