#pragma once
// goals_of: what a data set says its errors are held to: a scene's own goals, or goals.yaml in mav0 of an EuRoC folder
// or beside a KITTI recording. None where nothing says so. Errors name file and line. Thread-bound.

#include <string>

#include "core/base/result.h"
#include "drivers/synthetic/goals.h"

namespace pelorus {

using synthetic::Goals;

[[nodiscard]] Result<Goals> goals_of(const std::string& dataset);

}  // namespace pelorus
