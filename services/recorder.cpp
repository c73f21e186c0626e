#include "services/recorder.h"

#include <chrono>
#include <ctime>

namespace pelorus {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr auto kStep = std::chrono::milliseconds(100);           // between two looks at requests
constexpr auto kRetry = std::chrono::seconds(1);                 // after a failure
constexpr auto kLongestFinish = std::chrono::milliseconds(350);  // for what waits when recording ends
constexpr double kLeastPicture = 1e6;                            // bytes: a disk without room for it is full
constexpr double kRoomAgain = 1.05;                              // of the least free space: no flicker at the limit

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char name[32];
  std::strftime(name, sizeof name, "%Y-%m-%d_%H-%M-%S", &utc);
  return name;
}

// Two recordings of one second get different names.
fs::path unused_folder(const fs::path& parent) {
  const std::string name = utc_now();
  fs::path folder = parent / name;
  std::error_code ignored;
  for (int i = 2; fs::exists(folder, ignored); ++i) folder = parent / (name + "_" + std::to_string(i));
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
  status.dropped = ring_.drops().no_free_slot;
  status.failed = failed_.value();
  status.bytes = bytes_.value();
  status.free_gb = free_gb_.load(std::memory_order_relaxed);
  const std::scoped_lock lock(text_mutex_);
  status.folder = folder_name_;
  status.problem = problem_;
  return status;
}

void Recorder::run(const std::stop_token& stop) {
  Clock::time_point retry_at = Clock::now();
  while (!stop.stop_requested()) {
    const bool wanted = wanted_.load(std::memory_order_relaxed);
    if (wanted && !folder_ && Clock::now() >= retry_at) {
      begin();
      if (!folder_) retry_at = Clock::now() + kRetry;
    }
    if (!wanted) finish();
    if (ring_.wait(kStep)) write_next();
  }
  finish();
}

void Recorder::begin() {
  while (ring_.oldest()) {
  }  // offered while the last recording ended
  std::error_code failed;
  fs::create_directories(config_.folder, failed);
  const bool full_before = state_ == RecorderState::disk_full;
  if (!enough_space() || (full_before && free_gb_ < kRoomAgain * config_.min_free_gb)) {
    return fail(RecorderState::disk_full, std::to_string(free_gb_) + " GB free in " + config_.folder);
  }
  const fs::path folder = unused_folder(config_.folder);
  Result<RecordingFolder> created = RecordingFolder::create(folder, config_.format);
  if (!created) return fail(RecorderState::failed, created.error().message());
  if (Result<> calibrated = write_calibration_(folder); !calibrated) {
    return fail(RecorderState::failed, calibrated.error().message());
  }
  folder_ = std::move(created.value());
  {
    const std::scoped_lock lock(text_mutex_);
    folder_name_ = folder.string();
    problem_.clear();
  }
  state_ = RecorderState::recording;
  recording_ = true;
}

void Recorder::write_next() {
  const FrameLease frame = ring_.oldest();
  if (!frame || !folder_) return;
  if (!enough_space()) {
    failed_.add();
    return fail(RecorderState::disk_full, std::to_string(free_gb_) + " GB free in " + config_.folder);
  }
  const std::uint64_t before = folder_->bytes();
  if (Result<> written = folder_->append(frame->mid_exposure, frame->view[0].view(), frame->view[1].view()); !written) {
    const bool full = !enough_space() || free_gb_ * 1e9 < 2.0 * kLeastPicture;
    failed_.add();
    return fail(full ? RecorderState::disk_full : RecorderState::failed, written.error().message());
  }
  written_.add();
  bytes_.add(folder_->bytes() - before);
}

void Recorder::fail(RecorderState state, const std::string& problem) {
  recording_ = false;
  folder_.reset();
  state_ = state;
  const std::scoped_lock lock(text_mutex_);
  problem_ = problem;
}

void Recorder::finish() {
  recording_ = false;
  const Clock::time_point limit = Clock::now() + kLongestFinish;
  while (folder_ && ring_.has_frame() && Clock::now() < limit) write_next();
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
