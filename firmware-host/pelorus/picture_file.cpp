#include "firmware-host/pelorus/picture_file.h"

#include <opencv2/imgcodecs.hpp>
#include <string_view>
#include <vector>

#include "firmware-host/runtime/partial_file.h"

namespace pelorus {

Result<> check_picture_name(const std::filesystem::path& path) {
  if (path.extension() != ".png") {
    return Error{ErrorCode::bad_usage, path.string(), "is not the name of a PNG picture", "let it end in .png"};
  }
  // Given up at once: whatever comes until the picture is drawn leaves nothing lying about.
  if (const Result<PartialFile> file = PartialFile::create(path, true); !file) return file.error();
  return Ok{};
}

Result<> write_picture(const std::filesystem::path& path, const cv::Mat& picture) {
  std::vector<std::uint8_t> png;
  try {
    // Low compression: writing pictures must not dwarf the step.
    if (!cv::imencode(".png", picture, png, {cv::IMWRITE_PNG_COMPRESSION, 1}))
      return Error{ErrorCode::io, path.string(), "the picture cannot be made", ""};
  } catch (const cv::Exception& e) {
    return Error{ErrorCode::io, path.string(), "the picture cannot be made: " + e.msg, ""};
  }
  Result<PartialFile> file = PartialFile::create(path, true);
  if (!file) return file.error();
  // The cast that files of bytes ask for.
  file.value().write({reinterpret_cast<const char*>(png.data()), png.size()});
  return file.value().finish();
}

}  // namespace pelorus
