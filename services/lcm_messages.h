#pragma once
// Results as LCM messages: frames, units and rules are those of services/messages/*.lcm. What is unknown becomes NaN
// and a false flag, never a zero or an old value. Pure; allocates (publish thread only).

#include <bot_core/pose_t.hpp>
#include <optional>
#include <pelorus/vis_health_t.hpp>
#include <pelorus/vis_odom_t.hpp>
#include <pelorus/vis_tracks_t.hpp>

#include "services/body_estimate.h"
#include "services/health_report.h"
#include "services/publisher.h"

namespace pelorus {

[[nodiscard]] vis_odom_t odom_message(const Publication& publication, const BodyFrames& frames);
[[nodiscard]] vis_tracks_t tracks_message(const Publication& publication, const BodyFrames& frames);
// None without a pose and a velocity: the message has no flag for what is unknown.
[[nodiscard]] std::optional<bot_core::pose_t> pose_message(const Publication& publication, const BodyFrames& frames);
[[nodiscard]] vis_health_t health_message(const HealthReport& report);

// Nanoseconds to the microseconds of the wire, rounded down.
[[nodiscard]] std::int64_t utime_of(Timestamp time);

}  // namespace pelorus
