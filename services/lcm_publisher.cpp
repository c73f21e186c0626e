#include "services/lcm_publisher.h"

#include <bot_core/image_t.hpp>
#include <lcm/lcm-cpp.hpp>

#include "services/lcm_messages.h"

namespace pelorus {

LcmPublisher::LcmPublisher(const LcmConfig& config, const Rigid3& T_body_cam)
    : frames_(T_body_cam),
      link_(config.url),
      odom_(config.vehicle + ".VIS_ODOM"),
      tracks_(config.vehicle + ".VIS_TRACKS"),
      pose_(config.vehicle + ".POSE_BODY"),
      health_(config.vehicle + ".VIS_HEALTH"),
      image_(config.vehicle + ".VIS_IMAGE_LEFT") {}

template <class Message>
void LcmPublisher::send(const std::string& channel, const Message& message) {
  lcm::LCM* connection = link_.connection();
  link_.note(connection != nullptr && connection->publish(channel, &message) == 0);
}

void LcmPublisher::publish(const Publication& publication) {
  send(odom_, odom_message(publication, frames_));
  send(tracks_, tracks_message(publication, frames_));
  // pose_t has no flag: who reads its velocity believes it. So nothing is said until there is one.
  if (const auto pose = pose_message(publication, frames_)) send(pose_, *pose);
}

void LcmPublisher::publish_health(const HealthReport& report) { send(health_, health_message(report)); }

void LcmPublisher::publish_preview(const PreviewPicture& picture) {
  bot_core::image_t message{};
  message.utime = utime_of(picture.capture_time);
  message.width = picture.width;
  message.height = picture.height;
  message.row_stride = 0;
  message.pixelformat = bot_core::image_t::PIXEL_FORMAT_MJPEG;
  message.size = static_cast<std::int32_t>(picture.jpeg.size());
  message.data = picture.jpeg;
  send(image_, message);
}

}  // namespace pelorus
