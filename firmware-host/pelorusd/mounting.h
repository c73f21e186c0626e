#pragma once
// Where the rectified left camera sits in the vehicle: from the configuration, else from the calibration, else assumed.
// Pure.

#include <string>

#include "core/geometry/rectifier.h"
#include "services/service_settings.h"

namespace pelorus {

struct Mounting {
  Rigid3 T_body_cam = Rigid3::Identity();
  std::string origin;  // one sentence for the log
};

[[nodiscard]] Mounting mounting_of(const MountingConfig& config, const Rectifier& rectifier, bool body_known);

}  // namespace pelorus
