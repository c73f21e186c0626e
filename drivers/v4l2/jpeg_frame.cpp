#include "drivers/v4l2/jpeg_frame.h"

#include <opencv2/imgcodecs.hpp>

namespace pelorus {

struct JpegFrame::Storage {
  cv::Mat gray;
};

JpegFrame::JpegFrame() : storage_(std::make_unique<Storage>()) {}
JpegFrame::~JpegFrame() = default;

bool JpegFrame::decode(const RawPicture& picture) {
  try {
    // Only read by the decoder; cv::Mat has no read-only form.
    const cv::Mat bytes(1, static_cast<int>(picture.size), CV_8U, const_cast<std::uint8_t*>(picture.bytes));
    cv::imdecode(bytes, cv::IMREAD_GRAYSCALE, &storage_->gray);
  } catch (const cv::Exception&) {
    return false;
  }
  return storage_->gray.cols == picture.width && storage_->gray.rows == picture.height &&
         storage_->gray.type() == CV_8U;
}

RawPicture JpegFrame::gray() const {
  const cv::Mat& m = storage_->gray;
  return {m.data, m.total(), m.cols, m.rows, static_cast<std::ptrdiff_t>(m.step), PixelFormat::gray8};
}

}  // namespace pelorus
