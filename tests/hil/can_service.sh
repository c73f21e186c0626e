#!/usr/bin/env bash
# The whole way in user-mode Linux: recorded pictures, pelorusd as a process, SocketCAN, the autopilot's receiver as another.
# Every result has to be a set that the autopilot takes; then the service is stopped, and the autopilot has to notice.
# usage: can_service.sh [FOLDER_WITH_PROGRAMS [FOLDER_FOR_RECORDINGS]]
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
bin=$(cd "${1:-$root/build/bin}" && pwd)
out=${2:-$(mktemp -d)}
[ $# -ge 2 ] || trap 'rm -rf "$out"' EXIT

"$bin/pelorus" synth "$root/tests/golden/small_dive.yaml" --out "$out/dive" >/dev/null
cat >"$out/service.yaml" <<YAML
source:
  path: $out/dive
  rate_hz: 5
  repeat: true
timing:
  latency_ms: 200
  deadline_tolerance_ms: 150
lcm:
  enabled: false
can:
  enabled: true
  interface: vcan0
YAML
cat >"$out/guest.sh" <<GUEST
candump -L vcan0 >'$out/can.log' &
candump=\$!
'$bin/example_autopilot' vcan0 --seconds 20 >'$out/autopilot.txt' &
autopilot=\$!
timeout -s TERM 15 '$bin/pelorusd' --config '$out/service.yaml' >'$out/service.log' 2>&1 || true
wait \$autopilot
kill -TERM \$candump
wait
GUEST
"$here/uml.sh" -t 90 -o "$out" -- bash "$out/guest.sh"

cat "$out/service.log"
head -n 5 "$out/autopilot.txt"
tail -n 2 "$out/autopilot.txt"
results=$(sed -n 's/.*stopped after \([0-9]*\) results.*/\1/p' "$out/service.log")
counts=$(tail -n 1 "$out/autopilot.txt")
usable=${counts%% *}
[ "${results:-0}" -ge 40 ] || { echo "FAIL: ${results:-no} results"; exit 1; }
case "$counts" in
  *" $results sets, 0 lost, 0 incomplete, 0 jumps, 0 bad CRC"*) ;;
  *) echo "FAIL: $results results, but $counts"; exit 1 ;;
esac
[ "$usable" -ge $((results / 2)) ] || { echo "FAIL: only $usable estimates were usable"; exit 1; }
[ "$(tail -n 2 "$out/autopilot.txt" | head -n 1)" = "link TIMEOUT" ] || { echo "FAIL: silence not noticed"; exit 1; }
echo "ok: $results results, $results sets, $usable usable, silence noticed"
