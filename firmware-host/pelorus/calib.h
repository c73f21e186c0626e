#pragma once
// `pelorus calib check` says what a calibration amounts to and draws a rectified pair; `pelorus calib convert` writes
// it in another format.

#include "firmware-host/pelorus/command.h"

namespace pelorus {

[[nodiscard]] Verb add_calib(CLI::App& app);

}  // namespace pelorus
