#include "firmware-host/pelorus/can/can_dump.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "services/can/contract_text.h"
#include "tests/support/temporary_folder.h"

namespace pelorus {
namespace {

// What CanDump prints for all vectors of the contract.
class Printed {
 public:
  explicit Printed(const CanDumpOptions& options) : out_(std::tmpfile()), dump(options, out_) {}
  ~Printed() { std::fclose(out_); }
  Printed(const Printed&) = delete;
  Printed& operator=(const Printed&) = delete;

  void take_vectors(CanTransport transport) {
    Timestamp time{1'700'000'000'000'000'000};
    for (const ContractVector& v : contract_vectors()) {
      for (CanFrame frame : encode_set(v.estimate, {transport, kCanDefaultBaseId, v.counter, v.with_slow})) {
        frame.time = time;
        dump.take(frame);
      }
      time = time + std::chrono::milliseconds(50);
    }
  }
  std::string text() {
    std::string all;
    std::rewind(out_);
    for (int c = std::fgetc(out_); c != EOF; c = std::fgetc(out_)) all += static_cast<char>(c);
    return all;
  }

 private:
  std::FILE* out_;

 public:
  CanDump dump;
};

CanFrame velocity_frame() {
  CanEstimate e;
  e.state = VisionState::tracking;
  e.vel_x_mps = 1.25;
  CanFrame frame = encode_frame(can_frame_spec(CanFrameKind::velocity), e, kCanDefaultBaseId, 7);
  frame.time = Timestamp{1'700'000'000'050'000'000};
  return frame;
}

TEST(CanDump, AFrameIsToldWithNamesUnitsAndInvalidFields) {
  EXPECT_EQ(frame_text(velocity_frame(), kCanDefaultBaseId, false),
            "1700000000.050000  VIS_VEL  #7 TRACKING  VX 1.25 m/s  VY -  VZ -");
  EXPECT_EQ(frame_text(velocity_frame(), kCanDefaultBaseId, true),
            "{\"time_s\":1700000000.050000,\"frame\":\"VIS_VEL\",\"counter\":7,\"state\":\"TRACKING\",\"VX\":1.25,"
            "\"VY\":null,\"VZ\":null}");
}

TEST(CanDump, ADamagedFrameIsSaidToBeAndItsNumbersAreNotShown) {
  CanFrame frame = velocity_frame();
  frame.bytes[3] ^= 1;
  EXPECT_EQ(frame_text(frame, kCanDefaultBaseId, false), "1700000000.050000  120  VIS_VEL: wrong CRC");
  frame.size = 5;
  EXPECT_NE(frame_text(frame, kCanDefaultBaseId, true).find("\"error\":\"VIS_VEL: wrong length\""), std::string::npos);
}

TEST(CanDump, AHashIsShownToItsLastDigit) {
  CanEstimate e;
  e.calibration_hash = 0xFFFFFFFF;
  const CanFrame frame = encode_frame(can_frame_spec(CanFrameKind::node), e, kCanDefaultBaseId, 0);
  EXPECT_NE(frame_text(frame, kCanDefaultBaseId, false).find("CALIBRATION 4294967295"), std::string::npos);
}

TEST(CanDump, SetsOfBothTransportsComeFromTheAutopilotsReceiver) {
  for (const CanTransport transport : {CanTransport::classic, CanTransport::fd}) {
    CanDumpOptions options;
    options.sets = true;
    Printed printed(options);
    printed.take_vectors(transport);
    EXPECT_EQ(printed.dump.lines(), 5U);
    const std::string text = printed.text();
    EXPECT_NE(text.find("link starting  state TRACKING"), std::string::npos) << text;
    EXPECT_NE(text.find("link up  state LOST"), std::string::npos) << text;
    EXPECT_NE(printed.dump.summary().find("5 sets, 0 lost, 0 incomplete, 0 jumps"), std::string::npos);
  }
}

TEST(CanDump, ForeignAndErrorFramesAreCountedApart) {
  Printed printed({});
  CanFrame foreign = velocity_frame();
  foreign.id = 0x700;
  printed.dump.take(foreign);
  CanFrame error;
  error.type = CanFrameType::error;
  error.id = 0x40;  // bus-off
  printed.dump.take(error);
  EXPECT_EQ(printed.dump.counts().foreign, 1U);
  EXPECT_EQ(printed.dump.counts().error_frames, 1U);
  EXPECT_NE(printed.text().find("bus bus-off"), std::string::npos);
}

TEST(CanDump, EndsAtTheLimitOfLines) {
  CanDumpOptions options;
  options.count = 3;
  Printed printed(options);
  printed.take_vectors(CanTransport::classic);
  EXPECT_EQ(printed.dump.lines(), 3U);
}

TEST(CanDump, FollowsAnotherBaseIdentifier) {
  CanDumpOptions options;
  options.base_id = 0x300;
  Printed printed(options);
  CanFrame frame = velocity_frame();
  printed.dump.take(frame);
  EXPECT_EQ(printed.dump.counts().foreign, 1U);
  frame.id = 0x300;
  printed.dump.take(frame);
  EXPECT_EQ(printed.dump.counts().frames, 1U);
}

TEST(CanDump, ASourceThatIsNeitherFileNorInterfaceIsAnError) {
  CanDumpOptions options;
  options.source = "nosuchcan0";
  const auto outcome = run_can_dump(options);
  ASSERT_FALSE(outcome.ok());
  EXPECT_EQ(outcome.error().code, ErrorCode::device);
}

TEST(CanDump, ALogWithoutAWholeFrameIsAnError) {
  const test::TemporaryFolder folder;
  const std::string log = (folder.path() / "x.log").string();
  CanDumpOptions options;
  options.source = log;
  test::write_text(log, "");
  const auto empty = run_can_dump(options);
  ASSERT_FALSE(empty.ok());
  EXPECT_EQ(empty.error().code, ErrorCode::bad_input);
  EXPECT_NE(empty.error().message().find("holds no frame"), std::string::npos);
  std::array<char, 8> id{};
  std::snprintf(id.data(), id.size(), "%03X", velocity_frame().id);
  test::write_text(log, std::string("(1700000000.050000) can0 ") + id.data() + "#1122\n");  // cut short
  const auto cut = run_can_dump(options);
  ASSERT_FALSE(cut.ok());
  EXPECT_EQ(cut.error().code, ErrorCode::bad_input);
  EXPECT_NE(cut.error().message().find("no frame of the contract is whole, of 1"), std::string::npos);
  test::write_text(log, "(1700000000.050000) can0 7FF#1122\n");
  EXPECT_TRUE(run_can_dump(options).ok()) << "a bus of others";
}

TEST(CanDump, LinesThatAreNoneOfCandumpMakeExitCodeThreeAfterTheRestWasShown) {
  CanDumpOptions options;
  options.source = std::string(PELORUS_SOURCE_DIR) + "/README.md";
  const auto outcome = run_can_dump(options);
  ASSERT_TRUE(outcome.ok());
  EXPECT_EQ(outcome.value(), 3);
}

}  // namespace
}  // namespace pelorus
