#include "firmware-host/pelorus/replay_source.h"

namespace pelorus {

Result<std::unique_ptr<StereoSource>> open_source(const std::string& dataset, const std::string& calibration_file) {
  (void)calibration_file;
  return Error{ErrorCode::unsupported, dataset, "not a data set that can be read", ""};
}

}  // namespace pelorus
