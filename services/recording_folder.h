#pragma once
// RecordingFolder: stereo pairs on disk in the EuRoC ASL layout (mav0/cam0, mav0/cam1: data.csv, data/<ns>.png), which
// `pelorus replay` reads. A row of a list is written after both pictures are, so that a recording that was broken off
// is whole up to its last row. Thread-bound. Errors name the file and the system's reason.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/base/time.h"
#include "drivers/unique_fd.h"

namespace pelorus {

class RecordingFolder {
 public:
  // `extension`: "png" or "pgm" (larger, but costs no computing).
  [[nodiscard]] static Result<RecordingFolder> create(const std::filesystem::path& folder,
                                                      const std::string& extension);

  [[nodiscard]] Result<> append(Timestamp time, const ImageView& left, const ImageView& right);
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

 private:
  [[nodiscard]] Result<> write_picture(const std::filesystem::path& file, const ImageView& picture);

  std::filesystem::path folder_;
  std::string extension_;
  UniqueFd lists_[2];
  std::uint64_t bytes_ = 0;
  std::vector<std::uint8_t> encoded_;
};

}  // namespace pelorus
