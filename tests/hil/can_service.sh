#!/usr/bin/env bash
# The whole way in user-mode Linux: recorded pictures, pelorusd as a process, SocketCAN and LCM, the autopilot's receiver as
# another process. Every result has to be a set that the autopilot takes, with the numbers that LCM has; then the service is
# stopped, and the autopilot has to notice; on classic CAN, then on CAN FD with bit rate switch. A third run has its bus
# taken down: VIS_HEALTH has to say so at once.
#
# usage: can_service.sh [-n SETS] [-r RATE_HZ] [-l LATENCY_MS] [-d DATASET] [FOLDER_WITH_PROGRAMS [FOLDER_FOR_RECORDINGS]]
#   default: 60 sets at 5 Hz, 200 ms, of a small dive (320x240), which any machine computes in time
set -euo pipefail
sets=60 rate=5 latency=200 dataset=''
while getopts n:r:l:d: option; do
  case $option in
    n) sets=$OPTARG ;;
    r) rate=$OPTARG ;;
    l) latency=$OPTARG ;;
    d) dataset=$(cd "$OPTARG" && pwd) ;;
    *) exit 2 ;;
  esac
done
shift $((OPTIND - 1))
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
bin=$(cd "${1:-$root/build/bin}" && pwd)
out=${2:-$(mktemp -d)}
[ $# -ge 2 ] || trap 'rm -rf "$out"' EXIT
for tool in candump lcm-logger; do
  command -v $tool >/dev/null || { echo "can_service.sh: $tool is missing (apt-get install can-utils liblcm-bin)" >&2; exit 77; }
done

if [ -z "$dataset" ]; then
  dataset=$out/dive
  "$bin/pelorus" synth "$root/tests/golden/small_dive.yaml" --out "$dataset" >/dev/null
fi
cat >"$out/service.yaml" <<YAML
source:
  path: $dataset
  rate_hz: $rate
  repeat: true
timing:
  latency_ms: $latency
  deadline_tolerance_ms: 150
can:
  enabled: true
  interface: vcan0
YAML
printf 'can: {fd: true, bit_rate_switch: true}\n' >"$out/fd.yaml"
: >"$out/classic.yaml"
fd_sets=30
cat >"$out/guest.sh" <<GUEST
ip route add 224.0.0.0/4 dev lo
sent() { cat /sys/class/net/vcan0/statistics/tx_packets; }
# session NAME FRAMES [OPTION OF THE AUTOPILOT]: the service with NAME.yaml until so many frames are on the bus.
session() {
  local until=\$((\$(sent) + \$2))
  lcm-logger -q -f '$out'/\$1.lcm &
  logger=\$!
  candump -L vcan0 >'$out'/\$1.can.log &
  candump=\$!
  '$bin/pelorus' can dump vcan0 --sets --json >'$out'/\$1.sets.json 2>'$out'/\$1.sets.txt &
  dump=\$!
  '$bin/example_autopilot' vcan0 \${@:3} >'$out'/\$1.autopilot.txt &
  autopilot=\$!
  sleep 1
  '$bin/pelorusd' --config '$out/service.yaml' --config '$out'/\$1.yaml >'$out'/\$1.log 2>&1 &
  service=\$!
  until [ "\$(sent)" -ge \$until ] && kill -0 \$service; do sleep 0.5; done
  kill -TERM \$service
  wait \$service
  echo \$? >'$out'/\$1.code
  sleep 2  # the autopilot has to notice
  kill -INT \$logger
  kill -TERM \$autopilot \$candump \$dump
  wait \$logger \$autopilot \$candump \$dump
}
session classic $((sets * 7))  # a set has seven frames
ip link set vcan0 down
ip link set vcan0 mtu 72
ip link set vcan0 up
session fd $fd_sets --fd
lcm-logger -q -f '$out/down.lcm' &
logger=\$!
sleep 1
'$bin/pelorusd' --config '$out/service.yaml' >'$out/down.log' 2>&1 &
service=\$!
before=\$(sent)
until [ "\$(sent)" -ge \$((before + 70)) ] && kill -0 \$service; do sleep 0.1; done
date +%s%N >'$out/down_ns'
ip link set vcan0 down
sleep 2
kill -TERM \$service
wait \$service
kill -INT \$logger
wait
GUEST
"$here/uml.sh" -t $((300 + 2 * sets / rate)) -o "$out" -- bash "$out/guest.sh"

# look NAME SETS: what the session's autopilot took of it, and each of its numbers against LCM.
look() {
  local name=$1 sets=$2 results counts usable
  printf '== %s\n' "$name"
  cat "$out/$name.log"
  head -n 5 "$out/$name.autopilot.txt"
  tail -n 2 "$out/$name.autopilot.txt"
  [ "$(cat "$out/$name.code")" = 0 ] || { echo "FAIL: pelorusd ended with code $(cat "$out/$name.code")"; return 1; }
  results=$(sed -n 's/.*stopped after \([0-9]*\) results.*/\1/p' "$out/$name.log")
  counts=$(tail -n 1 "$out/$name.autopilot.txt")
  usable=${counts%% *}
  [ "${results:-0}" -ge $((sets * 2 / 3)) ] || { echo "FAIL: ${results:-no} results"; return 1; }
  case "$counts" in
    *" $results sets, 0 lost, 0 incomplete, 0 jumps, 0 bad CRC"*) ;;
    *) echo "FAIL: $results results, but $counts"; return 1 ;;
  esac
  [ "$usable" -ge $((results / 2)) ] || { echo "FAIL: only $usable estimates were usable"; return 1; }
  [ "$(tail -n 2 "$out/$name.autopilot.txt" | head -n 1)" = "link TIMEOUT" ] || { echo "FAIL: silence not noticed"; return 1; }
  python3 "$here/can_service_check.py" sets "$out" "$name" "$results" || return 1
  echo "ok: $name: $results results, $results sets, $usable usable, silence noticed"
}
failed=0
look classic "$sets" || failed=1
look fd $fd_sets || failed=1
awk '{print $3}' "$out/fd.can.log" | grep -qE '^12B##[1357-9BDF]' || { echo "FAIL: no FD frame with bit rate switch on the bus"; failed=1; }
python3 "$here/can_service_check.py" down "$out" "$rate" || failed=1
exit $failed
