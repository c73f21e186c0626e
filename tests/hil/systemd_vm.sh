#!/usr/bin/env bash
# The unit under real systemd, process 1 of a virtual machine: what systemd_guest.sh checks. A boot that hangs is tried again.
# usage: systemd_vm.sh [FOLDER_WITH_PROGRAMS]
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
bin=$(cd "${1:-$root/build/bin}" && pwd)
[ -x /lib/systemd/systemd ] || { echo "systemd_vm.sh: no systemd on this machine (apt-get install systemd)" >&2; exit 77; }
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
"$bin/pelorus" synth "$root/tests/golden/small_dive.yaml" --out "$out/dive" >/dev/null
for attempt in 1 2; do
  code=0
  "$here/guest.sh" -S -t 280 -o "$out" -- "$here/systemd_guest.sh" "$bin" || code=$?
  [ $code = 124 ] || [ $code = 125 ] || exit "$code"
  echo "systemd_vm.sh: the guest did not come up (attempt $attempt)" >&2
done
exit "$code"
