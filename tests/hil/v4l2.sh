#!/usr/bin/env bash
# The V4L2 driver against the kernel's virtual cameras (vivid) in a virtual machine, where no test may skip. A boot that
# hangs is tried again.
# usage: v4l2.sh [BUILD_FOLDER]
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$(cd "${1:-$here/../../build/release}" && pwd)
for attempt in 1 2; do
  code=0
  "$here/guest.sh" -t 240 -- env PELORUS_NO_SKIPS=1 "$build/tests/v4l2_v4l2_camera_test" --gtest_brief=1 || code=$?
  [ $code = 124 ] || [ $code = 125 ] || exit "$code"
  echo "v4l2.sh: the guest did not come up (attempt $attempt)" >&2
done
exit "$code"
