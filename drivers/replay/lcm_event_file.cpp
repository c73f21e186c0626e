#include "drivers/replay/lcm_event_file.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace pelorus {
namespace {

constexpr std::string_view kSync("\xED\xA1\xDA\x01", 4);
constexpr std::size_t kHeaderBytes = 28;
constexpr std::int64_t kLongestChannel = 255;
constexpr std::int64_t kLargestMessage = 1 << 28;

}  // namespace

std::int64_t LcmReader::whole(int bytes) {
  const std::uint8_t* from = this->bytes(bytes);
  if (from == nullptr) return 0;
  std::uint64_t value = (from[0] & 0x80) != 0 ? ~std::uint64_t{0} : 0;
  for (int i = 0; i < bytes; ++i) value = (value << 8) | from[i];
  return static_cast<std::int64_t>(value);
}

const std::uint8_t* LcmReader::bytes(std::int64_t count) {
  if (!ok_ || count < 0 || static_cast<std::size_t>(count) > size_ - at_) {
    ok_ = false;
    return nullptr;
  }
  const std::uint8_t* from = data_ + at_;
  at_ += static_cast<std::size_t>(count);
  return from;
}

bool LcmEventFile::is_log(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  std::array<char, 4> first{};
  std::ifstream file(path, std::ios::binary);
  return file.read(first.data(), first.size()) && std::string_view(first.data(), first.size()) == kSync;
}

Result<LcmEventFile> LcmEventFile::open(const std::filesystem::path& path) {
  LcmEventFile log;
  log.file_.open(path, std::ios::binary | std::ios::ate);
  if (!log.file_) return Error{ErrorCode::io, path.string(), "cannot be read", "check path and rights"};
  log.size_ = log.file_.tellg();
  return log;
}

// Leaves at_ at the next sync word.
bool LcmEventFile::find_sync() {
  std::array<char, 4096> part{};
  while (at_ + static_cast<std::int64_t>(kHeaderBytes) <= size_) {
    file_.clear();
    file_.seekg(at_);
    file_.read(part.data(), part.size());
    const std::string_view content(part.data(), static_cast<std::size_t>(file_.gcount()));
    const std::size_t found = content.find(kSync);
    if (found != std::string_view::npos) {
      skipped_ += static_cast<std::int64_t>(found);
      at_ += static_cast<std::int64_t>(found);
      return true;
    }
    const auto step = static_cast<std::int64_t>(std::max<std::size_t>(content.size(), 4) - 3);
    skipped_ += step;
    at_ += step;
  }
  return false;
}

bool LcmEventFile::next(LcmEvent& event) {
  while (find_sync()) {
    std::array<std::uint8_t, kHeaderBytes> header{};
    file_.clear();
    file_.seekg(at_);
    if (!file_.read(reinterpret_cast<char*>(header.data()), header.size())) return false;
    LcmReader reader(header.data() + 20, 8);
    const std::int64_t channel_bytes = reader.whole(4);
    const std::int64_t data_bytes = reader.whole(4);
    const std::int64_t begin = at_ + static_cast<std::int64_t>(kHeaderBytes);
    const bool sound = channel_bytes >= 0 && channel_bytes <= kLongestChannel && data_bytes >= 0 &&
                       data_bytes <= kLargestMessage && begin + channel_bytes + data_bytes <= size_;
    if (!sound) {
      ++at_;
      ++skipped_;
      continue;
    }
    event.channel.resize(static_cast<std::size_t>(channel_bytes));
    file_.read(event.channel.data(), channel_bytes);
    event.data_offset = begin + channel_bytes;
    event.data_size = static_cast<std::int32_t>(data_bytes);
    at_ = event.data_offset + data_bytes;
    return true;
  }
  return false;
}

bool LcmEventFile::read(const LcmEvent& event, std::vector<std::uint8_t>& data, std::int32_t bytes) {
  data.resize(static_cast<std::size_t>(std::min(bytes, event.data_size)));
  file_.clear();
  file_.seekg(event.data_offset);
  return static_cast<bool>(file_.read(reinterpret_cast<char*>(data.data()), static_cast<std::streamsize>(data.size())));
}

}  // namespace pelorus
