#include "drivers/can/candump_log.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <optional>

namespace pelorus {
namespace {

constexpr std::uint32_t kErrorFlag = 0x20000000;  // CAN_ERR_FLAG of linux/can.h, which candump prints with the id

Error bad(const std::string& detail) { return Error{ErrorCode::bad_input, "", detail, "a line of candump -L"}; }

std::optional<std::uint64_t> number(std::string_view text, int base) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// "(seconds.microseconds)"
std::optional<Timestamp> parse_time(std::string_view text) {
  if (text.size() < 4 || text.front() != '(' || text.back() != ')') return std::nullopt;
  text = text.substr(1, text.size() - 2);
  const std::size_t dot = text.find('.');
  if (dot == std::string_view::npos || text.size() - dot - 1 != 6) return std::nullopt;
  const auto whole = number(text.substr(0, dot), 10);
  const auto micros = number(text.substr(dot + 1), 10);
  constexpr std::uint64_t kMostSeconds = 9'000'000'000;  // in nanoseconds still an int64
  if (!whole || !micros || *whole > kMostSeconds) return std::nullopt;
  return Timestamp{static_cast<std::int64_t>(*whole * 1'000'000'000 + *micros * 1000)};
}

bool parse_id(std::string_view text, CanFrame& frame) {
  const auto id = number(text, 16);
  if (!id || (text.size() != 3 && text.size() != 8)) return false;
  frame.id = static_cast<std::uint32_t>(*id);
  frame.extended = text.size() == 8;
  if (frame.extended && (frame.id & kErrorFlag) != 0) {
    frame.type = CanFrameType::error;
    frame.extended = false;
    frame.id &= ~kErrorFlag;
  }
  return frame.extended ? frame.id <= 0x1FFFFFFF : frame.type == CanFrameType::error || frame.id <= 0x7FF;
}

bool valid_fd_size(std::size_t size) {
  constexpr std::array<std::size_t, 7> kLong{12, 16, 20, 24, 32, 48, 64};
  return size <= 8 || std::find(kLong.begin(), kLong.end(), size) != kLong.end();
}

bool parse_bytes(std::string_view text, CanFrame& frame) {
  if (text.size() % 2 != 0) return false;
  const std::size_t size = text.size() / 2;
  if (frame.fd ? !valid_fd_size(size) : size > 8) return false;
  for (std::size_t i = 0; i < size; ++i) {
    const auto byte = number(text.substr(2 * i, 2), 16);
    if (!byte) return false;
    frame.bytes[i] = static_cast<std::uint8_t>(*byte);
  }
  frame.size = static_cast<std::uint8_t>(size);
  return true;
}

// "123#1122", "123#R", "123##0112233"
bool parse_frame(std::string_view text, CanFrame& frame) {
  const std::size_t mark = text.find('#');
  if (mark == std::string_view::npos || !parse_id(text.substr(0, mark), frame)) return false;
  std::string_view rest = text.substr(mark + 1);
  if (rest.starts_with('R')) {
    frame.type = CanFrameType::remote;
    return rest.size() <= 2;
  }
  if (rest.starts_with('#')) {
    if (rest.size() < 2 || !number(rest.substr(1, 1), 16)) return false;
    frame.fd = true;
    rest = rest.substr(2);
  }
  return parse_bytes(rest, frame);
}

std::string_view next_word(std::string_view& line) {
  const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
  const std::size_t end = std::min(line.find(' ', begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line = line.substr(end);
  return word;
}

}  // namespace

Result<CandumpEntry> parse_candump_line(std::string_view line) {
  CandumpEntry entry;
  if (line.ends_with('\r')) line.remove_suffix(1);
  const auto time = parse_time(next_word(line));
  if (!time) return bad("no (seconds.microseconds) at the start");
  entry.interface = next_word(line);
  if (entry.interface.empty()) return bad("no interface");
  if (!parse_frame(next_word(line), entry.frame)) return bad("no frame as identifier#bytes");
  entry.frame.time = *time;
  return entry;
}

std::string candump_line(const CanFrame& frame, std::string_view interface) {
  char text[64];
  const std::int64_t micros = frame.time.ns / 1000;
  std::snprintf(text, sizeof text, "(%010lld.%06lld) ", static_cast<long long>(micros / 1'000'000),
                static_cast<long long>(micros % 1'000'000));
  std::string out = text;
  out += interface;
  const bool error = frame.type == CanFrameType::error;
  std::snprintf(text, sizeof text, frame.extended || error ? " %08X#" : " %03X#",
                static_cast<unsigned>(error ? frame.id | kErrorFlag : frame.id));
  out += text;
  if (frame.type == CanFrameType::remote) return out + "R";
  if (frame.fd) out += "#0";
  for (const std::uint8_t byte : frame.payload()) {
    std::snprintf(text, sizeof text, "%02X", byte);
    out += text;
  }
  return out;
}

}  // namespace pelorus
