#include "services/preview.h"

#include <chrono>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "services/overlay.h"

namespace pelorus {
namespace {

constexpr int kWidestPreview_px = 800;

bool encode(const cv::Mat& picture, int quality, std::vector<std::uint8_t>& jpeg) {
  try {
    return cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, quality});
  } catch (const cv::Exception&) {
    return false;
  }
}

cv::Mat scaled(const cv::Mat& picture, double scale) {
  cv::Mat out;
  cv::resize(picture, out, {}, scale, scale, cv::INTER_AREA);
  return out;
}

}  // namespace

PreviewPicture encode_preview(const cv::Mat& picture, Timestamp capture_time, int max_bytes) {
  PreviewPicture out;
  out.capture_time = capture_time;
  cv::Mat small = picture;
  if (picture.cols > kWidestPreview_px) small = scaled(picture, kWidestPreview_px / static_cast<double>(picture.cols));
  for (; small.cols >= 32 && small.rows >= 32; small = scaled(small, 0.5)) {
    for (const int quality : {75, 60, 45, 30}) {
      if (!encode(small, quality, out.jpeg)) break;
      if (out.jpeg.size() > static_cast<std::size_t>(max_bytes)) continue;
      out.width = small.cols;
      out.height = small.rows;
      return out;
    }
  }
  out.jpeg.clear();
  return out;
}

Preview::Preview(const PreviewConfig& config, const StereoRig& rig, Mailbox<PreviewPicture>& ready, Wake& publish_wake,
                 std::function<void()> on_thread_start)
    : config_(config),
      rig_(rig),
      ready_(ready),
      publish_wake_(publish_wake),
      thread_([this, prepare = std::move(on_thread_start)](const std::stop_token& stop) {
        if (prepare) prepare();
        run(stop);
      }) {}

bool Preview::due(Timestamp capture_time) const {
  return requested_.load(std::memory_order_relaxed) || (config_.rate_hz > 0 && capture_time >= next_);
}

void Preview::offer(const ImageView& left, const Publication& publication, std::span<const PointView> points) {
  Subject& subject = subjects_.draft();
  subject.left.assign(left);
  subject.result = publication.result;
  subject.step = publication.step;
  subject.points.assign(points.begin(), points.end());
  if (subjects_.post()) skipped_.add();
  const bool was_requested = requested_.exchange(false, std::memory_order_relaxed);
  if (!was_requested || config_.rate_hz > 0) {
    next_ = publication.result.capture_time + Duration(static_cast<std::int64_t>(1e9 / config_.rate_hz));
  }
  wake_.ring();
}

void Preview::run(const std::stop_token& stop) {
  Overlay overlay(rig_);
  while (!stop.stop_requested()) {
    wake_.wait(std::chrono::milliseconds(100));
    const Subject* subject = subjects_.fetch();
    if (subject == nullptr) continue;
    overlay.observe(subject->result, subject->step);
    try {
      const cv::Mat picture = overlay.draw(subject->left.view(), subject->result, subject->points);
      ready_.draft() = encode_preview(picture, subject->result.capture_time, config_.max_bytes);
    } catch (const cv::Exception&) {
      skipped_.add();
      continue;
    }
    if (ready_.draft().jpeg.empty()) {
      skipped_.add();
      continue;
    }
    if (ready_.post()) skipped_.add();
    publish_wake_.ring();
  }
}

}  // namespace pelorus
