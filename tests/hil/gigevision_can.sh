#!/usr/bin/env bash
# gigevision.sh with CAN: two software cameras over GigE Vision, the service, LCM, SocketCAN and the autopilot's receiver,
# all of them processes in user-mode Linux, whose kernel has SocketCAN; there the bus goes down as well. One processor
# without preemption paints, sends and receives the pictures beside the service: small ones, 5 Hz, 150 ms declared.
# usage: gigevision_can.sh [ARGUMENTS of gigevision.sh]
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
for tool in lcm-logger ip; do
  command -v $tool >/dev/null || { echo "gigevision_can.sh: $tool is missing (apt-get install liblcm-bin iproute2)" >&2; exit 77; }
done
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
"$root/build/bin/pelorus" synth "$root/tests/golden/small_dive.yaml" --out "$out/dive" >/dev/null
[ $# -gt 0 ] || set -- -s 40 -f "14 bus can 1" -f "18 bus can 0" -f "24 off left" -f "27 on left"
mkdir "$out/tmp"
"$here/uml.sh" -t 240 -m af_packet -o "$out" -- env TMPDIR="$out/tmp" PELORUS_HIL_INSIDE=1 \
  PELORUS_HIL_SETTINGS='timing: {latency_ms: 150}' "$here/gigevision.sh" -c -r 5 -l 1 "$@" "$out/dive"
