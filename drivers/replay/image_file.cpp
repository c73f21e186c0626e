#include "drivers/replay/image_file.h"

#include <algorithm>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string_view>

namespace pelorus {
namespace {

Error unreadable(const std::string& place, std::string detail) {
  return Error{ErrorCode::bad_input, place, std::move(detail),
               "copy the file again from the recording; if it was recorded so, remove it: a missing image only costs "
               "its pair"};
}

// Decoders fill up what is missing, some of them silently: look for the end mark that a complete file has.
bool ends_early(const std::vector<std::uint8_t>& bytes) {
  const std::string_view content(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (content.starts_with("\x89PNG")) return content.rfind("IEND") == std::string_view::npos;
  if (content.starts_with("\xFF\xD8\xFF")) return content.rfind("\xFF\xD9") == std::string_view::npos;
  return false;
}

}  // namespace

Result<> ImageFile::read(const std::filesystem::path& file, Image& out) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) return unreadable(file.string(), "image cannot be opened");
  const std::streamoff size = in.tellg();
  if (size <= 0) return unreadable(file.string(), "image file is empty");
  bytes_.resize(static_cast<std::size_t>(size));
  in.seekg(0);
  if (!in.read(reinterpret_cast<char*>(bytes_.data()), size)) return unreadable(file.string(), "image cannot be read");
  return decode_picture(bytes_, file.string(), out);
}

Result<> decode_picture(const std::vector<std::uint8_t>& bytes, const std::string& place, Image& out) {
  if (ends_early(bytes)) return unreadable(place, "image is truncated (" + std::to_string(bytes.size()) + " bytes)");
  try {
    const cv::Mat gray = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
    if (gray.empty()) return unreadable(place, "image cannot be decoded");
    out.assign({gray.data, gray.cols, gray.rows, static_cast<std::ptrdiff_t>(gray.step[0])});
  } catch (const cv::Exception& e) {
    return unreadable(place, "image cannot be decoded: " + e.err);
  }
  return Ok{};
}

}  // namespace pelorus
