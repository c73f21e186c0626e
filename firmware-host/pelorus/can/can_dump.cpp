#include "firmware-host/pelorus/can/can_dump.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "drivers/can/can_socket.h"
#include "drivers/can/candump_log.h"
#include "firmware-host/pelorus/replay/replay_interrupt.h"

namespace pelorus {
namespace {

constexpr int kBadInputExitCode = 3;

bool is_finished(const CanDumpOptions& options, const CanDump& dump) {
  return ReplayInterrupt::requested() || std::ferror(stdout) != 0 ||
         (options.count > 0 && dump.lines() >= options.count);
}

// Every readable line is shown; the ones that are none are counted, the first is named.
int read_log(std::istream& in, const CanDumpOptions& options, CanDump& dump) {
  std::string line;
  for (std::uint64_t number = 1; !is_finished(options, dump) && std::getline(in, line); ++number) {
    if (line.empty()) continue;
    const auto entry = parse_candump_line(line);
    if (entry) {
      dump.take(entry.value().frame);
      continue;
    }
    if (dump.counts().bad_lines == 0) {
      std::fprintf(stderr, "pelorus: %s:%llu: %s\n", options.source.c_str(), static_cast<unsigned long long>(number),
                   entry.error().detail.c_str());
    }
    dump.note_bad_line();
  }
  return dump.counts().bad_lines > 0 ? kBadInputExitCode : 0;
}

// Out of a recording something has to come: one of which nothing does is the wrong file, or what is left of one.
Result<int> judge_log(const CanDumpOptions& options, const CanDumpCounts& counts, int code) {
  if (code != 0 || counts.frames > 0 || ReplayInterrupt::requested()) return code;
  if (counts.bad > 0) {
    return Error{ErrorCode::bad_input, options.source,
                 "no frame of the contract is whole, of " + std::to_string(counts.bad), "record it anew: candump -l"};
  }
  if (counts.foreign + counts.error_frames > 0) return code;
  return Error{ErrorCode::bad_input, options.source, "holds no frame", "is it the log of candump -l or -L?"};
}

// FD when the interface offers it: then both formats arrive.
Result<CanSocket> open_bus(const CanDumpOptions& options) {
  CanSocketOptions socket;
  socket.interface = options.source;
  socket.fd = true;
  auto both = CanSocket::open(socket);
  if (both) return both;
  socket.fd = false;
  return CanSocket::open(socket);
}

Result<int> read_bus(const CanDumpOptions& options, CanDump& dump) {
  auto socket = open_bus(options);
  if (!socket) {
    Error error = socket.error();
    error.detail += " (and no file of that name)";
    return error;
  }
  using Clock = std::chrono::steady_clock;
  const Clock::time_point end = Clock::now() + std::chrono::microseconds(std::llround(options.seconds * 1e6));
  while (!is_finished(options, dump) && (options.seconds <= 0 || Clock::now() < end)) {
    pollfd ready{socket.value().descriptor(), POLLIN, 0};
    (void)::poll(&ready, 1, 50);
    CanFrame frame;
    CanReceiveOutcome outcome = CanReceiveOutcome::none;
    while (!is_finished(options, dump) && (outcome = socket.value().receive(frame)) == CanReceiveOutcome::frame) {
      dump.take(frame);
    }
    if (outcome == CanReceiveOutcome::gone)
      return Error{ErrorCode::device, options.source, "the interface is gone", ""};
  }
  return 0;
}

pelorus_can_receiver started(const CanDumpOptions& options, bool fd) {
  pelorus_can_config config = pelorus_can_default_config();
  config.base_id = options.base_id;
  config.fd = fd;
  pelorus_can_receiver receiver;
  pelorus_can_start(&receiver, &config);
  return receiver;
}

std::string receiver_text(const char* transport, const pelorus_can_counts& c) {
  return std::string(transport) + ": " + std::to_string(c.sets) + " sets, " + std::to_string(c.lost) + " lost, " +
         std::to_string(c.incomplete) + " incomplete, " + std::to_string(c.jumps) + " jumps, " +
         std::to_string(c.repeated) + " repeated frames, " + std::to_string(c.timeouts) + " timeouts\n";
}

}  // namespace

CanDump::CanDump(const CanDumpOptions& options, std::FILE* out)
    : options_(options), out_(out), classic_(started(options, false)), fd_(started(options, true)) {}

void CanDump::print(const std::string& line) {
  if (options_.count > 0 && lines_ >= options_.count) return;
  std::fprintf(out_, "%s\n", line.c_str());
  ++lines_;
}

void CanDump::take(const CanFrame& frame) {
  if (frame.type == CanFrameType::error) {
    ++counts_.error_frames;
    print(frame_text(frame, options_.base_id, options_.json));
    return;
  }
  CanEstimate ignored;
  switch (decode_frame(frame, options_.base_id, ignored).outcome) {
    case CanDecodeOutcome::not_ours:
      ++counts_.foreign;
      return;
    case CanDecodeOutcome::ok:
      ++counts_.frames;
      break;
    case CanDecodeOutcome::bad_size:
    case CanDecodeOutcome::bad_crc:
      ++counts_.bad;
      if (options_.sets) print(frame_text(frame, options_.base_id, options_.json));
      break;
  }
  if (!options_.sets) print(frame_text(frame, options_.base_id, options_.json));
  feed(frame.fd ? fd_ : classic_, frame);
}

void CanDump::feed(pelorus_can_receiver& receiver, const CanFrame& frame) {
  const auto now_us = static_cast<std::uint64_t>(std::max<std::int64_t>(0, frame.time.ns / 1000));
  const pelorus_can_event event = pelorus_can_receive(&receiver, frame.id, frame.bytes.data(), frame.size, now_us);
  if (event != PELORUS_CAN_SET && event != PELORUS_CAN_SET_JUMP) return;
  if (options_.sets) print(set_text(receiver.estimate, receiver.link, options_.json));
}

std::string CanDump::summary() const {
  std::string out = std::to_string(counts_.frames) + " frames of the contract, " + std::to_string(counts_.bad) +
                    " damaged, " + std::to_string(counts_.foreign) + " foreign, " +
                    std::to_string(counts_.error_frames) + " error frames\n";
  if (classic_.counts.frames > 0) out += receiver_text("classic", classic_.counts);
  if (fd_.counts.frames > 0) out += receiver_text("FD", fd_.counts);
  if (counts_.bad_lines > 0) out += std::to_string(counts_.bad_lines) + " lines that are none of candump\n";
  return out;
}

Result<int> run_can_dump(const CanDumpOptions& options) {
  const ReplayInterrupt interrupt;
  CanDump dump(options, stdout);
  Result<int> outcome = 0;
  std::error_code ignored;
  if (options.source == "-") {
    outcome = judge_log(options, dump.counts(), read_log(std::cin, options, dump));
  } else if (std::filesystem::exists(options.source, ignored)) {
    std::ifstream log(options.source);
    if (!log || std::filesystem::is_directory(options.source, ignored))
      return Error{ErrorCode::io, options.source, "cannot be read", "a log of candump -l or -L"};
    outcome = judge_log(options, dump.counts(), read_log(log, options, dump));
  } else {
    outcome = read_bus(options, dump);
  }
  std::fflush(stdout);
  if (outcome || dump.counts().bad > 0) std::fputs(dump.summary().c_str(), stderr);
  return outcome;
}

}  // namespace pelorus
