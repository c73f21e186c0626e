#include "services/can/can_publisher.h"

#include <utility>

namespace pelorus {
namespace {

constexpr Duration kLookAgain = std::chrono::milliseconds(2);  // a frame takes 0.25 ms at 500 kbit/s
constexpr Duration kNothingToDo = std::chrono::milliseconds(100);

bool is_no_bus(CanBusState state) {
  return state == CanBusState::absent || state == CanBusState::down || state == CanBusState::bus_off;
}

}  // namespace

std::string status_text(const CanStatus& status, const std::string& interface) {
  std::string out = interface + " " + to_text(status.bus.state) + ", " + std::to_string(status.sets_sent) + " sets, " +
                    std::to_string(status.sets_dropped) + " dropped, " + std::to_string(status.bus.error_frames) +
                    " error frames, " + std::to_string(status.bus.bus_offs) + " bus-offs";
  if (!status.trouble.empty()) out += ": " + status.trouble;
  return out;
}

CanPublisher::CanPublisher(const CanConfig& config, const Rigid3& T_body_cam, Duration latency,
                           std::uint32_t calibration_hash, Open open)
    : config_(config),
      frames_(T_body_cam),
      open_(std::move(open)),
      calibration_hash_(calibration_hash),
      latency_s_(seconds(latency)) {
  open_if_due();
  share();
}

void CanPublisher::publish(const Publication& publication) {
  open_if_due();
  listen();
  drop_rest();
  estimate_ = estimate_of(publication, previous_, frames_, publication.released);
  estimate_time_ = Clock::now();
  if (publication.result.pose_valid) {
    previous_ = {true, publication.result.capture_time, publication.result.reset_counter,
                 publication.result.T_world_cam};
  }
  ++counter_;
  if (socket_) {
    waiting_ = true;
    send_rest();
  } else {
    ++now_.sets_unheard;
  }
  share();
}

Duration CanPublisher::tend() {
  open_if_due();
  listen();
  send_rest();
  share();
  return waiting_ ? kLookAgain : kNothingToDo;
}

// A set that is replaced by the next one, or has nobody left to go to.
void CanPublisher::drop_rest() {
  if (!waiting_) return;
  waiting_ = begun_ = false;
  ++(is_no_bus(now_.bus.state) ? now_.sets_unheard : now_.sets_dropped);
}

// Encoded when it is written, not when it was made: its age is true then.
void CanPublisher::begin_set() {
  estimate_.latency_s = latency_s_;
  estimate_.calibration_hash = calibration_hash_;
  estimate_.contract_version = kCanContractVersion;
  estimate_.sets_dropped = static_cast<double>(now_.sets_dropped);
  const Clock::time_point now = Clock::now();
  estimate_.age_s += std::chrono::duration<double>(now - estimate_time_).count();
  estimate_time_ = now;
  CanSetOptions options;
  options.transport = config_.fd ? CanTransport::fd : CanTransport::classic;
  options.base_id = static_cast<std::uint32_t>(config_.base_id);
  options.counter = counter_;
  options.with_slow = config_.slow_every > 0 && counter_ % static_cast<unsigned>(config_.slow_every) == 0;
  set_ = encode_set(estimate_, options);
}

void CanPublisher::send_rest() {
  if (!waiting_ || !socket_) return;
  // Frames of an older set are still in the kernel: not behind those.
  if (!begun_ && socket_->unsent_bytes().value_or(0) > 0) return;
  begin_set();
  if (!begun_) next_frame_ = 0;
  begun_ = true;
  while (next_frame_ < set_.size) {
    const CanSendOutcome outcome = socket_->send(set_.frames[static_cast<std::size_t>(next_frame_)]);
    if (outcome == CanSendOutcome::full) return;
    if (outcome == CanSendOutcome::down) {
      now_.bus.state = CanBusState::down;
      now_.trouble = config_.interface + " is down";
      drop_rest();
      return;
    }
    if (outcome == CanSendOutcome::gone) {
      close(CanBusState::absent, config_.interface + " is gone");
      return;
    }
    ++next_frame_;
    note_taken();
  }
  // A controller that is off swallows what it is given.
  ++(now_.bus.state == CanBusState::bus_off ? now_.sets_unheard : now_.sets_sent);
  waiting_ = begun_ = false;
}

// An interface that takes a frame is up.
void CanPublisher::note_taken() {
  if (now_.bus.state != CanBusState::down && now_.bus.state != CanBusState::absent) return;
  now_.bus.state = CanBusState::active;
  now_.trouble.clear();
}

// Error frames, and whether the interface is still there.
void CanPublisher::listen() {
  CanFrame frame;
  while (socket_) {
    switch (socket_->receive(frame)) {
      case CanReceiveOutcome::frame:
        note_error_frame(frame, now_.bus);
        break;
      case CanReceiveOutcome::none:
        return;
      case CanReceiveOutcome::down:
        now_.bus.state = CanBusState::down;
        now_.trouble = config_.interface + " is down";
        return;
      case CanReceiveOutcome::gone:
        close(CanBusState::absent, config_.interface + " is gone");
        return;
    }
  }
}

void CanPublisher::open_if_due() {
  if (socket_) return;
  const Clock::time_point now = Clock::now();
  if (now < next_open_) return;
  next_open_ = now + std::chrono::milliseconds(static_cast<std::int64_t>(config_.retry_ms));
  CanSocketOptions options;
  options.interface = config_.interface;
  options.fd = config_.fd;
  options.bit_rate_switch = config_.bit_rate_switch;
  options.receive_data = false;
  auto opened = open_(options);
  if (!opened) {
    close(CanBusState::absent, opened.error().message());
    return;
  }
  socket_.emplace(std::move(opened.value()));
  now_.bus.state = CanBusState::active;
  now_.trouble.clear();
  ++now_.opened;
}

void CanPublisher::close(CanBusState state, const std::string& why) {
  socket_.reset();
  now_.bus.state = state;
  now_.trouble = why;
  drop_rest();  // now: the next set may find it open again
}

void CanPublisher::share() {
  const std::lock_guard lock(mutex_);
  shared_ = now_;
}

CanStatus CanPublisher::status() const {
  const std::lock_guard lock(mutex_);
  return shared_;
}

}  // namespace pelorus
