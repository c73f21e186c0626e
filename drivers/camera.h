#pragma once
// Camera: a device that delivers frames with the time of mid-exposure. Real ones (v4l2, aravis) and frames made live
// (replay in real time, the synthetic world) look alike from here.
//
// Life: open() -> start() -> next() ... -> stop(); after stop(), or after next() said `lost`, open() may be called
// again (that is how a camera that came back is taken up). Thread-bound: open, start, next and stop on one thread (the
// capture thread); statistics() on any thread at any time. Steady state of next(): no heap, no lock, no log, and it
// never waits longer than `timeout`. Errors: of open() and start() a Result that names device and cure; afterwards
// only outcomes and counters.

#include <algorithm>
#include <cstdint>
#include <string>

#include "core/base/counter.h"
#include "core/base/result.h"
#include "core/base/time.h"
#include "drivers/camera_frame.h"

namespace pelorus {

enum class FrameOutcome : std::uint8_t {
  frame,    // `frame` is filled
  timeout,  // none arrived in time
  dropped,  // one arrived and is unusable (incomplete, marked bad by the driver); counted
  lost,     // the device is gone: stop(), later open()
  ended,    // recorded or synthetic frames are at their end
};

// Counters since construction; they survive reopening. No picture is in two of frames, incomplete and skipped.
struct CameraStatistics {
  std::uint64_t frames = 0;            // delivered by next()
  std::uint64_t incomplete = 0;        // arrived with missing or broken content
  std::uint64_t skipped = 0;           // gaps in the device's own count: exposed, but never arrived
  std::uint64_t timeouts = 0;          // next() without a frame
  std::uint64_t lost = 0;              // times the device disappeared
  std::uint64_t opened = 0;            // times it was opened
  std::uint64_t restarts = 0;          // times a silent stream was restarted in place
  std::uint64_t time_corrections = 0;  // stamps that contradicted the capture clock and were replaced
  std::uint64_t resend_requests = 0;   // packets asked for again (GigE Vision)
  std::uint64_t resent_packets = 0;    // and received then
  std::uint64_t missing_packets = 0;   // never received
  std::uint64_t underruns = 0;         // packets the transport had no buffer for; their pictures are in skipped
};

// The counters that cameras have in common.
struct CameraCounters {
  Counter frames, incomplete, skipped, timeouts, lost, opened;
  std::uint64_t unnumbered = 0;  // incomplete since the last numbered picture; of the capture thread

  // A picture that came without its number: the gap before the next one will hold it too.
  void note_unnumbered() {
    incomplete.add();
    ++unnumbered;
  }
  // So many numbers are missing before a picture that came with its own.
  void note_gap(std::uint64_t missing) {
    skipped.add(missing - std::min(missing, unnumbered));
    unnumbered = 0;
  }

  [[nodiscard]] CameraStatistics read() const {
    CameraStatistics s;
    s.frames = frames.value();
    s.incomplete = incomplete.value();
    s.skipped = skipped.value();
    s.timeouts = timeouts.value();
    s.lost = lost.value();
    s.opened = opened.value();
    return s;
  }
};

class Camera {
 public:
  virtual ~Camera() = default;
  // Finds the device, applies the settings, reads back what it really does.
  [[nodiscard]] virtual Result<> open() = 0;
  [[nodiscard]] virtual Result<> start() = 0;
  // Fills `frame`, reusing its storage; untouched or half filled unless the outcome is `frame`.
  [[nodiscard]] virtual FrameOutcome next(CameraFrame& frame, Duration timeout) = 0;
  virtual void stop() = 0;

  // Valid after open(): what next() will deliver.
  [[nodiscard]] virtual FrameFormat format() const = 0;
  [[nodiscard]] virtual CameraStatistics statistics() const = 0;
  // At which frames should come, as the device or the settings say; 0 = unknown. Valid after open().
  [[nodiscard]] virtual double rate_hz() const { return 0; }
  // One line: driver, device, format, where its time comes from. For log and doctor; valid after open().
  [[nodiscard]] virtual std::string description() const = 0;
};

}  // namespace pelorus
