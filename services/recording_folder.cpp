#include "services/recording_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <string_view>

namespace pelorus {
namespace {

namespace fs = std::filesystem;

Error failure(const fs::path& path, const std::string& what, int reason = errno) {
  return {ErrorCode::io, path.string(), what + ": " + std::strerror(reason), "check rights and free space"};
}

bool write_all(int fd, const void* bytes, std::size_t size) {
  const auto* at = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t written = ::write(fd, at, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    at += written;
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

UniqueFd create_file(const fs::path& path) {
  return UniqueFd(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
}

bool encode(const std::string& extension, const ImageView& picture, std::vector<std::uint8_t>& out) {
  try {
    // Only read by the encoder; cv::Mat has no read-only form.
    const cv::Mat gray(picture.height, picture.width, CV_8U, const_cast<std::uint8_t*>(picture.pixels),
                       static_cast<std::size_t>(picture.stride));
    return cv::imencode("." + extension, gray, out,
                        extension == "png" ? std::vector<int>{cv::IMWRITE_PNG_COMPRESSION, 1} : std::vector<int>{});
  } catch (const cv::Exception&) {
    return false;
  }
}

}  // namespace

bool says_disk_full(const Error& error) {
  return error.detail.ends_with(std::strerror(ENOSPC)) || error.detail.ends_with(std::strerror(EDQUOT));
}

Result<RecordingFolder> RecordingFolder::create(const fs::path& folder, const std::string& extension) {
  RecordingFolder recording;
  recording.folder_ = folder;
  recording.extension_ = extension;
  constexpr std::string_view kHeader = "#timestamp [ns],filename\n";
  for (std::size_t side = 0; side < 2; ++side) {
    const fs::path camera = folder / "mav0" / ("cam" + std::to_string(side));
    std::error_code failed;
    fs::create_directories(camera / "data", failed);
    if (failed) return failure(camera, "cannot be created", failed.value());
    recording.lists_[side] = create_file(camera / "data.csv");
    if (!recording.lists_[side] || !write_all(recording.lists_[side].get(), kHeader.data(), kHeader.size())) {
      return failure(camera / "data.csv", "cannot be written");
    }
    recording.list_bytes_[side] = static_cast<off_t>(kHeader.size());
  }
  return recording;
}

Result<> RecordingFolder::append(Timestamp time, const ImageView& left, const ImageView& right) {
  const std::string stamp = std::to_string(time.ns);
  const std::string name = stamp + "." + extension_;
  std::array<fs::path, 2> files;
  for (std::size_t side = 0; side < 2; ++side) {
    files[side] = folder_ / "mav0" / ("cam" + std::to_string(side)) / "data" / name;
  }
  std::uint64_t bytes = 0;
  const Result<> written = write_pair(files, stamp + "," + name + "\n", left, right, bytes);
  if (written) {
    bytes_ += bytes;
    return written;
  }
  // What is there of the pair helps nobody.
  for (std::size_t side = 0; side < 2; ++side) {
    ::unlink(files[side].c_str());
    if (::ftruncate(lists_[side].get(), list_bytes_[side]) != 0)
      return written;  // the first failure is the one to tell
  }
  return written;
}

// Errors leave parts behind. `bytes`: how many it took.
Result<> RecordingFolder::write_pair(const std::array<fs::path, 2>& files, const std::string& row,
                                     const ImageView& left, const ImageView& right, std::uint64_t& bytes) {
  for (std::size_t side = 0; side < 2; ++side) {
    if (Result<> written = write_picture(files[side], side == 0 ? left : right); !written) return written;
    bytes += encoded_.size() + row.size();
  }
  for (const UniqueFd& list : lists_) {
    if (!write_all(list.get(), row.data(), row.size())) return failure(folder_, "a list cannot be continued");
  }
  for (off_t& length : list_bytes_) length += static_cast<off_t>(row.size());
  return Ok{};
}

Result<> RecordingFolder::write_picture(const fs::path& file, const ImageView& picture) {
  if (!encode(extension_, picture, encoded_)) {
    return Error{ErrorCode::io, file.string(), "the picture cannot be encoded", "record as png or pgm"};
  }
  const UniqueFd fd = create_file(file);
  if (!fd || !write_all(fd.get(), encoded_.data(), encoded_.size())) return failure(file, "cannot be written");
  return Ok{};
}

}  // namespace pelorus
