#pragma once
// Preview: now and then the left picture with what the system believes drawn in, as a JPEG small enough for one
// datagram. Drawn and encoded on a thread of its own at low priority; vision only copies the picture, and only when the
// thread is idle. offer() and due(): vision thread. Output: a mailbox that the publish thread empties.

#include <functional>
#include <opencv2/core.hpp>
#include <span>
#include <stop_token>
#include <thread>
#include <vector>

#include "core/base/counter.h"
#include "core/base/mailbox.h"
#include "services/publisher.h"
#include "services/wake.h"

namespace pelorus {

struct PreviewConfig {
  double rate_hz = 1;
  int max_bytes = 60000;
};

// JPEG of at most max_bytes: smaller quality first, then a smaller picture. Empty when that cannot be done.
[[nodiscard]] PreviewPicture encode_preview(const cv::Mat& picture, Timestamp capture_time, int max_bytes);

class Preview {
 public:
  // `ready` receives the pictures, `publish_wake` is rung then; both borrowed.
  Preview(const PreviewConfig& config, const StereoRig& rig, Mailbox<PreviewPicture>& ready, Wake& publish_wake,
          std::function<void()> on_thread_start = {});

  // Vision: whether a picture of this time is wanted, by the rate or by a request.
  [[nodiscard]] bool due(Timestamp capture_time) const;
  void offer(const ImageView& left, const Publication& publication, std::span<const PointView> points);
  // Any thread: the next picture, whatever the rate.
  void request() { requested_.store(true, std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t skipped() const { return skipped_.value(); }

 private:
  struct Subject {
    Image left;
    FrameResult result;
    Duration step{};
    std::vector<PointView> points;
  };
  void run(const std::stop_token& stop);

  PreviewConfig config_;
  StereoRig rig_;
  Mailbox<Subject> subjects_;
  Mailbox<PreviewPicture>& ready_;
  Wake& publish_wake_;
  Wake wake_;
  Timestamp next_;
  std::atomic<bool> requested_{false};
  Counter skipped_;
  std::jthread thread_;  // last: everything above is ready when it starts
};

}  // namespace pelorus
