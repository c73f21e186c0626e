#include "firmware-host/pelorusd/health_gather.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pelorus {
namespace {

// Numbers of which no two sums are equal.
CaptureStatus left_camera() {
  CaptureStatus s;
  s.camera.frames = 1000;
  s.camera.opened = 4;
  s.camera.restarts = 10;
  s.camera.skipped = 1;
  s.camera.incomplete = 20;
  s.camera.underruns = 300;
  s.camera.missing_packets = 5;
  s.camera.resent_packets = 7;
  s.camera.time_corrections = 2;
  s.ring.no_free_slot = 11;
  s.ring.superseded = 13;
  return s;
}

CaptureStatus right_camera() {
  CaptureStatus s;
  s.camera.frames = 999;
  s.camera.opened = 1;
  s.camera.restarts = 100;
  s.camera.skipped = 4000;
  s.camera.incomplete = 50'000;
  s.camera.underruns = 600'000;
  s.camera.missing_packets = 60;
  s.camera.resent_packets = 80;
  s.camera.time_corrections = 30;
  s.ring.no_free_slot = 120;
  s.ring.superseded = 140;
  return s;
}

TEST(HealthGather, CountersOfAllCamerasAreAdded) {
  HealthReport report;
  gather_capture({left_camera(), right_camera()}, {}, {}, report);
  const CounterReport& c = report.counters;
  EXPECT_EQ(c.pairs_captured, 1000U) << "of the left one, which gives a pair its number";
  EXPECT_EQ(c.camera_reopens, 3U + 10U + 100U) << "the first opening is none";
  EXPECT_EQ(c.dropped_in_source, 54'021U) << "underruns are packets of pictures that are in skipped";
  EXPECT_EQ(c.pictures_incomplete, 50'020U);
  EXPECT_EQ(c.packets_missing, 65U);
  EXPECT_EQ(c.packets_resent, 87U);
  EXPECT_EQ(c.time_jumps, 32U);
  EXPECT_EQ(c.dropped_ring_full, 131U);
  EXPECT_EQ(c.dropped_superseded, 153U);
}

TEST(HealthGather, ACameraThatWasNeverOpenedWasNotOpenedAnew) {
  HealthReport report;
  gather_capture({CaptureStatus{}, CaptureStatus{}}, {}, {}, report);
  EXPECT_EQ(report.counters.camera_reopens, 0U);
}

TEST(HealthGather, WhatPairingLosesIsAddedToWhatTheRingsLose) {
  SyncStatistics sync;
  sync.superseded = 1000;
  sync.unpaired_left = 1;
  sync.unpaired_right = 20;
  sync.out_of_tolerance = 300;
  sync.time_reversed = 4000;
  HealthReport report;
  gather_capture({left_camera(), right_camera()}, sync, -1'500'000, report);
  EXPECT_EQ(report.counters.dropped_superseded, 1153U);
  EXPECT_EQ(report.counters.dropped_unpaired, 4321U);
  EXPECT_DOUBLE_EQ(report.picture.sync_error_ms, -1.5);
}

TEST(HealthGather, WithoutAPairSinceTheLastReportTheSyncErrorIsUnknown) {
  HealthReport report;
  gather_capture({left_camera(), right_camera()}, {}, {}, report);
  EXPECT_TRUE(std::isnan(report.picture.sync_error_ms));
}

}  // namespace
}  // namespace pelorus
