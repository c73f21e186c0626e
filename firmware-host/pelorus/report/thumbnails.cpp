#include "firmware-host/pelorus/report/thumbnails.h"

#include <algorithm>
#include <charconv>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace pelorus {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth_px = 480;
constexpr int kJpegQuality = 70;

std::string base64(const std::vector<std::uint8_t>& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t triple = 0;
    for (std::size_t k = 0; k < 3; ++k) triple = triple << 8 | (i + k < bytes.size() ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : kDigits[triple >> (18 - 6 * k) & 63U];
    }
  }
  return text;
}

// Pictures are named after their frame's seq.
std::optional<std::uint64_t> seq_of(const fs::path& path) {
  const std::string stem = path.stem().string();
  std::uint64_t seq = 0;
  const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), seq);
  if (path.extension() != ".png" || error != std::errc() || end != stem.data() + stem.size()) return std::nullopt;
  return seq;
}

std::optional<std::string> data_uri(const fs::path& path) {
  try {
    const cv::Mat picture = cv::imread(path.string(), cv::IMREAD_COLOR);
    if (picture.empty()) return std::nullopt;
    const double scale = std::min(1.0, static_cast<double>(kWidth_px) / picture.cols);
    cv::Mat small;
    cv::resize(picture, small, {}, scale, scale, cv::INTER_AREA);
    std::vector<std::uint8_t> bytes;
    if (!cv::imencode(".jpg", small, bytes, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality})) return std::nullopt;
    return "data:image/jpeg;base64," + base64(bytes);
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
}

}  // namespace

Thumbnails thumbnails(const fs::path& overlay_folder, std::size_t limit) {
  std::vector<std::pair<std::uint64_t, fs::path>> files;
  std::error_code error;
  for (fs::directory_iterator entry(overlay_folder, error), end; !error && entry != end; entry.increment(error)) {
    if (const auto seq = seq_of(entry->path())) files.emplace_back(*seq, entry->path());
  }
  std::sort(files.begin(), files.end());
  Thumbnails result;
  const std::size_t count = std::min(limit, files.size());
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [seq, path] = files[count == 1 ? 0 : i * (files.size() - 1) / (count - 1)];
    if (std::optional<std::string> uri = data_uri(path)) {
      result.pictures.push_back({seq, std::move(*uri)});
    } else {
      result.unreadable.push_back(path.filename().string());
    }
  }
  return result;
}

}  // namespace pelorus
