/*
 * Receiver of Pelorus' CAN estimates, for the autopilot's firmware. C99, freestanding: no heap, no libc beyond
 * <stdint.h>, <stdbool.h> and <string.h>, no globals, no clock. Copy pelorus_can.h, pelorus_can.c and
 * pelorus_can_contract.h (generated); docs/can.md explains the contract.
 *
 *   pelorus_can_receiver rx;
 *   pelorus_can_start(&rx, NULL);
 *   on every standard (11-bit) data frame:  pelorus_can_receive(&rx, id, data, size, now_us);
 *   in the control loop:                    const pelorus_can_estimate *e = pelorus_can_latest(&rx, now_us);
 *                                           if (e && (e->valid & PELORUS_CAN_VELOCITY)) use(e->velocity_mps);
 *
 * What it promises: an estimate is handed out only while the link is up (good_sets sets in sequence, none later than
 * timeout_us, CRC and counter right, all frames of one set) and its measurement is not older than max_age_us.
 * Everything else is counted and gives NULL. Fields that are not vouched for are NaN and lack their bit in `valid`.
 * Units SI. Axes: body x forward, y starboard, z down; `start` = the body axes when vision started.
 * Not thread-safe: call from one context, or guard. Time: any microsecond counter that never runs back.
 */
#ifndef PELORUS_CAN_H
#define PELORUS_CAN_H

#include <stdbool.h>
#include <stdint.h>

#include "pelorus_can_contract.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
  PELORUS_CAN_STATE_INIT = 0,
  PELORUS_CAN_STATE_TRACKING = 1,
  PELORUS_CAN_STATE_DEGRADED = 2, /* usable, larger deviations */
  PELORUS_CAN_STATE_LOST = 3,
  PELORUS_CAN_STATE_CAMERA_FAULT = 4,
  PELORUS_CAN_STATE_CALIBRATION_FAULT = 5,
  PELORUS_CAN_STATE_STANDBY = 6
} pelorus_can_state;

/* Bits of pelorus_can_estimate.valid. */
enum {
  PELORUS_CAN_VELOCITY = 1 << 0,
  PELORUS_CAN_ATTITUDE = 1 << 1,
  PELORUS_CAN_STEP = 1 << 2, /* only when the estimate before was received and had one */
  PELORUS_CAN_TURN = 1 << 3, /* FD only, as STEP */
  PELORUS_CAN_AGE = 1 << 4,
  PELORUS_CAN_INTERVAL = 1 << 5,
  PELORUS_CAN_BODY = 1 << 6, /* bearing, elevation, range of the nearest moving body */
  PELORUS_CAN_BODY_CLOSING = 1 << 7,
  PELORUS_CAN_POSITION = 1 << 8, /* only in sets that carry the slow frames */
  PELORUS_CAN_NODE = 1 << 9      /* calibration hash, version; only in sets that carry them */
};

typedef struct {
  uint32_t valid;
  uint64_t received_us; /* when the set was complete */
  uint64_t measured_us; /* mid-exposure on the receiver's clock: received - age; 0 without AGE */
  uint32_t age_us;      /* when it was sent; pelorus_can_age_us() lets it grow */
  uint8_t counter;      /* modulo 16, FD: 256 */
  uint8_t state;        /* pelorus_can_state; unknown codes: treat as LOST */
  uint8_t quality;      /* percent, 0 = no valid estimate */
  uint8_t resets;       /* another number than before: position and attitude may have jumped */
  bool reset;           /* `resets` differs from the last estimate that was handed out */

  float interval_s;      /* the step's duration: measured_us is its end */
  float velocity_mps[3]; /* body axes, constant over the last frame interval */
  float velocity_variance_m2ps2[3];
  float step_m[3]; /* way during interval_s, body axes at its beginning */
  float step_variance_m2[3];
  float turn_rad[3]; /* rotation vector during interval_s, FD only */
  float turn_variance_rad2[3];
  float roll_rad, pitch_rad, yaw_rad; /* since start; NOT against gravity or north */
  float attitude_variance_rad2;

  uint8_t bodies; /* moving bodies tracked; 255 not known */
  uint8_t body_id;
  uint8_t body_phase;              /* 1 seen now, 2 extrapolated through an occlusion */
  uint8_t body_confidence_percent; /* 255 not known */
  float body_bearing_rad;          /* + to starboard */
  float body_elevation_rad;        /* + up */
  float body_range_m;
  float body_closing_mps; /* + coming nearer */

  float position_m[3]; /* since start, axes of start */
  float position_variance_m2;
  float latency_s; /* declared; NaN when not carried */
  uint32_t calibration_hash;
  uint8_t version;
  uint16_t sender_dropped;
} pelorus_can_estimate;

typedef struct {
  uint32_t base_id;       /* PELORUS_CAN_BASE_ID */
  uint32_t timeout_us;    /* without a set for so long: TIMEOUT */
  uint32_t set_window_us; /* the frames of a set arrive within this, or the set is dropped */
  uint32_t max_age_us;    /* older measurements are not handed out; more than the declared latency */
  uint8_t max_step;       /* largest accepted step of the counter: max_step - 1 lost sets are forgiven */
  uint8_t good_sets;      /* sets in sequence before the link is up (again) */
  bool fd;                /* listen to VIS_FD in place of the classic frames */
} pelorus_can_config;

typedef enum {
  PELORUS_CAN_LINK_SILENT = 0, /* nothing good received yet */
  PELORUS_CAN_LINK_STARTING,   /* good sets, not yet enough of them */
  PELORUS_CAN_LINK_UP,
  PELORUS_CAN_LINK_TIMEOUT /* was starting or up, then silence */
} pelorus_can_link;

typedef enum {
  PELORUS_CAN_NOT_OURS = 0, /* another identifier: nothing done */
  PELORUS_CAN_PART,         /* a good frame; its set is not complete */
  PELORUS_CAN_SET,          /* completed a set in sequence: a new estimate */
  PELORUS_CAN_SET_JUMP,     /* completed a set out of sequence: the link starts anew with it */
  PELORUS_CAN_BAD_SIZE,
  PELORUS_CAN_BAD_CRC,
  PELORUS_CAN_BAD_STATE, /* frames of one set contradict each other: the set is dropped */
  PELORUS_CAN_REPEATED   /* a frame or set seen before */
} pelorus_can_event;

/* Counts since start; they wrap. */
typedef struct {
  uint32_t frames, sets;
  uint32_t bad_size, bad_crc, bad_state;
  uint32_t repeated;   /* frames */
  uint32_t incomplete; /* sets of which frames are missing */
  uint32_t lost;       /* sets missing by the counter, forgiven */
  uint32_t jumps;      /* steps of the counter beyond max_step */
  uint32_t timeouts;
} pelorus_can_counts;

typedef struct {
  pelorus_can_config config;
  pelorus_can_counts counts;
  pelorus_can_link link;
  uint64_t now_us;  /* latest time seen */
  uint32_t pending; /* bit per frame kind received for the set in work */
  uint64_t pending_since_us;
  uint8_t pending_counter, pending_state;
  uint8_t classic[PELORUS_CAN_FD_SLOW_OFFSET][8]; /* frames of the set in work, by identifier */
  uint8_t fd_slow[PELORUS_CAN_FD_SLOW_SIZE];
  uint8_t fd[PELORUS_CAN_FD_SIZE];
  bool sequence_known; /* last_counter may be compared with */
  uint8_t last_counter;
  uint8_t good;
  bool resets_known; /* handed_resets: of the last estimate handed out */
  uint8_t handed_resets;
  uint64_t last_set_us;
  pelorus_can_estimate estimate;
} pelorus_can_receiver;

/* The values used when `config` is NULL: 300 ms timeout, 100 ms window, 500 ms age, step 2, 2 sets, classic. */
pelorus_can_config pelorus_can_default_config(void);

void pelorus_can_start(pelorus_can_receiver* rx, const pelorus_can_config* config);

/* One standard data frame. `data` may be NULL only when size is 0. */
pelorus_can_event pelorus_can_receive(pelorus_can_receiver* rx, uint32_t id, const uint8_t* data, uint8_t size,
                                      uint64_t now_us);

/* The newest estimate that may be used now, or NULL. Valid until the next call of pelorus_can_receive. */
const pelorus_can_estimate* pelorus_can_latest(pelorus_can_receiver* rx, uint64_t now_us);

/* Link after looking at the time; counts a timeout once. */
pelorus_can_link pelorus_can_link_state(pelorus_can_receiver* rx, uint64_t now_us);

/* Age of the measurement at `now_us`: as sent, and grown since. UINT64_MAX when not known. */
uint64_t pelorus_can_age_us(const pelorus_can_estimate* estimate, uint64_t now_us);

/* CRCs of the contract over the data id and then the bytes. Check on the target with "123456789":
 * crc8('1', "23456789", 8) is 0xDF, crc16('1' | '2' << 8, "3456789", 7) is 0x29B1. */
uint8_t pelorus_can_crc8(uint8_t data_id, const uint8_t* bytes, uint32_t size);
uint16_t pelorus_can_crc16(uint16_t data_id, const uint8_t* bytes, uint32_t size);

#ifdef __cplusplus
}
#endif

#endif
