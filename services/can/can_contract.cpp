#include "services/can/can_contract.h"

#include <array>
#include <cstddef>

namespace pelorus {
namespace {

using E = CanEstimate;

constexpr CanSignal crc8() {
  return {"CRC",
          0,
          8,
          CanCoding::crc,
          1,
          "",
          CanBeyond::wraps,
          nullptr,
          "CRC-8, polynomial 0x2F, start 0xFF, inverted, over the data id and bytes 1..7"};
}
constexpr CanSignal counter4() {
  return {"COUNTER",          8,       4,
          CanCoding::counter, 1,       "",
          CanBeyond::wraps,   nullptr, "Number of the estimate modulo 16, equal in all frames of a set"};
}
constexpr CanSignal state4() {
  return {"STATE", 12, 4, CanCoding::state, 1, "", CanBeyond::wraps, nullptr, "State of the vision system"};
}
constexpr CanSignal crc16() {
  return {"CRC",
          0,
          16,
          CanCoding::crc,
          1,
          "",
          CanBeyond::wraps,
          nullptr,
          "CRC-16, polynomial 0x1021, start 0xFFFF, over the data id (low byte first) and all bytes from 2 on"};
}
constexpr CanSignal counter8() {
  return {"COUNTER", 16, 8, CanCoding::counter, 1, "", CanBeyond::wraps, nullptr, "Number of the estimate modulo 256"};
}
constexpr CanSignal fd_state4() {
  return {"STATE", 24, 4, CanCoding::state, 1, "", CanBeyond::wraps, nullptr, "State of the vision system"};
}

// The common shapes of a signal, at a byte.
constexpr CanSignal int16(const char* name, int byte, double scale, const char* unit, double E::*field,
                          const char* meaning) {
  return {name, 8 * byte, 16, CanCoding::signed_integer, scale, unit, CanBeyond::invalid, field, meaning};
}
constexpr CanSignal int16_or_more(const char* name, int byte, double scale, const char* unit, double E::*field,
                                  const char* meaning) {
  return {name, 8 * byte, 16, CanCoding::signed_integer, scale, unit, CanBeyond::saturate, field, meaning};
}
constexpr CanSignal int24(const char* name, int byte, double scale, const char* unit, double E::*field,
                          const char* meaning) {
  return {name, 8 * byte, 24, CanCoding::signed_integer, scale, unit, CanBeyond::invalid, field, meaning};
}
constexpr CanSignal count8(const char* name, int byte, const char* unit, CanBeyond beyond, double E::*field,
                           const char* meaning) {
  return {name, 8 * byte, 8, CanCoding::unsigned_integer, 1, unit, beyond, field, meaning};
}
constexpr CanSignal sigma(const char* name, int byte, double scale, const char* unit, double E::*field,
                          const char* meaning) {
  return {name, 8 * byte, 8, CanCoding::log_sigma, scale, unit, CanBeyond::saturate, field, meaning};
}
constexpr CanSignal half(const char* name, int byte, const char* unit, double E::*field, const char* meaning) {
  return {name, 8 * byte, 16, CanCoding::float16, 1, unit, CanBeyond::saturate, field, meaning};
}
constexpr CanSignal single(const char* name, int byte, const char* unit, double E::*field, const char* meaning) {
  return {name, 8 * byte, 32, CanCoding::float32, 1, unit, CanBeyond::invalid, field, meaning};
}
constexpr CanSignal bits(const char* name, int byte, int count, double E::*field, const char* meaning) {
  return {name, 8 * byte, count, CanCoding::unsigned_integer, 1, "", CanBeyond::wraps, field, meaning};
}

constexpr const char* kVx =
    "Speed of the body origin through the static scene, + forward; constant over the last frame interval";
constexpr const char* kVy = "Speed of the body origin, + to starboard; constant over the last frame interval";
constexpr const char* kVz = "Speed of the body origin, + down; constant over the last frame interval";
constexpr const char* kRoll =
    "Roll since start, + starboard side down; relative to the attitude at start, NOT to gravity";
constexpr const char* kPitch = "Pitch since start, + bow up; relative to the attitude at start, NOT to gravity";
constexpr const char* kYaw = "Yaw since start, + bow to starboard; relative to the heading at start, NOT to north";
constexpr const char* kDx =
    "Way during INTERVAL, + forward in the body axes at its beginning; use only when COUNTER went up by exactly 1 "
    "since an "
    "estimate with QUALITY > 0";
constexpr const char* kDy = "Way during INTERVAL, + to starboard in the body axes at its beginning";
constexpr const char* kDz = "Way during INTERVAL, + down in the body axes at its beginning";
constexpr const char* kInterval =
    "Time that DX DY DZ span, up to this measurement: since the estimate with COUNTER - 1 if it had QUALITY > 0";
constexpr const char* kLatency = "Declared latency from mid-exposure to sending: the autopilot's delay parameter";
constexpr const char* kBodies = "Moving bodies tracked now; 254 or more: 254";
constexpr const char* kBearing = "Nearest moving body seen from the body origin: + to starboard of the bow";
constexpr const char* kElevation = "Nearest moving body: + above the body's x-y plane";
constexpr const char* kRange = "Nearest moving body: distance of its center from the body origin";
constexpr const char* kClosing =
    "Nearest moving body: speed at which RANGE shrinks, + coming nearer; mean over the last frame interval";
constexpr const char* kConfidence =
    "Nearest moving body: n/(n+10) for n points that move as it does, half while coasting";
constexpr const char* kObjectId = "Nearest moving body: its identity modulo 255; a change is another body";
constexpr const char* kPhase = "Nearest moving body: seen now, or extrapolated through an occlusion";
constexpr const char* kQuality = "0 no valid estimate, 1 worst .. 100 best";
constexpr const char* kResets =
    "Goes up by one after each loss of tracking: position and attitude may have jumped, do not difference across it";
constexpr const char* kAge =
    "Time from mid-exposure of the measurement to the sending of this set; 3.2767 or more: 3.2767";
constexpr const char* kSigmaAtt = "One standard deviation of the attitude, worst axis; grows with the dive";
constexpr const char* kX = "Position since start, + along the bow at start; drifts with the dive";
constexpr const char* kY = "Position since start, + to starboard at start";
constexpr const char* kZ = "Position since start, + down at start (body z then, NOT gravity)";
constexpr const char* kCalibration = "Hash of the calibration in force; 0 = not told";
constexpr const char* kVersion = "Version of this contract";
constexpr const char* kDropped = "Estimates dropped by the sender because an older one was still waiting for the bus";

constexpr std::array kVelocity{crc8(),
                               counter4(),
                               state4(),
                               int16("VX", 2, 0.001, "m/s", &E::vel_x_mps, kVx),
                               int16("VY", 4, 0.001, "m/s", &E::vel_y_mps, kVy),
                               int16("VZ", 6, 0.001, "m/s", &E::vel_z_mps, kVz)};

constexpr std::array kAttitude{crc8(),
                               counter4(),
                               state4(),
                               int16("ROLL", 2, 0.0001, "rad", &E::roll_rad, kRoll),
                               int16("PITCH", 4, 0.0001, "rad", &E::pitch_rad, kPitch),
                               int16("YAW", 6, 0.0001, "rad", &E::yaw_rad, kYaw)};

constexpr std::array kStep{crc8(),
                           counter4(),
                           state4(),
                           int16("DX", 2, 0.0001, "m", &E::step_x_m, kDx),
                           int16("DY", 4, 0.0001, "m", &E::step_y_m, kDy),
                           int16("DZ", 6, 0.0001, "m", &E::step_z_m, kDz)};

constexpr std::array kTiming{
    crc8(),
    counter4(),
    state4(),
    int16("INTERVAL", 2, 0.0001, "s", &E::interval_s, kInterval),
    int16("LATENCY", 4, 0.0001, "s", &E::latency_s, kLatency),
    sigma("SIGMA_STEP", 6, 1e-5, "m", &E::sigma_step_m, "One standard deviation of DX DY DZ, worst axis"),
    count8("BODIES", 7, "", CanBeyond::saturate, &E::bodies, kBodies)};

constexpr std::array kObject{crc8(),
                             counter4(),
                             state4(),
                             int16("BEARING", 2, 0.0001, "rad", &E::object_bearing_rad, kBearing),
                             int16("ELEVATION", 4, 0.0001, "rad", &E::object_elevation_rad, kElevation),
                             int16("RANGE", 6, 0.01, "m", &E::object_range_m, kRange)};

constexpr std::array kObjectRate{
    crc8(),
    counter4(),
    state4(),
    int16("CLOSING", 2, 0.001, "m/s", &E::object_closing_mps, kClosing),
    count8("CONFIDENCE", 4, "%", CanBeyond::invalid, &E::object_confidence_percent, kConfidence),
    count8("ID", 5, "", CanBeyond::invalid, &E::object_id, kObjectId),
    count8("POINTS", 6, "", CanBeyond::saturate, &E::object_points,
           "Nearest moving body: points that support its motion now; 254 or more: 254"),
    count8("PHASE", 7, "", CanBeyond::invalid, &E::object_phase, kPhase)};

constexpr std::array kPositionXy{crc8(), counter4(), state4(), int24("X", 2, 0.01, "m", &E::position_x_m, kX),
                                 int24("Y", 5, 0.01, "m", &E::position_y_m, kY)};

constexpr std::array kPositionZ{crc8(),
                                counter4(),
                                state4(),
                                int24("Z", 2, 0.01, "m", &E::position_z_m, kZ),
                                sigma("SIGMA_POS", 5, 1e-3, "m", &E::sigma_position_m,
                                      "One standard deviation of X Y Z, worst axis; grows with the dive"),
                                bits("DROPPED", 6, 16, &E::sets_dropped, kDropped)};

constexpr std::array kNode{crc8(), counter4(), state4(), bits("CALIBRATION", 2, 32, &E::calibration_hash, kCalibration),
                           bits("VERSION", 6, 8, &E::contract_version, kVersion)};

constexpr std::array kQualityFrame{
    crc8(),
    counter4(),
    state4(),
    count8("QUALITY", 2, "%", CanBeyond::invalid, &E::quality_percent, kQuality),
    count8("RESETS", 3, "", CanBeyond::wraps, &E::resets, kResets),
    int16_or_more("AGE", 4, 0.0001, "s", &E::age_s, kAge),
    sigma("SIGMA_VEL", 6, 1e-4, "m/s", &E::sigma_vel_mps, "One standard deviation of VX VY VZ, worst axis"),
    sigma("SIGMA_ATT", 7, 1e-5, "rad", &E::sigma_att_rad, kSigmaAtt)};

constexpr std::array kFdSlow{crc16(),
                             counter8(),
                             fd_state4(),
                             single("X", 4, "m", &E::position_x_m, kX),
                             single("Y", 8, "m", &E::position_y_m, kY),
                             single("Z", 12, "m", &E::position_z_m, kZ),
                             bits("CALIBRATION", 16, 32, &E::calibration_hash, kCalibration),
                             int16("LATENCY", 20, 0.0001, "s", &E::latency_s, kLatency),
                             sigma("SIGMA_POS", 22, 1e-3, "m", &E::sigma_position_m,
                                   "One standard deviation of X Y Z, worst axis; grows with the dive"),
                             bits("VERSION", 23, 8, &E::contract_version, kVersion),
                             bits("DROPPED", 24, 16, &E::sets_dropped, kDropped)};

// Finer than in VIS_TIME: an FD receiver divides the way by it.
constexpr CanSignal fine_interval(int byte) {
  return {"INTERVAL",         8 * byte,       16,       CanCoding::unsigned_integer, 0.00002, "s",
          CanBeyond::invalid, &E::interval_s, kInterval};
}
constexpr CanSignal phase_of_fd() {
  return {"PHASE", 28, 4, CanCoding::unsigned_integer, 1, "", CanBeyond::invalid, &E::object_phase, kPhase};
}

// Variances in mm^2 and mrad^2: those of a step of a tenth of a millimeter would vanish in binary16 as m^2.
constexpr std::array kFd{
    crc16(),
    counter8(),
    fd_state4(),
    phase_of_fd(),
    int16_or_more("AGE", 4, 0.0001, "s", &E::age_s, kAge),
    fine_interval(6),
    count8("QUALITY", 8, "%", CanBeyond::invalid, &E::quality_percent, kQuality),
    count8("RESETS", 9, "", CanBeyond::wraps, &E::resets, kResets),
    single("DX", 10, "m", &E::step_x_m, kDx),
    single("DY", 14, "m", &E::step_y_m, kDy),
    single("DZ", 18, "m", &E::step_z_m, kDz),
    single("RX", 22, "rad", &E::turn_x_rad, "Rotation vector of R_prev_curr during INTERVAL, + rolls starboard down"),
    single("RY", 26, "rad", &E::turn_y_rad, "Rotation vector of R_prev_curr during INTERVAL, + pitches bow up"),
    single("RZ", 30, "rad", &E::turn_z_rad, "Rotation vector of R_prev_curr during INTERVAL, + yaws to starboard"),
    half("VAR_DX", 34, "mm^2", &E::step_var_x_mm2, "Variance of DX"),
    half("VAR_DY", 36, "mm^2", &E::step_var_y_mm2, "Variance of DY"),
    half("VAR_DZ", 38, "mm^2", &E::step_var_z_mm2, "Variance of DZ"),
    half("VAR_RX", 40, "mrad^2", &E::turn_var_x_mrad2, "Variance of RX"),
    half("VAR_RY", 42, "mrad^2", &E::turn_var_y_mrad2, "Variance of RY"),
    half("VAR_RZ", 44, "mrad^2", &E::turn_var_z_mrad2, "Variance of RZ"),
    int16("ROLL", 46, 0.0001, "rad", &E::roll_rad, kRoll),
    int16("PITCH", 48, 0.0001, "rad", &E::pitch_rad, kPitch),
    int16("YAW", 50, 0.0001, "rad", &E::yaw_rad, kYaw),
    int16("BEARING", 52, 0.0001, "rad", &E::object_bearing_rad, kBearing),
    int16("ELEVATION", 54, 0.0001, "rad", &E::object_elevation_rad, kElevation),
    int16("RANGE", 56, 0.01, "m", &E::object_range_m, kRange),
    int16("CLOSING", 58, 0.001, "m/s", &E::object_closing_mps, kClosing),
    count8("CONFIDENCE", 60, "%", CanBeyond::invalid, &E::object_confidence_percent, kConfidence),
    count8("ID", 61, "", CanBeyond::invalid, &E::object_id, kObjectId),
    sigma("SIGMA_ATT", 62, 1e-5, "rad", &E::sigma_att_rad, kSigmaAtt),
    count8("BODIES", 63, "", CanBeyond::saturate, &E::bodies, kBodies)};

using Kind = CanFrameKind;
constexpr auto kEvery = CanCadence::every_set;
constexpr auto kSlow = CanCadence::slow;
constexpr std::array<CanFrameSpec, kCanIdsUsed> kContract{{
    {Kind::velocity, "VIS_VEL", 0, 0xA0, 8, false, kEvery, "Velocity of the vehicle", kVelocity},
    {Kind::attitude, "VIS_ATT", 1, 0xA1, 8, false, kEvery, "Attitude since start, order yaw pitch roll", kAttitude},
    {Kind::step, "VIS_POS", 2, 0xA2, 8, false, kEvery, "Way during INTERVAL", kStep},
    {Kind::timing, "VIS_TIME", 3, 0xA3, 8, false, kEvery, "Length of the step, declared latency", kTiming},
    {Kind::object, "VIS_OBJ", 4, 0xA4, 8, false, kEvery, "Nearest moving body: where", kObject},
    {Kind::object_rate, "VIS_OBJ_RATE", 5, 0xA5, 8, false, kEvery, "Nearest moving body: how sure", kObjectRate},
    {Kind::position_xy, "VIS_ABS_XY", 6, 0xA6, 8, false, kSlow, "Position since start", kPositionXy},
    {Kind::position_z, "VIS_ABS_Z", 7, 0xA7, 8, false, kSlow, "Position since start, its deviation", kPositionZ},
    {Kind::node, "VIS_NODE", 8, 0xA8, 8, false, kSlow, "Who is speaking", kNode},
    {Kind::quality, "VIS_QUAL", 9, 0xA9, 8, false, kEvery, "Quality and age; closes the set", kQualityFrame},
    {Kind::fd_slow, "VIS_FD_SLOW", 10, 0x50AA, 32, true, kSlow, "Position since start, who is speaking", kFdSlow},
    {Kind::fd, "VIS_FD", 11, 0x50AB, 64, true, kEvery, "A whole estimate in one CAN FD frame", kFd},
}};

}  // namespace

std::span<const CanFrameSpec> can_contract() { return kContract; }

const CanFrameSpec& can_frame_spec(CanFrameKind kind) { return kContract[static_cast<std::size_t>(kind)]; }

}  // namespace pelorus
