/*
 * What an autopilot does with the receiver, as a program for Linux: receives from a SocketCAN interface, checks,
 * prints. The loop is that of firmware: a control period, the frames that came, and then the one question
 * pelorus_can_latest().
 *
 *   example_autopilot INTERFACE [--fd] [--base-id ID] [--sets N] [--seconds N]
 *
 * Prints one line per estimate that may be used, one per change of the link, and the counts at the end. Exit codes: 0
 * done (with --sets: that many estimates were usable), 1 fewer, 2 usage, 7 no interface.
 */
#define _POSIX_C_SOURCE 200809L

#include <errno.h>
#include <inttypes.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "pelorus_can.h"

#define PERIOD_MS 10 /* of the control loop */

static volatile sig_atomic_t stopped;

static void on_signal(int number) {
  (void)number;
  stopped = 1;
}

static uint64_t micros(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

/* The identifiers are checked by the receiver; a firmware would set its acceptance filter to the twelve of them. */
static int open_bus(const char* name, int fd_frames) {
  struct sockaddr_can address;
  const int bus = socket(PF_CAN, SOCK_RAW, CAN_RAW);
  if (bus < 0) return -1;
  memset(&address, 0, sizeof address);
  address.can_family = AF_CAN;
  address.can_ifindex = (int)if_nametoindex(name);
  if (address.can_ifindex == 0) return -1;
  if (fd_frames && setsockopt(bus, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &fd_frames, sizeof fd_frames) < 0) return -1;
  if (bind(bus, (struct sockaddr*)&address, sizeof address) < 0) return -1;
  return bus;
}

static const char* link_name(pelorus_can_link link) {
  static const char* const names[] = {"SILENT", "STARTING", "UP", "TIMEOUT"};
  return (unsigned)link < 4 ? names[link] : "?";
}

static const char* state_name(uint8_t state) {
  static const char* const names[] = {"INIT",         "TRACKING",          "DEGRADED", "LOST",
                                      "CAMERA_FAULT", "CALIBRATION_FAULT", "STANDBY"};
  return state < 7 ? names[state] : "?";
}

static void print_estimate(const pelorus_can_estimate* e, uint64_t now_us) {
  printf("#%-3u %s quality %u resets %u%s", e->counter, state_name(e->state), e->quality, e->resets,
         e->reset ? " RESET" : "");
  if (e->valid & PELORUS_CAN_AGE) printf(" age %.1f ms", (double)pelorus_can_age_us(e, now_us) * 1e-3);
  if (e->valid & PELORUS_CAN_VELOCITY) {
    printf(" v %.3f %.3f %.3f m/s", (double)e->velocity_mps[0], (double)e->velocity_mps[1], (double)e->velocity_mps[2]);
  }
  if (e->valid & PELORUS_CAN_STEP) {
    printf(" d %.4f %.4f %.4f m", (double)e->step_m[0], (double)e->step_m[1], (double)e->step_m[2]);
  }
  if (e->valid & PELORUS_CAN_ATTITUDE) {
    printf(" rpy %.4f %.4f %.4f rad", (double)e->roll_rad, (double)e->pitch_rad, (double)e->yaw_rad);
  }
  if (e->valid & PELORUS_CAN_POSITION) {
    printf(" p %.2f %.2f %.2f m", (double)e->position_m[0], (double)e->position_m[1], (double)e->position_m[2]);
  }
  if (e->valid & PELORUS_CAN_BODY) {
    printf(" body %u at %.3f rad %.2f m", e->body_id, (double)e->body_bearing_rad, (double)e->body_range_m);
  }
  if (e->valid & PELORUS_CAN_NODE) printf(" calibration %08" PRIx32 " contract %u", e->calibration_hash, e->version);
  printf("\n");
  fflush(stdout);
}

/* All frames that are there. Returns 0 when the interface is lost. */
static int receive_frames(int bus, pelorus_can_receiver* rx) {
  struct canfd_frame frame;
  for (;;) {
    const ssize_t got = recv(bus, &frame, sizeof frame, MSG_DONTWAIT);
    if (got < 0) return errno == EAGAIN || errno == EINTR || errno == ENETDOWN;
    if (frame.can_id & (CAN_EFF_FLAG | CAN_RTR_FLAG | CAN_ERR_FLAG)) continue; /* standard data frames only */
    (void)pelorus_can_receive(rx, frame.can_id, frame.data, frame.len, micros());
  }
}

static unsigned long run(int bus, pelorus_can_receiver* rx, unsigned long sets, double seconds) {
  const uint64_t end_us = micros() + (uint64_t)(seconds * 1e6);
  pelorus_can_link link = PELORUS_CAN_LINK_SILENT;
  uint64_t printed_us = 0;
  uint64_t refused_us = 0;
  unsigned long usable = 0;
  while (!stopped && (sets == 0 || usable < sets) && (seconds <= 0 || micros() < end_us)) {
    struct pollfd ready = {bus, POLLIN, 0};
    const pelorus_can_estimate* estimate;
    pelorus_can_link now;
    (void)poll(&ready, 1, PERIOD_MS);
    if (!receive_frames(bus, rx)) break;
    now = pelorus_can_link_state(rx, micros());
    if (now != link) printf("link %s\n", link_name(now));
    link = now;
    estimate = pelorus_can_latest(rx, micros());
    if (!estimate && link == PELORUS_CAN_LINK_UP && rx->estimate.received_us != refused_us) {
      refused_us = rx->estimate.received_us;
      printf("#%-3u too old: %.1f ms\n", rx->estimate.counter,
             (double)pelorus_can_age_us(&rx->estimate, micros()) * 1e-3);
    }
    if (!estimate || estimate->received_us == printed_us) continue;
    printed_us = estimate->received_us;
    print_estimate(estimate, micros());
    if (estimate->valid & PELORUS_CAN_VELOCITY) ++usable;
  }
  return usable;
}

static int usage(void) {
  fputs("usage: example_autopilot INTERFACE [--fd] [--base-id ID] [--sets N] [--seconds N]\n", stderr);
  return 2;
}

int main(int argc, char** argv) {
  pelorus_can_config config = pelorus_can_default_config();
  pelorus_can_receiver rx;
  unsigned long sets = 0;
  unsigned long usable;
  double seconds = 0;
  int bus;
  if (argc < 2 || argv[1][0] == '-') return usage();
  for (int i = 2; i < argc; ++i) {
    const char* value = i + 1 < argc ? argv[i + 1] : NULL;
    if (strcmp(argv[i], "--fd") == 0) {
      config.fd = true;
      continue;
    }
    if (!value) return usage();
    if (strcmp(argv[i], "--base-id") == 0) {
      config.base_id = (uint32_t)strtoul(value, NULL, 0);
    } else if (strcmp(argv[i], "--sets") == 0) {
      sets = strtoul(value, NULL, 10);
    } else if (strcmp(argv[i], "--seconds") == 0) {
      seconds = strtod(value, NULL);
    } else {
      return usage();
    }
    ++i;
  }
  bus = open_bus(argv[1], config.fd);
  if (bus < 0) {
    fprintf(stderr, "example_autopilot: %s: %s\n", argv[1], strerror(errno));
    return 7;
  }
  signal(SIGINT, on_signal);
  signal(SIGTERM, on_signal);
  pelorus_can_start(&rx, &config);
  usable = run(bus, &rx, sets, seconds);
  close(bus);
  printf("%lu usable estimates; %" PRIu32 " sets, %" PRIu32 " lost, %" PRIu32 " incomplete, %" PRIu32 " jumps, %" PRIu32
         " bad CRC, %" PRIu32 " repeated, %" PRIu32 " timeouts\n",
         usable, rx.counts.sets, rx.counts.lost, rx.counts.incomplete, rx.counts.jumps, rx.counts.bad_crc,
         rx.counts.repeated, rx.counts.timeouts);
  return sets > 0 && usable < sets ? 1 : 0;
}
