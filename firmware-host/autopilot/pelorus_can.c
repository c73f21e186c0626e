/* Link supervision: CRC, counter, assembly of sets, timeouts. The fields are read in pelorus_can_fields.c. */
#include "pelorus_can.h"

#include <string.h>

#include "pelorus_can_fields.h"

#define BIT(offset) (UINT32_C(1) << (offset))

/* Frames without which a classic set is not complete. */
#define CLASSIC_SET                                                                                \
  (BIT(PELORUS_CAN_VEL_OFFSET) | BIT(PELORUS_CAN_ATT_OFFSET) | BIT(PELORUS_CAN_POS_OFFSET) |       \
   BIT(PELORUS_CAN_TIME_OFFSET) | BIT(PELORUS_CAN_OBJ_OFFSET) | BIT(PELORUS_CAN_OBJ_RATE_OFFSET) | \
   BIT(PELORUS_CAN_QUAL_OFFSET))
#define FD_SET BIT(PELORUS_CAN_FD_OFFSET)

static const uint16_t data_ids[PELORUS_CAN_FRAMES] = PELORUS_CAN_DATA_IDS;
static const uint8_t sizes[PELORUS_CAN_FRAMES] = PELORUS_CAN_SIZES;

uint8_t pelorus_can_crc8(uint8_t data_id, const uint8_t* bytes, uint32_t size) {
  uint8_t crc = 0xFF;
  for (uint32_t i = 0; i <= size; ++i) {
    crc = (uint8_t)(crc ^ (i == 0 ? data_id : bytes[i - 1]));
    for (int bit = 0; bit < 8; ++bit) {
      crc = (uint8_t)((crc & 0x80) ? (crc << 1) ^ 0x2F : crc << 1);
    }
  }
  return (uint8_t)~crc;
}

uint16_t pelorus_can_crc16(uint16_t data_id, const uint8_t* bytes, uint32_t size) {
  uint16_t crc = 0xFFFF;
  for (uint32_t i = 0; i < size + 2; ++i) {
    const unsigned byte = i == 0 ? data_id & 0xFFu : i == 1 ? (unsigned)(data_id >> 8) : bytes[i - 2];
    crc = (uint16_t)(crc ^ (byte << 8));
    for (int bit = 0; bit < 8; ++bit) {
      crc = (uint16_t)((crc & 0x8000) ? (crc << 1) ^ 0x1021 : crc << 1);
    }
  }
  return crc;
}

pelorus_can_config pelorus_can_default_config(void) {
  pelorus_can_config config;
  config.base_id = PELORUS_CAN_BASE_ID;
  config.timeout_us = 300000; /* as ArduPilot takes vision for unhealthy */
  config.set_window_us = 100000;
  config.max_age_us = 500000;
  config.max_step = 2;
  config.good_sets = 2;
  config.fd = false;
  return config;
}

void pelorus_can_start(pelorus_can_receiver* rx, const pelorus_can_config* config) {
  memset(rx, 0, sizeof *rx);
  rx->config = config ? *config : pelorus_can_default_config();
}

/* Forgets the sequence: what comes next has to prove itself anew. */
static void drop_link(pelorus_can_receiver* rx) {
  rx->link = PELORUS_CAN_LINK_TIMEOUT;
  rx->sequence_known = false;
  rx->pending = 0;
  ++rx->counts.timeouts;
}

static void look_at_time(pelorus_can_receiver* rx, uint64_t now_us) {
  const bool alive = rx->link == PELORUS_CAN_LINK_UP || rx->link == PELORUS_CAN_LINK_STARTING;
  const bool ran_back = now_us < rx->now_us; /* against the promise; nothing dated by that clock can be trusted */
  if (ran_back) rx->pending = 0;
  if (alive && (ran_back || now_us - rx->last_set_us > rx->config.timeout_us)) drop_link(rx);
  rx->now_us = now_us;
}

static bool crc_is_right(uint32_t kind, const uint8_t* data) {
  if (kind >= PELORUS_CAN_FD_SLOW_OFFSET) {
    const uint16_t crc = (uint16_t)(data[0] | (uint16_t)(data[1] << 8));
    return crc == pelorus_can_crc16(data_ids[kind], data + 2, (uint32_t)sizes[kind] - 2);
  }
  return data[0] == pelorus_can_crc8((uint8_t)data_ids[kind], data + 1, (uint32_t)sizes[kind] - 1);
}

static uint8_t* slot_of(pelorus_can_receiver* rx, uint32_t kind) {
  if (kind == PELORUS_CAN_FD_OFFSET) return rx->fd;
  if (kind == PELORUS_CAN_FD_SLOW_OFFSET) return rx->fd_slow;
  return rx->classic[kind];
}

static pelorus_can_event finish_set(pelorus_can_receiver* rx) {
  const uint8_t counter = rx->pending_counter;
  const uint8_t modulo_mask = rx->config.fd ? 0xFF : 0x0F;
  const uint8_t step = (uint8_t)((counter - rx->last_counter) & modulo_mask);
  const bool jump = rx->sequence_known && step > rx->config.max_step;
  const bool next = rx->sequence_known && step == 1;
  if (jump) ++rx->counts.jumps;
  if (rx->sequence_known && !jump) rx->counts.lost += (uint32_t)step - 1;
  if (!rx->sequence_known || jump) rx->good = 0;
  if (rx->good < UINT8_MAX) ++rx->good;
  rx->link = rx->good >= rx->config.good_sets ? PELORUS_CAN_LINK_UP : PELORUS_CAN_LINK_STARTING;
  rx->sequence_known = true;
  rx->last_counter = counter;
  rx->last_set_us = rx->now_us;
  ++rx->counts.sets;
  pelorus_can_read_estimate(rx, next);
  rx->estimate.reset = rx->resets_known && rx->estimate.resets != rx->handed_resets;
  rx->pending = 0;
  return jump ? PELORUS_CAN_SET_JUMP : PELORUS_CAN_SET;
}

/* A frame that is right in itself: does it belong to the set in work? */
static pelorus_can_event add_to_set(pelorus_can_receiver* rx, uint32_t kind, const uint8_t* data) {
  const uint8_t counter = rx->config.fd ? data[PELORUS_CAN_FD_COUNTER_BYTE] : data[PELORUS_CAN_COUNTER_BYTE] & 0x0F;
  const uint8_t state = rx->config.fd ? data[PELORUS_CAN_FD_STATE_BYTE] & 0x0F : data[PELORUS_CAN_COUNTER_BYTE] >> 4;
  const uint32_t whole = rx->config.fd ? FD_SET : CLASSIC_SET;
  const bool late = rx->pending && rx->now_us - rx->pending_since_us > rx->config.set_window_us;
  if (rx->pending && (late || counter != rx->pending_counter)) {
    rx->pending = 0;
    ++rx->counts.incomplete;
  }
  if ((rx->pending & BIT(kind)) || (!rx->pending && rx->sequence_known && counter == rx->last_counter)) {
    ++rx->counts.repeated;
    return PELORUS_CAN_REPEATED;
  }
  if (!rx->pending) {
    rx->pending_since_us = rx->now_us;
    rx->pending_counter = counter;
    rx->pending_state = state;
  }
  if (state != rx->pending_state) {
    rx->pending = 0;
    ++rx->counts.bad_state;
    return PELORUS_CAN_BAD_STATE;
  }
  memcpy(slot_of(rx, kind), data, sizes[kind]);
  rx->pending |= BIT(kind);
  return (rx->pending & whole) == whole ? finish_set(rx) : PELORUS_CAN_PART;
}

pelorus_can_event pelorus_can_receive(pelorus_can_receiver* rx, uint32_t id, const uint8_t* data, uint8_t size,
                                      uint64_t now_us) {
  const uint32_t kind = id - rx->config.base_id; /* wraps below the base: then it is large */
  look_at_time(rx, now_us);
  if (kind >= PELORUS_CAN_FRAMES || (kind >= PELORUS_CAN_FD_SLOW_OFFSET) != rx->config.fd) return PELORUS_CAN_NOT_OURS;
  if (size != sizes[kind]) {
    ++rx->counts.bad_size;
    return PELORUS_CAN_BAD_SIZE;
  }
  if (!crc_is_right(kind, data)) {
    ++rx->counts.bad_crc;
    return PELORUS_CAN_BAD_CRC;
  }
  ++rx->counts.frames;
  return add_to_set(rx, kind, data);
}

uint64_t pelorus_can_age_us(const pelorus_can_estimate* estimate, uint64_t now_us) {
  if (!(estimate->valid & PELORUS_CAN_AGE) || now_us < estimate->received_us) return UINT64_MAX;
  return estimate->age_us + (now_us - estimate->received_us);
}

pelorus_can_link pelorus_can_link_state(pelorus_can_receiver* rx, uint64_t now_us) {
  look_at_time(rx, now_us);
  return rx->link;
}

const pelorus_can_estimate* pelorus_can_latest(pelorus_can_receiver* rx, uint64_t now_us) {
  if (pelorus_can_link_state(rx, now_us) != PELORUS_CAN_LINK_UP) return NULL;
  if ((rx->estimate.valid & PELORUS_CAN_AGE) && pelorus_can_age_us(&rx->estimate, now_us) > rx->config.max_age_us) {
    return NULL;
  }
  rx->resets_known = true;
  rx->handed_resets = rx->estimate.resets;
  return &rx->estimate;
}
