#pragma once
// thumbnails: annotated pictures of a run (OUT/overlay), evenly chosen, scaled down, as data URIs for the page.
// Thread-bound.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pelorus {

struct Thumbnail {
  std::uint64_t seq = 0;
  std::string data_uri;  // JPEG
};

struct Thumbnails {
  std::vector<Thumbnail> pictures;      // ascending seq
  std::vector<std::string> unreadable;  // file names
};

// Empty without pictures.
[[nodiscard]] Thumbnails thumbnails(const std::filesystem::path& overlay_folder, std::size_t limit);

}  // namespace pelorus
