#pragma once
// Vision: the thread that turns pairs into results: newest pair -> watch -> rectify -> Pipeline::step -> state ->
// result ring. Also speaks when no pair comes, so that consumers hear of a fault instead of nothing. Built after the
// publish thread, destroyed before it. Per frame: no lock, no log, no wait but for pictures and its own helpers; heap
// only for a reset. Thread-safe: status(), and VisionControl.

#include <atomic>
#include <functional>
#include <memory>
#include <stop_token>
#include <thread>

#include "core/base/counter.h"
#include "core/base/mailbox.h"
#include "core/geometry/rectifier.h"
#include "core/pipeline/pipeline.h"
#include "drivers/capture_clock.h"
#include "drivers/stereo_source.h"
#include "drivers/stereo_sync.h"
#include "services/capture_watch.h"
#include "services/frame_timeout.h"
#include "services/load_shedding.h"
#include "services/preview.h"
#include "services/recorder.h"
#include "services/result_ring.h"
#include "services/state_machine.h"

namespace pelorus {

// Requests to the vision thread, from any other.
struct VisionControl {
  std::atomic<bool> standby{false};
  std::atomic<std::uint32_t> resets{0};       // each increment starts the pipeline anew
  std::atomic<bool> lost_pair_wanted{false};  // the next pair that ends LOST, or exchanged, goes into lost_pairs
  std::atomic<bool> sides_exchanged{false};   // LOST is a CALIBRATION_FAULT meanwhile
};

struct VisionStatus {
  std::uint64_t turns = 0;           // of the thread's loop, at least five a second: for the watchdog
  std::uint64_t pairs = 0;           // taken up
  std::uint64_t pairs_missed = 0;    // gaps in the numbers of the pairs
  std::uint64_t missing_spells = 0;  // times without pictures
  std::uint64_t frozen_spells = 0;
  std::uint64_t time_jumps = 0;
  std::uint64_t steps_shed = 0;  // that left out optional work for lack of time
  double mean_grey = 0;
  double contrast_grey = 0;
  double exposure_ms = 0;  // 0 = unknown
};

// What vision works with; all borrowed, outliving the thread.
struct VisionParts {
  StereoSync& sync;
  const Rectifier& rectifier;
  ResultRing& results;
  VisionControl& control;
  const CaptureClock& clock;
  Preview* preview = nullptr;    // may be absent
  Recorder* recorder = nullptr;  // may be absent
  PipelineWorkers workers = {};  // absent ones: the vision thread does their work
  // May be absent; with room for the pictures, so that giving one costs no heap.
  Mailbox<SourcePair>* lost_pairs = nullptr;
};

class Vision {
 public:
  Vision(const VisionParts& parts, const PipelineConfig& pipeline, const CaptureWatchConfig& watch,
         const TimingConfig& timing, std::function<void()> on_thread_start = {});

  [[nodiscard]] VisionStatus status() const;

 private:
  void run(const std::stop_token& stop);
  void take(const StereoPair& pair);
  void tell_missing();
  void show_lost(const StereoPair& pair);
  [[nodiscard]] Circumstances look(const StereoPair& pair);
  void step(const StereoPair& pair, Timestamp capture_time, Publication& publication);
  void post(Publication& publication, Timestamp release_due);
  void obey();

  VisionParts parts_;
  PipelineConfig config_;
  TimingConfig timing_;
  FrameTimeout frame_timeout_;
  CaptureWatch watch_;
  std::unique_ptr<Pipeline> pipeline_;
  LoadShedding shedding_;
  Image left_;  // rectified
  Image right_;

  Timestamp last_heard_;  // of the last pair or missing result
  bool missing_ = false;  // in a spell without pictures
  bool any_pair_ = false;
  bool stamped_ = false;             // pairs came with stamps better than their arrival
  std::uint64_t last_pair_seq_ = 0;  // as the camera counts
  std::uint64_t seq_ = 0;            // as we count: grows over everything
  bool stepped_ = false;             // the pipeline has seen a pair
  Timestamp last_stepped_;
  Timestamp last_release_due_;
  std::uint32_t resets_obeyed_ = 0;
  int reset_base_ = 0;        // losses and resets of pipelines before this one
  std::int32_t id_base_ = 0;  // ids used by pipelines before this one
  std::int32_t highest_id_ = 0;
  int last_reset_counter_ = 0;

  Counter turns_, pairs_, pairs_missed_, missing_spells_, frozen_spells_, time_jumps_, steps_shed_;
  std::atomic<double> mean_grey_{0}, contrast_grey_{0}, exposure_ms_{0};
  std::jthread thread_;  // last: everything above is ready when it starts
};

}  // namespace pelorus
