#pragma once
// Recorder: raw pairs to disk, started and stopped at any time, on a thread of its own that never delays vision: a pair
// is copied into a ring, and when the disk is too slow, dropped and counted. Stops by itself when the disk has less
// free space than it must keep, or at a pair that cannot be written, and goes on in a new folder after a pause, when
// there is room again. A recording without a single pair leaves no folder behind when it fails.
// Thread-safe: start, stop, status. offer(): one thread. Offering costs two copies of a picture and no heap.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "core/base/counter.h"
#include "drivers/frame_ring.h"
#include "services/recorder_config.h"
#include "services/recording_folder.h"

namespace pelorus {

enum class RecorderState : std::uint8_t { off, recording, disk_full, failed };

[[nodiscard]] const char* text(RecorderState state);

struct RecorderStatus {
  RecorderState state = RecorderState::off;
  std::uint64_t written = 0;  // pairs, of all recordings
  std::uint64_t dropped = 0;  // pairs for which the disk was too slow, those that still waited at the end among them
  std::uint64_t failed = 0;   // pairs that could not be written
  std::uint64_t bytes = 0;
  double free_gb = 0;   // of the disk, when last looked at
  std::string folder;   // of the present or last recording; empty when that left nothing
  std::string problem;  // why it is disk_full or failed
};

// "off", "recording FOLDER: 12 pairs", "disk full: 1.9 GB free in FOLDER".
[[nodiscard]] std::string summary(const RecorderStatus& status);

class Recorder {
 public:
  // Writes the calibration into a new recording's folder.
  using WriteCalibration = std::function<Result<>(const std::filesystem::path& folder)>;

  Recorder(const RecorderConfig& config, const FrameFormat& view, WriteCalibration write_calibration,
           std::function<void()> on_thread_start = {});
  // What waits is still written, for a third of a second at most.
  ~Recorder() = default;
  // Begins to end while others still work; the destructor waits for it.
  void end() { thread_.request_stop(); }

  // False: it was already so.
  bool start() { return !wanted_.exchange(true); }
  bool stop() { return wanted_.exchange(false); }

  // A pair of this moment; ignored unless recording.
  void offer(Timestamp time, const ImageView& left, const ImageView& right);

  [[nodiscard]] RecorderStatus status() const;

 private:
  void run(const std::stop_token& stop);
  void begin();
  [[nodiscard]] Result<> open_folder(const std::filesystem::path& folder);
  void write_next();
  void finish();
  void drop_waiting();
  void fail(const Error& error);
  void fail_full();
  void give_up(RecorderState state, const std::string& problem);
  [[nodiscard]] bool enough_space();

  RecorderConfig config_;
  WriteCalibration write_calibration_;
  double pair_gb_;  // of a pair as it is, or as pgm
  FrameRing ring_;
  std::atomic<bool> wanted_;
  std::atomic<bool> recording_{false};  // a folder is open: offers are taken
  std::atomic<RecorderState> state_{RecorderState::off};
  std::atomic<double> free_gb_{0};
  std::uint64_t offered_ = 0;  // offer()'s thread
  Counter written_, failed_, bytes_;
  Counter left_;                           // offered to a recording that had ended or failed meanwhile
  std::optional<RecordingFolder> folder_;  // recorder's thread
  std::chrono::steady_clock::time_point retry_at_;
  mutable std::mutex text_mutex_;  // of the two texts; taken when the state changes, never per pair
  std::string folder_name_;
  std::string problem_;
  std::jthread thread_;  // last: everything above is ready when it starts
};

}  // namespace pelorus
