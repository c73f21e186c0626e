#pragma once
// Runs a check once per instruction set that this machine has and the kernels are compiled for, so that no vector path
// goes untested.

#include <gtest/gtest.h>
#include <hwy/highway.h>
#include <hwy/targets.h>

namespace pelorus {

template <class F>
void for_each_target(F&& check) {
  const auto all = static_cast<std::int64_t>(hwy::SupportedTargets()) & HWY_TARGETS;
  ASSERT_NE(all, 0);
  for (std::int64_t left = all; left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    SCOPED_TRACE(hwy::TargetName(target));
    check();
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace pelorus
