#!/usr/bin/env bash
# The CAN output on the kernel's own SocketCAN (vcan, classic and FD) in a virtual machine: what candump (read with the DBC
# by canmatrix) and the autopilot's receiver see is compared with the LCM messages of the same results; then interfaces
# that are absent, down, removed or slow. Needs can-utils, kmod,
# python3-canmatrix and, once, the package user-mode-linux.
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
"$here/uml.sh" -t 150 -m sch_tbf -o "$out" -- "$here/can_guest.sh" "$root/build/bin" "$build/tests" "$out"
/usr/bin/python3 "$here/can_check.py" "$root" "$out"
