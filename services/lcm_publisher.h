#pragma once
// LcmPublisher: results, health and previews on the channels <VEHICLE>.VIS_ODOM, .VIS_TRACKS, .POSE_BODY, .VIS_HEALTH,
// .VIS_IMAGE_LEFT. Message contents: services/messages/*.lcm. Thread-bound to the publish thread, which may wait in the
// kernel for LCM's socket; vision never waits for it. Counters for all threads.

#include <memory>
#include <string>
#include <vector>

#include "services/body_estimate.h"
#include "services/lcm_link.h"
#include "services/publisher.h"
#include "services/service_settings.h"

namespace pelorus {

class LcmPublisher final : public Publisher {
 public:
  LcmPublisher(const LcmConfig& config, const Rigid3& T_body_cam);

  void publish(const Publication& publication) override;
  void publish_health(const HealthReport& report) override;
  void publish_preview(const PreviewPicture& picture) override;

  [[nodiscard]] const LcmLink& link() const { return link_; }

 private:
  template <class Message>
  void send(const std::string& channel, const Message& message);

  BodyFrames frames_;
  LcmLink link_;
  std::string odom_, tracks_, pose_, health_, image_;
};

}  // namespace pelorus
