#pragma once
// StereoSync: left and right frames of two cameras put together into pairs of one exposure; or the pairs of a device
// that delivers both views at once. Gives the newest pair; every frame that ends in no pair is counted with its cause.
//
// Pairing by time: mid-exposures within the tolerance, nearest first. Pairing by sequence (hardware trigger): equal
// counts of exposures, where the offset between the two counts is found by time once and again when nothing pairs;
// the times must still agree within the tolerance. Frames of one camera arrive in order.
//
// Thread-bound to the consumer of the rings; statistics() and take_worst_error_ns() for all. No heap, no lock; O(frames
// waiting).

#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/base/counter.h"
#include "drivers/frame_ring.h"

namespace pelorus {

enum class PairBy : std::uint8_t { time, sequence };

struct StereoSyncConfig {
  PairBy pair_by = PairBy::time;
  double tolerance_ms = 2.0;  // between the mid-exposures of a pair; below half a period
};

struct SyncStatistics {
  std::uint64_t pairs = 0;          // delivered
  std::uint64_t superseded = 0;     // pairs passed over because a newer one was complete
  std::uint64_t unpaired_left = 0;  // frames whose partner never came
  std::uint64_t unpaired_right = 0;
  std::uint64_t out_of_tolerance = 0;  // frame pairs of equal count whose times disagree
  std::uint64_t time_reversed = 0;     // frames thrown away because their camera's time went back behind them
  std::uint64_t realigned = 0;         // times the offset between the counts was found anew
  std::int64_t last_error_ns = 0;      // right minus left mid-exposure of the pair delivered last
};

// A pair and the permission to read it. Empty when default-made.
struct StereoPair {
  std::uint64_t seq = 0;   // of the left camera; a gap is pairs lost
  Timestamp capture_time;  // mid-exposure: mean of the two
  Timestamp arrival;       // when the later of the two was there
  Duration sync_error{};   // right minus left mid-exposure
  FrameLease first;        // left frame, or both views
  FrameLease second;       // right frame, unused for a device of two views

  explicit operator bool() const { return static_cast<bool>(first); }
  [[nodiscard]] ImageView left() const { return first->view[0].view(); }
  [[nodiscard]] ImageView right() const { return second ? second->view[0].view() : first->view[1].view(); }
};

class StereoSync {
 public:
  // Frames a camera may be ahead of the other; ring slots must exceed it by 4 to be free of loss.
  static constexpr std::size_t kWaiting = 4;

  explicit StereoSync(FrameRing& both_views);
  StereoSync(FrameRing& left, FrameRing& right, const StereoSyncConfig& config);

  // The newest pair that was not delivered before; waits for one at most `timeout`. Empty: none came.
  [[nodiscard]] StereoPair newest(Duration timeout);
  [[nodiscard]] SyncStatistics statistics() const;
  // Right minus left mid-exposure, the largest in magnitude of the pairs delivered since it was taken last; none when
  // there was no pair.
  [[nodiscard]] std::optional<std::int64_t> take_worst_error_ns();

 private:
  static constexpr std::int64_t kNoPair = std::numeric_limits<std::int64_t>::min();

  // Frames of one camera, oldest first.
  struct Side {
    FrameRing* ring = nullptr;
    std::array<FrameLease, kWaiting> waiting;
    std::size_t count = 0;
    Counter unpaired;
    void drop_oldest();
  };

  [[nodiscard]] bool collect(Side& side);
  void wait_for_frames(Duration timeout);
  [[nodiscard]] StereoPair newest_of_waiting();
  [[nodiscard]] StereoPair newest_of_device();
  void match_heads(StereoPair& best);
  [[nodiscard]] std::int64_t lead_of_left() const;
  [[nodiscard]] bool better_partner_behind() const;
  void drop_unmatched(Side& side);
  void take_heads(StereoPair& best);
  void note_delivered(const StereoPair& pair);

  StereoSyncConfig config_;
  std::int64_t tolerance_ns_ = 0;
  Side left_;
  Side right_;
  bool offset_known_ = false;  // between the counts of the cameras
  std::int64_t offset_ = 0;    // left seq - right seq of one exposure
  int unmatched_in_row_ = 0;
  Counter pairs_, superseded_, out_of_tolerance_, time_reversed_, realigned_;
  std::atomic<std::int64_t> last_error_ns_{0};
  std::atomic<std::int64_t> worst_error_ns_{kNoPair};
};

}  // namespace pelorus
