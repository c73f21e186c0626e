#pragma once
// RecordingFolder: stereo pairs on disk in the EuRoC ASL layout (mav0/cam0, mav0/cam1: data.csv, data/<ns>.png), which
// `pelorus replay` reads. A row of a list is written after both pictures are, so that a recording that was broken off
// is whole up to its last row. Thread-bound. Errors name the file and the system's reason.

#include <sys/types.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/base/time.h"
#include "drivers/unique_fd.h"

namespace pelorus {

// Whether that is the reason, of these errors and others that end with the system's words: an Error has no errno.
[[nodiscard]] bool says_disk_full(const Error& error);

class RecordingFolder {
 public:
  // `extension`: "png" or "pgm" (larger, but costs no computing).
  [[nodiscard]] static Result<RecordingFolder> create(const std::filesystem::path& folder,
                                                      const std::string& extension);

  // The whole pair or, on error, nothing of it; after an error the recording is not to be continued.
  [[nodiscard]] Result<> append(Timestamp time, const ImageView& left, const ImageView& right);
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  // Of all pairs; 0 while there is none.
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

 private:
  [[nodiscard]] Result<> write_pair(const std::array<std::filesystem::path, 2>& files, const std::string& row,
                                    const ImageView& left, const ImageView& right, std::uint64_t& bytes);
  [[nodiscard]] Result<> write_picture(const std::filesystem::path& file, const ImageView& picture);

  std::filesystem::path folder_;
  std::string extension_;
  std::array<UniqueFd, 2> lists_;
  std::array<off_t, 2> list_bytes_{};
  std::uint64_t bytes_ = 0;
  std::vector<std::uint8_t> encoded_;
};

}  // namespace pelorus
