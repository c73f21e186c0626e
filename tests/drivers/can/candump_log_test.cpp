#include "drivers/can/candump_log.h"

#include <gtest/gtest.h>

#include <string>

namespace pelorus {
namespace {

CanFrame parsed(const std::string& line) {
  const auto entry = parse_candump_line(line);
  EXPECT_TRUE(entry.ok()) << line;
  return entry.ok() ? entry.value().frame : CanFrame{};
}

TEST(CandumpLog, LinesOfCandumpComeBackUnchanged) {
  for (const std::string line : {
           "(1700000000.050000) can0 120#7E2E04D2FFC80007",
           "(0000000001.000001) vcan0 7FF#",
           "(1700000000.050000) can0 1FFFFFFF#01",
           "(1700000000.050000) can0 123#R",
           "(1700000000.050000) can0 20000040#0000000000000000",
           "(1700000000.050000) can0 12A##0000102030405060708090A0B",
       }) {
    const auto entry = parse_candump_line(line);
    ASSERT_TRUE(entry.ok()) << line;
    EXPECT_EQ(candump_line(entry.value().frame, entry.value().interface), line);
  }
}

TEST(CandumpLog, TellsWhatKindOfFrameItIs) {
  EXPECT_TRUE(parsed("(1.000000) c 12345678#00").extended);
  EXPECT_FALSE(parsed("(1.000000) c 123#00").extended);
  EXPECT_TRUE(parsed("(1.000000) c 123##100").fd);
  EXPECT_EQ(parsed("(1.000000) c 123##5AABB").bytes[1], 0xBB);
  EXPECT_EQ(parsed("(1.000000) c 123#R4").type, CanFrameType::remote);
  EXPECT_EQ(parsed("(1.000000) c 20000004#0004000000000000").type, CanFrameType::error);
  EXPECT_EQ(parsed("(1700000000.123456) c 123#00").time.ns, 1'700'000'000'123'456'000);
}

TEST(CandumpLog, RefusesWhatIsNoLineOfCandump) {
  for (const std::string line : {
           "",
           "garbage",
           "(1.000000)",
           "(1.000000) can0",
           "(1.000000) can0 123",
           "(1.0) can0 123#00",
           "(1.000000) can0 12#00",
           "(1.000000) can0 800#00",
           "(1.000000) can0 3FFFFFFFF#00",
           "(1.000000) can0 123#0",
           "(1.000000) can0 123#0011223344556677889",
           "(1.000000) can0 123#001122334455667788",
           "(1.000000) can0 123##",
           "(1.000000) can0 123##0001122334455667788",
           "(1.000000) can0 123#GG",
           "(99999999999999999999.000000) can0 123#00",
           "(-1.000000) can0 123#00",
       }) {
    EXPECT_FALSE(parse_candump_line(line).ok()) << line;
  }
}

}  // namespace
}  // namespace pelorus
