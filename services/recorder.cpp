#include "services/recorder.h"

#include <algorithm>
#include <chrono>
#include <ctime>

namespace pelorus {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr auto kStep = std::chrono::milliseconds(100);           // between two looks at requests
constexpr auto kRetry = std::chrono::seconds(1);                 // after a failure
constexpr auto kLongestFinish = std::chrono::milliseconds(350);  // for what waits when recording ends
constexpr double kRoomAgain = 1.05;                              // of the least free space: no flicker at the limit

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char name[32];
  std::strftime(name, sizeof name, "%Y-%m-%d_%H-%M-%S", &utc);
  return name;
}

// A new folder named by this moment; two recordings of one second get different names.
Result<fs::path> new_folder(const fs::path& parent) {
  const std::string name = utc_now();
  fs::path folder = parent / name;
  std::error_code failed;
  for (int i = 2; !fs::create_directory(folder, failed); ++i) {
    if (failed) {
      return Error{ErrorCode::io, folder.string(), "cannot be created: " + failed.message(), "check rights and space"};
    }
    folder = parent / (name + "_" + std::to_string(i));
  }
  return folder;
}

}  // namespace

const char* text(RecorderState state) {
  switch (state) {
    case RecorderState::off:
      return "off";
    case RecorderState::recording:
      return "recording";
    case RecorderState::disk_full:
      return "disk full";
    case RecorderState::failed:
      return "failed";
  }
  return "unknown";
}

std::string summary(const RecorderStatus& status) {
  std::string line = text(status.state);
  if (status.state == RecorderState::recording) {
    line += " " + status.folder + ": " + std::to_string(status.written) + " pairs";
    if (status.dropped > 0) line += ", " + std::to_string(status.dropped) + " dropped";
  } else if (status.state != RecorderState::off) {
    line += ": " + status.problem;
  }
  return line;
}

Recorder::Recorder(const RecorderConfig& config, const FrameFormat& view, WriteCalibration write_calibration,
                   std::function<void()> on_thread_start)
    : config_(config),
      write_calibration_(std::move(write_calibration)),
      pair_gb_(2e-9 * view.width * view.height),
      ring_(config.queue_pairs + 2, {view.width, view.height, 2}),
      wanted_(config.at_start),
      thread_([this, prepare = std::move(on_thread_start)](const std::stop_token& stop) {
        if (prepare) prepare();
        run(stop);
      }) {}

void Recorder::offer(Timestamp time, const ImageView& left, const ImageView& right) {
  if (!recording_.load(std::memory_order_relaxed)) return;
  if (offered_++ % static_cast<std::uint64_t>(config_.every) != 0) return;
  CameraFrame& slot = ring_.slot();
  slot.mid_exposure = time;
  slot.view[0].assign(left);
  slot.view[1].assign(right);
  ring_.publish();
}

RecorderStatus Recorder::status() const {
  RecorderStatus status;
  status.state = state_.load(std::memory_order_relaxed);
  status.written = written_.value();
  status.dropped = ring_.drops().no_free_slot + left_.value();
  status.failed = failed_.value();
  status.bytes = bytes_.value();
  status.free_gb = free_gb_.load(std::memory_order_relaxed);
  const std::scoped_lock lock(text_mutex_);
  status.folder = folder_name_;
  status.problem = problem_;
  return status;
}

void Recorder::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const bool wanted = wanted_.load(std::memory_order_relaxed);
    if (wanted && !folder_ && Clock::now() >= retry_at_) begin();
    if (!wanted) finish();
    if (ring_.wait(kStep)) write_next();
  }
  finish();
}

void Recorder::begin() {
  drop_waiting();  // offered while the last recording ended
  std::error_code ignored;
  fs::create_directories(config_.folder, ignored);
  const bool full_before = state_ == RecorderState::disk_full;
  const bool room = enough_space();
  if (!room || (full_before && free_gb_ < kRoomAgain * std::max(config_.min_free_gb, pair_gb_))) return fail_full();
  const Result<fs::path> folder = new_folder(config_.folder);
  if (!folder) return fail(folder.error());
  if (Result<> opened = open_folder(folder.value()); !opened) {
    fs::remove_all(folder.value(), ignored);
    return fail(opened.error());
  }
  {
    const std::scoped_lock lock(text_mutex_);
    folder_name_ = folder.value().string();
    problem_.clear();
  }
  state_ = RecorderState::recording;
  recording_ = true;
}

Result<> Recorder::open_folder(const fs::path& folder) {
  Result<RecordingFolder> created = RecordingFolder::create(folder, config_.format);
  if (!created) return created.error();
  if (Result<> calibrated = write_calibration_(folder); !calibrated) return calibrated;
  folder_ = std::move(created.value());
  return Ok{};
}

void Recorder::write_next() {
  const FrameLease frame = ring_.oldest();
  if (!frame) return;
  if (!folder_) return left_.add();
  if (!enough_space()) {
    failed_.add();
    return fail_full();
  }
  const std::uint64_t before = folder_->bytes();
  if (Result<> written = folder_->append(frame->mid_exposure, frame->view[0].view(), frame->view[1].view()); !written) {
    failed_.add();
    return fail(written.error());
  }
  written_.add();
  bytes_.add(folder_->bytes() - before);
}

void Recorder::fail(const Error& error) {
  give_up(says_disk_full(error) ? RecorderState::disk_full : RecorderState::failed, error.message());
}

void Recorder::fail_full() {
  give_up(RecorderState::disk_full, std::to_string(free_gb_) + " GB free in " + config_.folder);
}

// Ends the recording, if there is one.
void Recorder::give_up(RecorderState state, const std::string& problem) {
  recording_ = false;
  retry_at_ = Clock::now() + kRetry;
  const bool empty = folder_ && folder_->bytes() == 0;
  if (empty) {
    std::error_code ignored;
    fs::remove_all(folder_->folder(), ignored);
  }
  folder_.reset();
  state_ = state;
  const std::scoped_lock lock(text_mutex_);
  problem_ = problem;
  if (empty) folder_name_.clear();
}

void Recorder::drop_waiting() {
  while (ring_.oldest()) left_.add();
}

void Recorder::finish() {
  recording_ = false;
  const Clock::time_point limit = Clock::now() + kLongestFinish;
  while (folder_ && ring_.has_frame() && Clock::now() < limit) write_next();
  drop_waiting();
  folder_.reset();
  state_ = RecorderState::off;
}

// Unknown space (a folder that does not exist) is left to the error of writing.
bool Recorder::enough_space() {
  std::error_code failed;
  const fs::space_info space = fs::space(config_.folder, failed);
  if (failed) return true;
  free_gb_ = static_cast<double>(space.available) / 1e9;
  return free_gb_ >= config_.min_free_gb;
}

}  // namespace pelorus
