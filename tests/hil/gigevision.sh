#!/usr/bin/env bash
# The whole service over real protocols, each part a process of its own: recorded pairs as two GigE Vision cameras
# (gv_cameras) -> pelorusd -> LCM -> lcm-logger, in a network of its own on this machine. Prints what the listener saw and
# checks, by what the cameras say they took, that every exposure without a result was counted with its cause; without
# faults that the poses are those of `pelorus replay` of the same pairs, with faults that each is told as a state.
#
# usage: gigevision.sh [-s SECONDS] [-r RATE_HZ] [-b BUILD_FOLDER] [-l MAX_LOST_SHARE] [-k FOLDER] [-c]
#                      [-f "SECOND COMMAND"]... [DATASET]
#   -k  keeps the log and what was played in a new FOLDER
#   -c  also CAN on vcan0, with the autopilot's receiver as a process, each set compared with LCM
#   -f  a fault, e.g. "5 off left": a line for gv_cameras at that second; or of what is around the service:
#       hold service (SIGSTOP for 300 ms), route lcm 1|0 (gone), bus can 1|0 (down), disk recorder 1|0 (full);
#       record service 1|0 starts and stops the recorder
#   DATASET  an EuRoC folder, which also brings the calibration; default: 60 pairs rendered into out/hil/dive
# Exit code: 0 good, 1 results are missing, 77 when a part is not there.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
if [ -z "${PELORUS_HIL_INSIDE:-}" ]; then
  private=(unshare -rnm)
  [ "$(id -u)" -ne 0 ] || private=(unshare -nm)
  "${private[@]}" true 2>/dev/null || { echo "gigevision.sh: no private network: unshare is not permitted" >&2; exit 77; }
  PELORUS_HIL_INSIDE=1 exec "${private[@]}" "${BASH_SOURCE[0]}" "$@"
fi
seconds=20 rate=20 build=$root/build/release max_lost=0.05 keep='' can='' faults=() listeners=()
while getopts s:r:b:l:k:cf: option; do
  case $option in
    s) seconds=$OPTARG ;;
    r) rate=$OPTARG ;;
    b) build=$OPTARG ;;
    l) max_lost=$OPTARG ;;
    k) keep=$OPTARG ;;
    c) can=vcan0 ;;
    f) faults+=("$OPTARG") ;;
    *) exit 2 ;;
  esac
done
shift $((OPTIND - 1))
[ $# -le 1 ] || { sed -n '2,17p' "${BASH_SOURCE[0]}" >&2; exit 2; }
programs=$root/build/bin dataset=${1:-$root/out/hil/dive}
if [ $# -eq 0 ] && [ ! -d "$dataset" ]; then
  "$programs/pelorus" synth paper --frames 60 --out "$dataset"
fi
pelorusd=${PELORUSD:-$programs/pelorusd}
# How far a pose may be from the stepped one. Live, the background window's answer enters when it is ready, stepped always
# with the next pair: where a step was late the two go different ways by a share of their own uncertainty.
tolerance_m=${PELORUS_HIL_TOLERANCE_M:-0.004} tolerance_deg=${PELORUS_HIL_TOLERANCE_DEG:-0.05}
for part in "$pelorusd" "$build/tests/gv_cameras" "$(command -v lcm-logger || echo lcm-logger)"; do
  [ -x "$part" ] || { echo "gigevision.sh: $part is not there" >&2; exit 77; }
done

ip link set lo up
ip address add 127.0.1.2/8 dev lo
ip route add 224.0.0.0/4 dev lo
if [ -n "$can" ]; then
  ip link show "$can" >/dev/null 2>&1 || ip link add "$can" type vcan || { echo "gigevision.sh: this kernel has no vcan (gigevision_can.sh)" >&2; exit 77; }
  ip link set "$can" up
fi

if [ -n "$keep" ]; then
  mkdir "$keep"
  work=$(cd "$keep" && pwd)
else
  work=$(mktemp -d)
fi
started=()
finish() {
  exec 3>&- || true
  [ ${#started[@]} -eq 0 ] || kill "${started[@]}" 2>/dev/null || true
  wait || true
  ! mountpoint -q "$work/recordings" || umount "$work/recordings"
  [ -n "$keep" ] || rm -rf "$work"
}
trap finish EXIT
cat >"$work/pelorus.yaml" <<YAML
source:
  kind: aravis
  calibration: $dataset
camera:
  packet_bytes: ${PELORUS_HIL_PACKET_BYTES:-1400}
  left: 127.0.0.1
  right: 127.0.1.2
  rate_hz: $rate
  clock: ptp
  tolerance_ms: ${PELORUS_HIL_TOLERANCE_MS:-2}
mounting:
  given: true
recorder:
  folder: $work/recordings
  format: pgm
  min_free_gb: 0.1
${can:+can: {enabled: true, interface: $can\}}
${PELORUS_HIL_SETTINGS:-}
YAML

# What happens around the service, written down as gv_cameras writes down its own.
note() { echo "obeyed $(date +%s%N) $*" >>"$work/around.txt"; }
hold_service() {
  note hold service 1
  kill -STOP $service
  sleep 0.3
  note hold service 0
  kill -CONT $service
}
size_of_disk() { mount -o "remount,size=$1" "$work/recordings"; }
happen() {
  case $1 in
    "hold service") hold_service & ;;
    "record service 1") "$programs/pelorus" command record_start ;;
    "record service 0") "$programs/pelorus" command record_stop ;;
    "route lcm 1") note "$1" && ip route del 224.0.0.0/4 dev lo ;;
    "route lcm 0") ip route add 224.0.0.0/4 dev lo && note "$1" ;;
    "bus can 1") note "$1" && ip link set "$can" down ;;
    "bus can 0") ip link set "$can" up && note "$1" ;;
    "disk recorder 1") note "$1" && size_of_disk "$(($(df --output=used -B1 "$work/recordings" | tail -n 1) + 50000000))" ;;
    "disk recorder 0") size_of_disk 600m && note "$1" ;;
    *) echo "$1" >&3 ;;
  esac
}
# The recorder's disk is a small one of its own, so that it can be filled.
mkdir "$work/recordings"
case " ${faults[*]-} " in
  *" disk recorder "*) mount -t tmpfs -o size=600m recordings "$work/recordings" ;;
esac

# Cameras are hardware: no other program of this machine keeps them from firing.
as_hardware=(chrt -f 60)
"${as_hardware[@]}" true 2>/dev/null || as_hardware=()
mkfifo "$work/commands"
${as_hardware[@]+"${as_hardware[@]}"} "$build/tests/gv_cameras" "$dataset" 127.0.0.1 127.0.1.2 "$rate" "$work/shown.csv" <"$work/commands" >"$work/cameras.txt" &
started+=($!)
exec 3>"$work/commands"
for _ in $(seq 600); do
  ! grep -q ready "$work/cameras.txt" || break
  kill -0 "${started[0]}" || exit 1
  sleep 0.1
done
lcm-logger -q -f "$work/log.lcm" &
logger=$!
started+=("$logger")
if [ -n "$can" ]; then
  "$programs/pelorus" can dump "$can" --sets --json >"$work/log.sets.json" 2>"$work/sets.txt" 3>&- &
  listeners+=($!)
  "$programs/example_autopilot" "$can" >"$work/autopilot.txt" 3>&- &
  listeners+=($!)
  started+=("${listeners[@]}")
  sleep 1
fi
"$pelorusd" --config "$work/pelorus.yaml" >"$work/service.log" 2>&1 &
service=$!
started+=("$service")
for second in $(seq "$seconds"); do
  sleep 1
  for fault in ${faults[@]+"${faults[@]}"}; do
    if [ "${fault%% *}" = "$second" ]; then
      echo "second $second: ${fault#* }"
      happen "${fault#* }"
    fi
  done
done
failed=0
stopped_ns=$(date +%s%N)
kill -TERM $service
wait $service || { echo "FAIL: pelorusd ended with code $?"; failed=1; }
echo "the service stopped within $((($(date +%s%N) - stopped_ns) / 1000000)) ms"
kill -INT $logger
wait $logger || true
if [ -n "$can" ]; then
  sleep 1 # the autopilot has to notice the silence
  kill "${listeners[@]}"
  wait "${listeners[@]}" || true
fi
log=$(find "$work" -name "log.lcm*" | head -1)
exec 3>&-
wait "${started[0]}" || true
cat "$work/service.log" "$work/cameras.txt"

check() {
  python3 "$root/tests/hil/gv_check.py" "$@" || { echo "FAIL: $1"; failed=1; }
}
python3 "$root/tests/hil/lcm_check.py" --max-lost "$max_lost" --least-results "$((seconds * rate / 4))" "$log" || failed=1
check drops "$log" "$work/shown.csv" "$rate" "$stopped_ns"
if [ ${#faults[@]} -gt 0 ]; then
  touch "$work/around.txt"
  check faults "$log" "$work/shown.csv" "$rate" "$work"
else
  check played "$log" "$work/shown.csv" "$rate" "$dataset" "$work/played"
  # Code 3: pairs are missing, those that a software camera did not take; by how many was judged above.
  "$programs/pelorus" replay "$work/played" --config "$work/pelorus.yaml" --out "$work/replayed" >"$work/replay.txt" 2>&1 ||
    [ $? = 3 ] || {
    cat "$work/replay.txt"
    failed=1
  }
  check poses "$log" "$work/replayed" "$tolerance_m" "$tolerance_deg"
fi
[ -z "$can" ] || python3 "$root/tests/hil/can_service_check.py" live "$work" || failed=1
[ "$failed" -eq 0 ] && echo "ok"
