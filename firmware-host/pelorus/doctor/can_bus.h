#pragma once
// The autopilot's bus: whether the configured interface is there, up, of the right format, and at which bit rate. Pure.

#include "drivers/can/can_link.h"
#include "firmware-host/pelorus/doctor/host_check.h"
#include "services/can/can_settings.h"

namespace pelorus {

[[nodiscard]] HostCheck judge_can(const CanConfig& config, const CanLink& link);

}  // namespace pelorus
