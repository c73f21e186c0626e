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

Error failure(const fs::path& path, const std::string& what) {
  return {ErrorCode::io, path.string(), what + ": " + std::strerror(errno), "check rights and free space"};
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

Result<RecordingFolder> RecordingFolder::create(const fs::path& folder, const std::string& extension) {
  RecordingFolder recording;
  recording.folder_ = folder;
  recording.extension_ = extension;
  constexpr std::string_view kHeader = "#timestamp [ns],filename\n";
  for (int side = 0; side < 2; ++side) {
    const fs::path camera = folder / "mav0" / ("cam" + std::to_string(side));
    std::error_code failed;
    fs::create_directories(camera / "data", failed);
    if (failed) {
      return Error{ErrorCode::io, camera.string(), "cannot be created: " + failed.message(), "check rights and space"};
    }
    recording.lists_[side] = create_file(camera / "data.csv");
    if (!recording.lists_[side] || !write_all(recording.lists_[side].get(), kHeader.data(), kHeader.size())) {
      return failure(camera / "data.csv", "cannot be written");
    }
  }
  return recording;
}

Result<> RecordingFolder::append(Timestamp time, const ImageView& left, const ImageView& right) {
  const std::string stamp = std::to_string(time.ns);
  const std::string name = stamp + "." + extension_;
  for (int side = 0; side < 2; ++side) {
    const fs::path file = folder_ / "mav0" / ("cam" + std::to_string(side)) / "data" / name;
    if (Result<> written = write_picture(file, side == 0 ? left : right); !written) return written;
  }
  const std::string row = stamp + "," + name + "\n";
  for (const UniqueFd& list : lists_) {
    if (!write_all(list.get(), row.data(), row.size())) return failure(folder_, "a list cannot be continued");
    bytes_ += row.size();
  }
  return Ok{};
}

Result<> RecordingFolder::write_picture(const fs::path& file, const ImageView& picture) {
  if (!encode(extension_, picture, encoded_)) {
    return Error{ErrorCode::io, file.string(), "the picture cannot be encoded", "record as png or pgm"};
  }
  const UniqueFd fd = create_file(file);
  if (!fd || !write_all(fd.get(), encoded_.data(), encoded_.size())) {
    const Error error = failure(file, "cannot be written");
    ::unlink(file.c_str());  // half a picture helps nobody
    return error;
  }
  bytes_ += encoded_.size();
  return Ok{};
}

}  // namespace pelorus
