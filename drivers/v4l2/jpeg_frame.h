#pragma once
// JpegFrame: one picture of a Motion JPEG stream as 8-bit gray. Keeps its storage; the decoder itself allocates.
// Thread-bound; no exception of the decoder leaves.

#include <memory>

#include "drivers/pixel_format.h"

namespace pelorus {

class JpegFrame {
 public:
  JpegFrame();
  ~JpegFrame();
  // False: broken, or of another size than the stream's.
  [[nodiscard]] bool decode(const RawPicture& picture);
  // The decoded picture; valid until the next decode().
  [[nodiscard]] RawPicture gray() const;

 private:
  struct Storage;
  std::unique_ptr<Storage> storage_;
};

}  // namespace pelorus
