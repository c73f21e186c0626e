#pragma once
// ImageFile: decodes one picture file after the other to 8-bit gray. Thread-bound; the file's bytes are kept in a
// buffer that is reused. Broken files are Errors that name the file; no exception of the decoder leaves.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"

namespace pelorus {

class ImageFile {
 public:
  // 16-bit pictures are reduced to 8 bit, color to gray.
  [[nodiscard]] Result<> read(const std::filesystem::path& file, Image& out);

 private:
  std::vector<std::uint8_t> bytes_;
};

// A picture file's content already in memory; `place` goes into the Error.
[[nodiscard]] Result<> decode_picture(const std::vector<std::uint8_t>& bytes, const std::string& place, Image& out);

}  // namespace pelorus
