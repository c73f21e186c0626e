#include "services/can/can_codec.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "services/can/can_crc.h"
#include "services/can/half_float.h"

namespace pelorus {
namespace {

std::vector<std::uint8_t> bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

const CanSignal& signal_named(CanFrameKind kind, const std::string& name) {
  for (const CanSignal& signal : can_frame_spec(kind).signals) {
    if (name == signal.name) return signal;
  }
  ADD_FAILURE() << name;
  return can_frame_spec(kind).signals[0];
}

double through_wire(const CanSignal& signal, double value) { return value_of(signal, raw_of(signal, value)); }

// Check values of the AUTOSAR CRC library specification, CRC8H2F and CRC16 (CCITT-FALSE).
TEST(CanCrc, GivesTheCheckValuesOfTheAutosarSpecification) {
  const auto crc8 = [](const std::vector<std::uint8_t>& bytes) {
    return static_cast<std::uint8_t>(~crc8_2f(kCrc8Start, bytes));
  };
  EXPECT_EQ(crc8(bytes_of("123456789")), 0xDF);
  EXPECT_EQ(crc8({0, 0, 0, 0}), 0x12);
  EXPECT_EQ(crc8({0xF2, 0x01, 0x83}), 0xC2);
  EXPECT_EQ(crc8({0x0F, 0xAA, 0x00, 0x55}), 0xC6);
  EXPECT_EQ(crc16_ccitt(kCrc16Start, bytes_of("123456789")), 0x29B1);
  EXPECT_EQ(crc16_ccitt(kCrc16Start, std::vector<std::uint8_t>{0, 0, 0, 0}), 0x84C0);
}

TEST(CanContract, FieldsOfAFrameLieInsideItAndDoNotOverlap) {
  for (const CanFrameSpec& spec : can_contract()) {
    std::set<int> taken;
    for (const CanSignal& signal : spec.signals) {
      EXPECT_LE(signal.start_bit + signal.bits, 8 * spec.size) << spec.name << " " << signal.name;
      for (int bit = 0; bit < signal.bits; ++bit) {
        EXPECT_TRUE(taken.insert(signal.start_bit + bit).second) << spec.name << " " << signal.name;
      }
    }
  }
}

TEST(CanContract, IdentifiersAndDataIdsAreUniqueAndTheClosingFramesComeLast) {
  std::set<std::uint16_t> data_ids;
  std::uint32_t offset = 0;
  for (const CanFrameSpec& spec : can_contract()) {
    EXPECT_EQ(spec.id_offset, offset++);
    EXPECT_TRUE(data_ids.insert(spec.data_id).second);
    EXPECT_EQ(&can_frame_spec(spec.kind), &spec);
  }
  const CanSet classic = encode_set({}, {.with_slow = true});
  EXPECT_EQ(classic.view().back().id, kCanDefaultBaseId + 9);
  const CanSet fd = encode_set({}, {.transport = CanTransport::fd, .with_slow = true});
  EXPECT_EQ(fd.view().back().id, kCanDefaultBaseId + 11);
}

TEST(CanContract, NamesInAFrameAreUniqueAndFitOtherTools) {
  for (const CanFrameSpec& spec : can_contract()) {
    std::set<std::string> names;
    for (const CanSignal& signal : spec.signals) {
      const std::string name = signal.name;
      EXPECT_TRUE(names.insert(name).second) << spec.name << " " << name;
      EXPECT_LE(name.size(), 32U);
      EXPECT_EQ(std::string(signal.meaning).find('"'), std::string::npos) << "would end a DBC comment";
    }
  }
}

// Every field of every frame: random values come back to within half a step of the contract, not more.
TEST(CanCodec, EveryFieldComesBackToItsResolution) {
  std::mt19937 random(1);
  for (const CanFrameSpec& spec : can_contract()) {
    for (const CanSignal& signal : spec.signals) {
      if (signal.coding != CanCoding::signed_integer) continue;
      const double most = (std::ldexp(1.0, signal.bits - 1) - 1) * signal.scale;
      std::uniform_real_distribution<double> value(-most, most);
      for (int i = 0; i < 200; ++i) {
        const double sent = value(random);
        EXPECT_NEAR(through_wire(signal, sent), sent, 0.5 * signal.scale * (1 + 1e-9)) << spec.name << signal.name;
      }
      EXPECT_DOUBLE_EQ(through_wire(signal, most), most);
      EXPECT_DOUBLE_EQ(through_wire(signal, -most), -most);
    }
  }
}

TEST(CanCodec, AValueBeyondItsFieldIsInvalidAndNeverClipped) {
  const CanSignal& vx = signal_named(CanFrameKind::velocity, "VX");
  EXPECT_EQ(raw_of(vx, 32.7674), 0x7FFFU);
  EXPECT_EQ(raw_of(vx, 32.768), 0x8000U);
  EXPECT_EQ(raw_of(vx, -32.768), 0x8000U) << "the invalid code is not a velocity";
  EXPECT_EQ(raw_of(vx, -40), 0x8000U) << "and does not wrap round to a positive one";
  EXPECT_EQ(raw_of(vx, -1e300), 0x8000U);
  EXPECT_EQ(raw_of(vx, 1e300), 0x8000U);
  EXPECT_EQ(raw_of(vx, std::numeric_limits<double>::infinity()), 0x8000U);
  EXPECT_EQ(raw_of(vx, kCanUnknown), 0x8000U);
  EXPECT_TRUE(std::isnan(value_of(vx, 0x8000)));
}

TEST(CanCodec, AnAgeBeyondItsFieldIsTheLargestAndNoneIsInvalid) {
  const CanSignal& age = signal_named(CanFrameKind::quality, "AGE");
  EXPECT_DOUBLE_EQ(through_wire(age, 60.0), 3.2767);
  EXPECT_TRUE(std::isnan(through_wire(age, kCanUnknown)));
}

TEST(CanCodec, ADeviationIsNeverUnderstatedAndOffByLessThanOneStep) {
  const CanSignal& sigma = signal_named(CanFrameKind::quality, "SIGMA_VEL");
  for (double value = sigma.scale; value < 5.9; value *= 1.0137) {
    const double seen = through_wire(sigma, value);
    EXPECT_GE(seen, value * (1 - 1e-6));
    EXPECT_LE(seen, value * std::exp2(1.0 / kCanLogStepsPerOctave) * (1 + 1e-9));
    EXPECT_DOUBLE_EQ(through_wire(sigma, seen), seen) << "passing it on adds nothing";
  }
  EXPECT_EQ(raw_of(sigma, 1e9), 254U);
  EXPECT_EQ(raw_of(sigma, kCanUnknown), 255U);
  EXPECT_EQ(raw_of(sigma, 0.0), 0U);
}

TEST(CanCodec, Binary16OfAVarianceIsTheNextLargerNumber) {
  EXPECT_EQ(half_from(1.0), 0x3C00);
  EXPECT_EQ(half_from(65504.0), 0x7BFF);
  EXPECT_EQ(half_from(65505.0), 0x7C00) << "infinity";
  EXPECT_EQ(half_from(std::ldexp(1.0, -24)), 0x0001) << "least subnormal";
  EXPECT_EQ(half_from(1e-30), 0x0001) << "not zero: a variance is never understated";
  EXPECT_TRUE(std::isnan(half_value(half_from(-1.0))));
  for (int code = 0; code < 0x7C00; ++code) {
    const auto half = static_cast<std::uint16_t>(code);
    EXPECT_EQ(half_from(half_value(half)), half);
    const double between = 0.5 * (half_value(half) + half_value(static_cast<std::uint16_t>(code + 1)));
    if (code == 0x7BFF) continue;  // the next is infinity
    EXPECT_EQ(half_from(between), code + 1);
  }
}

TEST(CanCodec, FramesOfASetShareCounterAndState) {
  CanEstimate estimate;
  estimate.state = VisionState::degraded;
  for (const CanTransport transport : {CanTransport::classic, CanTransport::fd}) {
    const CanSet set = encode_set(estimate, {.transport = transport, .counter = 0x1234B, .with_slow = true});
    EXPECT_EQ(set.size, transport == CanTransport::fd ? 2 : 10);
    for (const CanFrame& frame : set) {
      CanEstimate seen;
      const CanDecoded decoded = decode_frame(frame, kCanDefaultBaseId, seen);
      EXPECT_EQ(decoded.outcome, CanDecodeOutcome::ok);
      EXPECT_EQ(decoded.counter, transport == CanTransport::fd ? 0x4BU : 0xBU);
      EXPECT_EQ(seen.state, VisionState::degraded);
    }
  }
}

TEST(CanCodec, AnUnknownEstimateSendsOnlyInvalidFields) {
  for (const CanTransport transport : {CanTransport::classic, CanTransport::fd}) {
    for (const CanFrame& frame : encode_set({}, {.transport = transport, .with_slow = true})) {
      CanEstimate seen;
      const CanDecoded decoded = decode_frame(frame, kCanDefaultBaseId, seen);
      for (const CanSignal& signal : decoded.spec->signals) {
        if (signal.field == nullptr || signal.beyond == CanBeyond::wraps) continue;
        EXPECT_TRUE(std::isnan(seen.*signal.field)) << decoded.spec->name << " " << signal.name;
      }
    }
  }
}

// What CRC-8 0x2F was chosen for: no change of up to three bits of a frame goes unseen.
TEST(CanCodec, EveryChangeOfUpToThreeBitsIsRefused) {
  CanEstimate estimate;
  estimate.vel_x_mps = 1.234;
  const CanFrame good = encode_frame(can_frame_spec(CanFrameKind::velocity), estimate, kCanDefaultBaseId, 5);
  const auto refused = [&](int a, int b, int c) {
    CanFrame bad = good;
    for (const int bit : {a, b, c}) {
      if (bit >= 0) bad.bytes[static_cast<std::size_t>(bit / 8)] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    }
    CanEstimate untouched;
    return decode_frame(bad, kCanDefaultBaseId, untouched).outcome == CanDecodeOutcome::bad_crc &&
           std::isnan(untouched.vel_x_mps);
  };
  int missed = 0;
  for (int a = 0; a < 64; ++a) {
    missed += refused(a, -1, -1) ? 0 : 1;
    for (int b = a + 1; b < 64; ++b) {
      missed += refused(a, b, -1) ? 0 : 1;
      for (int c = b + 1; c < 64; ++c) missed += refused(a, b, c) ? 0 : 1;
    }
  }
  EXPECT_EQ(missed, 0);
}

TEST(CanCodec, AFrameUnderAnotherIdentifierOfTheContractIsRefused) {
  for (const CanFrame& frame : encode_set({}, {.with_slow = true})) {
    for (std::uint32_t offset = 0; offset < 10; ++offset) {
      CanFrame moved = frame;
      moved.id = kCanDefaultBaseId + offset;
      if (moved.id == frame.id) continue;
      CanEstimate seen;
      EXPECT_EQ(decode_frame(moved, kCanDefaultBaseId, seen).outcome, CanDecodeOutcome::bad_crc);
    }
  }
}

TEST(CanCodec, ForeignFramesAreNotOurs) {
  CanFrame frame = encode_set({}, {}).frames[0];
  CanEstimate seen;
  frame.extended = true;
  EXPECT_EQ(decode_frame(frame, kCanDefaultBaseId, seen).outcome, CanDecodeOutcome::not_ours);
  frame.extended = false;
  frame.id = kCanDefaultBaseId - 1;
  EXPECT_EQ(decode_frame(frame, kCanDefaultBaseId, seen).outcome, CanDecodeOutcome::not_ours);
  frame.id = kCanDefaultBaseId + kCanIdsUsed;
  EXPECT_EQ(decode_frame(frame, kCanDefaultBaseId, seen).outcome, CanDecodeOutcome::not_ours);
  frame.id = kCanDefaultBaseId;
  frame.type = CanFrameType::remote;
  EXPECT_EQ(decode_frame(frame, kCanDefaultBaseId, seen).outcome, CanDecodeOutcome::not_ours);
  frame.type = CanFrameType::data;
  frame.size = 7;
  EXPECT_EQ(decode_frame(frame, kCanDefaultBaseId, seen).outcome, CanDecodeOutcome::bad_size);
}

}  // namespace
}  // namespace pelorus
