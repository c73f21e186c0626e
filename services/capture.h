#pragma once
// Capture: the thread of one camera: device -> slot -> frame ring. Opens the camera, takes it up again with growing
// pauses when it is absent, lost or silent, and never stops trying until stopped or at the end of recorded frames.
// Owns the camera; the ring is borrowed and outlives it. Built after the consumer, destroyed before it.
// Thread-safe: status(). Per frame: no heap, no lock, no log.

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "drivers/camera.h"
#include "drivers/capture_clock.h"
#include "drivers/frame_ring.h"
#include "services/median_interval.h"

namespace pelorus {

enum class CaptureState : std::uint8_t {
  opening,    // being searched for the first time
  streaming,  // frames arrive
  silent,     // open, but no usable frame for longer than silent_after
  lost,       // gone or refused: tried again with pauses
  ended,      // recorded frames are at their end
};

[[nodiscard]] const char* text(CaptureState state);

struct CaptureConfig {
  double silent_after_s = 0.25;  // without a usable frame: state silent
  double reopen_after_s = 1.5;   // without any frame, at least: the camera is closed and opened anew
  double retry_first_s = 0.2;    // pause after a failed opening; doubles ...
  double retry_longest_s = 2.0;  // ... up to this
};

// How long a camera may be without any frame before it is opened anew: `least_s`, but six periods of a slow one, by the
// rate it states (0 = unknown) and by the intervals at which its frames come (0 = unknown), whichever is slower. Twice
// what a V4L2 stream may be silent before it is restarted in place: that is tried first.
[[nodiscard]] Duration reopen_limit(double least_s, double rate_hz, Duration interval);

struct CaptureStatus {
  CaptureState state = CaptureState::opening;
  CameraStatistics camera;
  RingDrops ring;
  Timestamp last_frame;      // mid-exposure of the frame published last; ns 0 = none yet
  std::string description;   // of the camera, once it was open
  std::string last_problem;  // why it could not be opened last; empty when it never failed
};

class Capture {
 public:
  // `on_thread_start` runs first on the new thread: scheduling class, pinning, name.
  Capture(std::unique_ptr<Camera> camera, FrameRing& ring, const CaptureConfig& config,
          std::function<void()> on_thread_start = {});
  ~Capture() = default;  // requests the stop and joins

  [[nodiscard]] CaptureStatus status() const;
  void request_stop() { thread_.request_stop(); }

 private:
  void run(const std::stop_token& stop);
  [[nodiscard]] bool open_camera();
  void stream(const std::stop_token& stop);
  void note_frame();
  void pause(const std::stop_token& stop, double seconds);
  void set_state(CaptureState state) { state_.store(state, std::memory_order_relaxed); }

  std::unique_ptr<Camera> camera_;
  FrameRing& ring_;
  CaptureConfig config_;
  MedianInterval intervals_;  // between frames of one opening; capture thread
  std::atomic<CaptureState> state_{CaptureState::opening};
  std::atomic<std::int64_t> last_frame_ns_{0};
  mutable std::mutex text_mutex_;  // of the two texts; taken at opening only, never per frame
  std::string description_;
  std::string last_problem_;
  std::mutex pause_mutex_;
  std::condition_variable_any pause_;
  std::jthread thread_;  // last: everything above is ready when it starts
};

}  // namespace pelorus
