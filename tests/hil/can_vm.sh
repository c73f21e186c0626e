#!/usr/bin/env bash
# The CAN output on the kernel's own SocketCAN (vcan, classic and FD) in a virtual machine: what candump (read with the DBC
# by canmatrix) and the autopilot's receiver see is compared with the LCM messages of the same results; then interfaces
# that are absent, down, removed or slow. A boot that hangs is tried again. Needs can-utils, python3-canmatrix.
# usage: can_vm.sh [BUILD_FOLDER [FOLDER_FOR_RECORDINGS]]
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
build=$(cd "${1:-$root/build/release}" && pwd)
out=${2:-$(mktemp -d)}
[ $# -ge 2 ] || trap 'rm -rf "$out"' EXIT
for tool in candump tc; do
  PATH=$PATH:/sbin:/usr/sbin command -v $tool >/dev/null || {
    echo "can_vm.sh: $tool is missing (apt-get install can-utils iproute2)" >&2
    exit 77
  }
done
for attempt in 1 2; do
  code=0
  "$here/guest.sh" -t 300 -o "$out" -m sch_netem -- \
    "$here/can_guest.sh" "$root/build/bin" "$build/tests" /out || code=$?
  [ "$code" = 124 ] || [ "$code" = 125 ] || break
  echo "can_vm.sh: the guest did not come up (attempt $attempt)" >&2
done
[ "$code" = 0 ] || exit "$code"
/usr/bin/python3 "$here/can_check.py" "$root" "$out"
