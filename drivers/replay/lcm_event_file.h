#pragma once
// The events of an LCM log (lcm-logger), read without liblcm: header of 28 bytes (sync word, number, time of logging,
// length of channel and of data; big-endian), channel, data. What a crash left broken is skipped to the next sync word.
// Thread-bound; reads one file.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace pelorus {

struct LcmEvent {
  std::string channel;
  std::int64_t data_offset = 0;  // in the file
  std::int32_t data_size = 0;
};

// The numbers of an LCM message in their order; past the end everything is zero and ok() is false.
class LcmReader {
 public:
  LcmReader(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  [[nodiscard]] std::int64_t whole(int bytes);  // signed, big-endian
  // `count` bytes as they are, or nullptr.
  [[nodiscard]] const std::uint8_t* bytes(std::int64_t count);
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

class LcmEventFile {
 public:
  // Whether the file begins like a log.
  [[nodiscard]] static bool is_log(const std::filesystem::path& path);
  [[nodiscard]] static Result<LcmEventFile> open(const std::filesystem::path& path);

  // The next event; false at the end. Data are not read.
  [[nodiscard]] bool next(LcmEvent& event);
  // The first `bytes` of an event's data, or all.
  [[nodiscard]] bool read(const LcmEvent& event, std::vector<std::uint8_t>& data, std::int32_t bytes = INT32_MAX);
  // Bytes that belong to no event.
  [[nodiscard]] std::int64_t skipped_bytes() const { return skipped_; }

 private:
  LcmEventFile() = default;
  [[nodiscard]] bool find_sync();

  std::ifstream file_;
  std::int64_t size_ = 0;
  std::int64_t at_ = 0;
  std::int64_t skipped_ = 0;
};

}  // namespace pelorus
