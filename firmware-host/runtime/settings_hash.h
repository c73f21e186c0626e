#pragma once
// Fingerprints of what a run was made with, for logs and messages: equal settings have equal hashes on every computer.
// 16 hexadecimal digits (FNV-1a, 64 bit, over a canonical text). Not for security. Pure.

#include <string>

#include "core/geometry/stereo_calibration.h"
#include "firmware-host/runtime/service_config.h"

namespace pelorus {

[[nodiscard]] std::string config_hash(const ServiceConfig& config);
[[nodiscard]] std::string calibration_hash(const StereoCalibration& calibration);
// The settings that differ from the defaults, "section.key=value" each, for the log at the start.
[[nodiscard]] std::string changed_settings(const ServiceConfig& config);

}  // namespace pelorus
