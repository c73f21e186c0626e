#pragma once
// What leaves the service for one pair of pictures, and the interface of those who carry it (LCM, CAN, tests).
// Thread rule: publish() is called by the publish thread only, at the moment of release; it may not wait for anything.

#include <cstdint>
#include <vector>

#include "core/base/time.h"
#include "core/model/stage_data.h"

namespace pelorus {

// Why the state is not TRACKING; the worst reason that holds.
enum class StateReason : std::uint8_t {
  none,
  starting,          // INIT: the first pairs
  few_points,        // DEGRADED or LOST, as the pipeline judged
  ambiguous_world,   // DEGRADED: another group of points might be the world
  deadline_missed,   // DEGRADED: released later than declared
  pairs_dropped,     // DEGRADED: captured pairs were not used since the last result
  time_jump,         // DEGRADED: the camera's time stamps left the clock
  repeated_picture,  // DEGRADED: the same picture again, too few times to call it frozen
  no_pictures,       // CAMERA_FAULT
  frozen_pictures,   // CAMERA_FAULT
  calibration,       // CALIBRATION_FAULT
  exchanged_sides,   // CALIBRATION_FAULT: left is right and right is left
  commanded          // STANDBY
};
[[nodiscard]] const char* to_text(StateReason reason);

struct Publication {
  FrameResult result;  // its state is final: what consumers see
  StateReason reason = StateReason::none;
  bool has_picture = true;  // false: the result of a missing pair, made by the service at its time
  Duration step{};          // time spanned by T_curr_prev; 0 = there is no previous estimate
  Timestamp ready;          // capture clock: when vision was done with it
  Timestamp release_due;    // capture clock: mid-exposure + declared latency
  Timestamp released;       // capture clock: when the publish thread let it go
  bool deadline_missed = false;
  std::uint64_t pairs_dropped = 0;  // since the service started, for whatever reason
};

// What an operator sees now and then: the left picture as JPEG, with what the system believes drawn in.
struct PreviewPicture {
  Timestamp capture_time;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> jpeg;
};

struct HealthReport;

class Publisher {
 public:
  virtual ~Publisher() = default;
  // Failure is a counter of the publisher, never an Error: the next result is more worth than this one.
  virtual void publish(const Publication& publication) = 0;
  // Between results: what a publisher could not send at once. Returns how soon it wants to be called again.
  [[nodiscard]] virtual Duration tend() { return std::chrono::seconds(1); }
  // For buses with room for them.
  virtual void publish_health(const HealthReport&) {}
  virtual void publish_preview(const PreviewPicture&) {}
};

}  // namespace pelorus
