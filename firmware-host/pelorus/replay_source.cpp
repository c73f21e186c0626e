#include "firmware-host/pelorus/replay_source.h"

#include "drivers/replay/dataset.h"

namespace pelorus {

Result<std::unique_ptr<StereoSource>> open_source(const std::string& dataset, const std::string& calibration_file) {
  if (!calibration_file.empty())
    return Error{ErrorCode::unsupported, calibration_file, "--calib is not supported yet", ""};
  return open_dataset(dataset);
}

}  // namespace pelorus
