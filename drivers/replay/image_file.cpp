#include "drivers/replay/image_file.h"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
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

std::size_t big_endian(const std::uint8_t* at) {
  return std::size_t{at[0]} << 24 | std::size_t{at[1]} << 16 | std::size_t{at[2]} << 8 | at[3];
}

// Each chunk of a PNG file (ISO/IEC 15948, 5.3) carries a checksum. libpng would find the same, but prints a line that
// names no file.
std::string png_damage(const std::vector<std::uint8_t>& bytes) {
  constexpr std::size_t kSignature = 8;
  constexpr std::size_t kFrame = 12;  // length, type and checksum around the data
  for (std::size_t at = kSignature; bytes.size() - at >= kFrame;) {
    const std::size_t length = big_endian(&bytes[at]);
    if (length > bytes.size() - at - kFrame) break;
    const std::string_view type(reinterpret_cast<const char*>(&bytes[at + 4]), 4);
    const auto checksum = ::crc32(0, &bytes[at + 4], static_cast<uInt>(length + 4));
    if (checksum != big_endian(&bytes[at + 8 + length])) {
      return "cannot be decoded: wrong checksum at byte " + std::to_string(at);
    }
    if (type == "IEND") return "";
    at += kFrame + length;
  }
  return "is truncated (" + std::to_string(bytes.size()) + " bytes)";
}

// Decoders fill up what is missing, some of them silently: look whether the file is whole. Empty when it is.
std::string damage(const std::vector<std::uint8_t>& bytes) {
  const std::string_view content(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (content.starts_with("\x89PNG\r\n\x1A\n")) return png_damage(bytes);
  if (content.starts_with("\xFF\xD8\xFF") && content.rfind("\xFF\xD9") == std::string_view::npos)
    return "is truncated (" + std::to_string(bytes.size()) + " bytes)";
  return "";
}

}  // namespace

Result<> ImageFile::read(const std::filesystem::path& file, Image& out) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) return unreadable(file.string(), std::string("image cannot be opened: ") + std::strerror(errno));
  const std::streamoff size = in.tellg();
  if (size <= 0) return unreadable(file.string(), "image file is empty");
  bytes_.resize(static_cast<std::size_t>(size));
  in.seekg(0);
  if (!in.read(reinterpret_cast<char*>(bytes_.data()), size)) return unreadable(file.string(), "image cannot be read");
  return decode_picture(bytes_, file.string(), out);
}

Result<> decode_picture(const std::vector<std::uint8_t>& bytes, const std::string& place, Image& out) {
  if (const std::string found = damage(bytes); !found.empty()) return unreadable(place, "image " + found);
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
