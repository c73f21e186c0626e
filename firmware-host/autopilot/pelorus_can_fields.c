/* From the bytes of a complete set to numbers. Places and scales come from the generated pelorus_can_contract.h. */
#include "pelorus_can_fields.h"

#include <string.h>

#define BIT(offset) (UINT32_C(1) << (offset))
#define CLASSIC(rx, frame) ((rx)->classic[PELORUS_CAN_##frame##_OFFSET])
#define NOT_KNOWN 255u /* of an 8-bit field */

/* Bit patterns instead of float comparisons: these hold under -ffast-math too. */
static float float_of(uint32_t bits) {
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static float not_a_number(void) { return float_of(UINT32_C(0x7FC00000)); }

static uint32_t u16_at(const uint8_t* p) { return (uint32_t)p[0] | (uint32_t)p[1] << 8; }
static uint32_t u32_at(const uint8_t* p) { return u16_at(p) | u16_at(p + 2) << 16; }

static bool read_i16(const uint8_t* p, float scale, float* out) {
  const int32_t raw = (int32_t)u16_at(p);
  if (raw == 0x8000) return false;
  *out = (float)(raw > 0x8000 ? raw - 0x10000 : raw) * scale;
  return true;
}

static bool read_i24(const uint8_t* p, float scale, float* out) {
  const int32_t raw = (int32_t)(u16_at(p) | (uint32_t)p[2] << 16);
  if (raw == 0x800000) return false;
  *out = (float)(raw > 0x800000 ? raw - 0x1000000 : raw) * scale;
  return true;
}

static bool read_f32(const uint8_t* p, float* out) {
  const uint32_t bits = u32_at(p);
  if ((bits & UINT32_C(0x7F800000)) == UINT32_C(0x7F800000)) return false; /* infinite or no number */
  *out = float_of(bits);
  return true;
}

/* binary16, not negative: a variance. */
static bool read_f16(const uint8_t* p, float scale, float* out) {
  const uint32_t half = u16_at(p);
  const uint32_t exponent = half >> 10;
  const uint32_t mantissa = half & 0x3FFu;
  if (exponent >= 0x1F) return false; /* infinite, no number, or negative */
  *out = exponent == 0 ? (float)mantissa * (1.0f / 16777216.0f) : float_of((exponent + 112u) << 23 | mantissa << 13);
  *out *= scale;
  return true;
}

/* scale * 2^(raw / 16), squared. */
static bool read_variance(uint8_t raw, float scale, float* out) {
  static const float root[16] = {1.0f,        1.04427378f, 1.09050773f, 1.13878863f, 1.18920712f, 1.24185781f,
                                 1.29683955f, 1.35425555f, 1.41421356f, 1.47682615f, 1.54221083f, 1.61049033f,
                                 1.68179283f, 1.75625216f, 1.83400809f, 1.91520656f};
  if (raw == NOT_KNOWN) return false;
  const float sigma = scale * root[raw & 15] * (float)(UINT32_C(1) << (raw >> 4));
  *out = sigma * sigma;
  return true;
}

static bool read_3_i16(const uint8_t* p, float scale, float out[3]) {
  float v[3];
  if (!read_i16(p, scale, v) || !read_i16(p + 2, scale, v + 1) || !read_i16(p + 4, scale, v + 2)) return false;
  memcpy(out, v, sizeof v);
  return true;
}

static bool read_3_f32(const uint8_t* p, float out[3]) {
  float v[3];
  if (!read_f32(p, v) || !read_f32(p + 4, v + 1) || !read_f32(p + 8, v + 2)) return false;
  memcpy(out, v, sizeof v);
  return true;
}

static bool read_3_f16(const uint8_t* p, float scale, float out[3]) {
  float v[3];
  if (!read_f16(p, scale, v) || !read_f16(p + 2, scale, v + 1) || !read_f16(p + 4, scale, v + 2)) return false;
  memcpy(out, v, sizeof v);
  return true;
}

static void fill(float* out, int count, float value) {
  for (int i = 0; i < count; ++i) out[i] = value;
}

/* Nothing known. */
static void clear(pelorus_can_estimate* e) {
  const float nan = not_a_number();
  memset(e, 0, sizeof *e);
  e->interval_s = e->roll_rad = e->pitch_rad = e->yaw_rad = e->attitude_variance_rad2 = nan;
  e->body_bearing_rad = e->body_elevation_rad = e->body_range_m = e->body_closing_mps = nan;
  e->position_variance_m2 = e->latency_s = nan;
  fill(e->velocity_mps, 3, nan);
  fill(e->velocity_variance_m2ps2, 3, nan);
  fill(e->step_m, 3, nan);
  fill(e->step_variance_m2, 3, nan);
  fill(e->turn_rad, 3, nan);
  fill(e->turn_variance_rad2, 3, nan);
  fill(e->position_m, 3, nan);
  e->bodies = e->body_confidence_percent = NOT_KNOWN;
}

static void read_age(pelorus_can_estimate* e, const uint8_t* p, uint32_t us_per_step) {
  const uint32_t raw = u16_at(p);
  if (raw >= 0x8000u) return; /* not known, or from the future */
  e->age_us = raw * us_per_step;
  e->valid |= PELORUS_CAN_AGE;
  e->measured_us = e->received_us > e->age_us ? e->received_us - e->age_us : 0;
}

/* An estimate vouches for its numbers only in a state that has some, with a quality and an age. */
static bool is_usable(const pelorus_can_estimate* e) {
  const bool good = e->state == PELORUS_CAN_STATE_TRACKING || e->state == PELORUS_CAN_STATE_DEGRADED;
  return good && (e->valid & PELORUS_CAN_AGE) && e->quality >= 1 && e->quality <= 100;
}

static void mark(pelorus_can_estimate* e, bool known, uint32_t bit) {
  if (known) e->valid |= bit;
}

static void read_attitude(pelorus_can_estimate* e, const uint8_t* roll_pitch_yaw, uint8_t sigma) {
  float angles[3];
  if (!read_3_i16(roll_pitch_yaw, PELORUS_CAN_ATT_ROLL_SCALE, angles)) return;
  if (!read_variance(sigma, PELORUS_CAN_QUAL_SIGMA_ATT_SCALE, &e->attitude_variance_rad2)) return;
  e->roll_rad = angles[0];
  e->pitch_rad = angles[1];
  e->yaw_rad = angles[2];
  e->valid |= PELORUS_CAN_ATTITUDE;
}

static void read_body(pelorus_can_estimate* e, const uint8_t* bearing_elevation_range, const uint8_t* closing) {
  const uint8_t* p = bearing_elevation_range;
  float at[3];
  const bool known = read_i16(p, PELORUS_CAN_OBJ_BEARING_SCALE, at) &&
                     read_i16(p + 2, PELORUS_CAN_OBJ_ELEVATION_SCALE, at + 1) &&
                     read_i16(p + 4, PELORUS_CAN_OBJ_RANGE_SCALE, at + 2);
  if (!known) return;
  e->body_bearing_rad = at[0];
  e->body_elevation_rad = at[1];
  e->body_range_m = at[2];
  e->valid |= PELORUS_CAN_BODY;
  mark(e, read_i16(closing, PELORUS_CAN_OBJ_RATE_CLOSING_SCALE, &e->body_closing_mps), PELORUS_CAN_BODY_CLOSING);
}

static void read_classic_motion(const pelorus_can_receiver* rx, pelorus_can_estimate* e, bool step_usable) {
  const uint8_t* velocity = CLASSIC(rx, VEL) + PELORUS_CAN_VEL_VX_BYTE;
  const uint8_t* way = CLASSIC(rx, POS) + PELORUS_CAN_POS_DX_BYTE;
  float variance;
  mark(e, read_i16(CLASSIC(rx, TIME) + PELORUS_CAN_TIME_INTERVAL_BYTE, PELORUS_CAN_TIME_INTERVAL_SCALE, &e->interval_s),
       PELORUS_CAN_INTERVAL);
  if (read_variance(CLASSIC(rx, QUAL)[PELORUS_CAN_QUAL_SIGMA_VEL_BYTE], PELORUS_CAN_QUAL_SIGMA_VEL_SCALE, &variance) &&
      read_3_i16(velocity, PELORUS_CAN_VEL_VX_SCALE, e->velocity_mps)) {
    fill(e->velocity_variance_m2ps2, 3, variance);
    e->valid |= PELORUS_CAN_VELOCITY;
  }
  if (step_usable &&
      read_variance(CLASSIC(rx, TIME)[PELORUS_CAN_TIME_SIGMA_STEP_BYTE], PELORUS_CAN_TIME_SIGMA_STEP_SCALE,
                    &variance) &&
      read_3_i16(way, PELORUS_CAN_POS_DX_SCALE, e->step_m)) {
    fill(e->step_variance_m2, 3, variance);
    e->valid |= PELORUS_CAN_STEP;
  }
}

static void read_classic_position(const pelorus_can_receiver* rx, pelorus_can_estimate* e) {
  const uint32_t both = BIT(PELORUS_CAN_ABS_XY_OFFSET) | BIT(PELORUS_CAN_ABS_Z_OFFSET);
  float at[3];
  if ((rx->pending & both) != both) return;
  if (!read_i24(CLASSIC(rx, ABS_XY) + PELORUS_CAN_ABS_XY_X_BYTE, PELORUS_CAN_ABS_XY_X_SCALE, at) ||
      !read_i24(CLASSIC(rx, ABS_XY) + PELORUS_CAN_ABS_XY_Y_BYTE, PELORUS_CAN_ABS_XY_Y_SCALE, at + 1) ||
      !read_i24(CLASSIC(rx, ABS_Z) + PELORUS_CAN_ABS_Z_Z_BYTE, PELORUS_CAN_ABS_Z_Z_SCALE, at + 2) ||
      !read_variance(CLASSIC(rx, ABS_Z)[PELORUS_CAN_ABS_Z_SIGMA_POS_BYTE], PELORUS_CAN_ABS_Z_SIGMA_POS_SCALE,
                     &e->position_variance_m2)) {
    return;
  }
  memcpy(e->position_m, at, sizeof at);
  e->valid |= PELORUS_CAN_POSITION;
}

static void read_classic(const pelorus_can_receiver* rx, pelorus_can_estimate* e, bool step_usable) {
  e->quality = CLASSIC(rx, QUAL)[PELORUS_CAN_QUAL_QUALITY_BYTE];
  e->resets = CLASSIC(rx, QUAL)[PELORUS_CAN_QUAL_RESETS_BYTE];
  read_age(e, CLASSIC(rx, QUAL) + PELORUS_CAN_QUAL_AGE_BYTE, PELORUS_CAN_QUAL_AGE_US);
  (void)read_i16(CLASSIC(rx, TIME) + PELORUS_CAN_TIME_LATENCY_BYTE, PELORUS_CAN_TIME_LATENCY_SCALE, &e->latency_s);
  if (rx->pending & BIT(PELORUS_CAN_NODE_OFFSET)) {
    e->calibration_hash = u32_at(CLASSIC(rx, NODE) + PELORUS_CAN_NODE_CALIBRATION_BYTE);
    e->version = CLASSIC(rx, NODE)[PELORUS_CAN_NODE_VERSION_BYTE];
    e->valid |= PELORUS_CAN_NODE;
  }
  if (rx->pending & BIT(PELORUS_CAN_ABS_Z_OFFSET)) {
    e->sender_dropped = (uint16_t)u16_at(CLASSIC(rx, ABS_Z) + PELORUS_CAN_ABS_Z_DROPPED_BYTE);
  }
  if (!is_usable(e)) return;
  read_classic_motion(rx, e, step_usable);
  read_attitude(e, CLASSIC(rx, ATT) + PELORUS_CAN_ATT_ROLL_BYTE, CLASSIC(rx, QUAL)[PELORUS_CAN_QUAL_SIGMA_ATT_BYTE]);
  read_classic_position(rx, e);
  e->bodies = CLASSIC(rx, TIME)[PELORUS_CAN_TIME_BODIES_BYTE];
  e->body_confidence_percent = CLASSIC(rx, OBJ_RATE)[PELORUS_CAN_OBJ_RATE_CONFIDENCE_BYTE];
  e->body_id = CLASSIC(rx, OBJ_RATE)[PELORUS_CAN_OBJ_RATE_ID_BYTE];
  e->body_phase = CLASSIC(rx, OBJ_RATE)[PELORUS_CAN_OBJ_RATE_PHASE_BYTE];
  read_body(e, CLASSIC(rx, OBJ) + PELORUS_CAN_OBJ_BEARING_BYTE,
            CLASSIC(rx, OBJ_RATE) + PELORUS_CAN_OBJ_RATE_CLOSING_BYTE);
}

/* VIS_FD carries no velocity: it is the constant twist that makes this way d and turn r in the interval,
 * v = J(r)^-1 d / dt with J^-1 = sum of B_n / n! [r]x^n (Barfoot 2017, 7.1.5). Up to n = 8: exact to a float for turns
 * up to one radian. */
static void derive_velocity(pelorus_can_estimate* e) {
  static const float b[9] = {1.0f, -0.5f, 1.0f / 12, 0, -1.0f / 720, 0, 1.0f / 30240, 0, -1.0f / 1209600};
  const float* r = e->turn_rad;
  float term[3];
  float way[3] = {0, 0, 0};
  if (!(e->valid & PELORUS_CAN_INTERVAL)) return;
  memcpy(term, e->step_m, sizeof term);
  for (int n = 0; n < 9; ++n) {
    const float cross[3] = {r[1] * term[2] - r[2] * term[1], r[2] * term[0] - r[0] * term[2],
                            r[0] * term[1] - r[1] * term[0]};
    for (int i = 0; i < 3; ++i) way[i] += b[n] * term[i];
    memcpy(term, cross, sizeof term);
  }
  for (int i = 0; i < 3; ++i) {
    e->velocity_mps[i] = way[i] / e->interval_s;
    e->velocity_variance_m2ps2[i] = e->step_variance_m2[i] / (e->interval_s * e->interval_s);
  }
  e->valid |= PELORUS_CAN_VELOCITY;
}

static void read_fd_motion(pelorus_can_estimate* e, const uint8_t* p, bool step_usable) {
  const uint32_t interval = u16_at(p + PELORUS_CAN_FD_INTERVAL_BYTE);
  const bool known = read_3_f16(p + PELORUS_CAN_FD_VAR_DX_BYTE, 1e-6f, e->step_variance_m2) &&
                     read_3_f16(p + PELORUS_CAN_FD_VAR_RX_BYTE, 1e-6f, e->turn_variance_rad2) &&
                     read_3_f32(p + PELORUS_CAN_FD_DX_BYTE, e->step_m) &&
                     read_3_f32(p + PELORUS_CAN_FD_RX_BYTE, e->turn_rad);
  if (interval > 0 && interval < 0xFFFFu) {
    e->interval_s = (float)interval * PELORUS_CAN_FD_INTERVAL_SCALE;
    e->valid |= PELORUS_CAN_INTERVAL;
  }
  if (known) derive_velocity(e);
  if (known && step_usable) {
    e->valid |= PELORUS_CAN_STEP | PELORUS_CAN_TURN;
    return;
  }
  fill(e->step_m, 3, not_a_number());
  fill(e->turn_rad, 3, not_a_number());
  fill(e->step_variance_m2, 3, not_a_number());
  fill(e->turn_variance_rad2, 3, not_a_number());
}

static void read_fd_slow(const pelorus_can_receiver* rx, pelorus_can_estimate* e) {
  const uint8_t* p = rx->fd_slow;
  if (!(rx->pending & BIT(PELORUS_CAN_FD_SLOW_OFFSET))) return;
  e->calibration_hash = u32_at(p + PELORUS_CAN_FD_SLOW_CALIBRATION_BYTE);
  e->version = p[PELORUS_CAN_FD_SLOW_VERSION_BYTE];
  e->sender_dropped = (uint16_t)u16_at(p + PELORUS_CAN_FD_SLOW_DROPPED_BYTE);
  e->valid |= PELORUS_CAN_NODE;
  (void)read_i16(p + PELORUS_CAN_FD_SLOW_LATENCY_BYTE, PELORUS_CAN_FD_SLOW_LATENCY_SCALE, &e->latency_s);
  mark(e,
       is_usable(e) && p[PELORUS_CAN_FD_SLOW_SIGMA_POS_BYTE] != NOT_KNOWN &&
           read_3_f32(p + PELORUS_CAN_FD_SLOW_X_BYTE, e->position_m) &&
           read_variance(p[PELORUS_CAN_FD_SLOW_SIGMA_POS_BYTE], PELORUS_CAN_FD_SLOW_SIGMA_POS_SCALE,
                         &e->position_variance_m2),
       PELORUS_CAN_POSITION);
}

static void read_fd(const pelorus_can_receiver* rx, pelorus_can_estimate* e, bool step_usable) {
  const uint8_t* p = rx->fd;
  e->quality = p[PELORUS_CAN_FD_QUALITY_BYTE];
  e->resets = p[PELORUS_CAN_FD_RESETS_BYTE];
  read_age(e, p + PELORUS_CAN_FD_AGE_BYTE, PELORUS_CAN_FD_AGE_US);
  read_fd_slow(rx, e);
  if (!is_usable(e)) return;
  read_fd_motion(e, p, step_usable);
  read_attitude(e, p + PELORUS_CAN_FD_ROLL_BYTE, p[PELORUS_CAN_FD_SIGMA_ATT_BYTE]);
  e->bodies = p[PELORUS_CAN_FD_BODIES_BYTE];
  e->body_confidence_percent = p[PELORUS_CAN_FD_CONFIDENCE_BYTE];
  e->body_id = p[PELORUS_CAN_FD_ID_BYTE];
  e->body_phase = p[PELORUS_CAN_FD_PHASE_BYTE] >> 4;
  read_body(e, p + PELORUS_CAN_FD_BEARING_BYTE, p + PELORUS_CAN_FD_CLOSING_BYTE);
}

void pelorus_can_read_estimate(pelorus_can_receiver* rx, bool step_usable) {
  pelorus_can_estimate* e = &rx->estimate;
  step_usable = step_usable && is_usable(e); /* `e` is still the estimate before */
  clear(e);
  e->received_us = rx->now_us;
  e->counter = rx->pending_counter;
  e->state = rx->pending_state;
  if (rx->config.fd) {
    read_fd(rx, e, step_usable);
  } else {
    read_classic(rx, e, step_usable);
  }
}
