#!/usr/bin/env bash
# The whole service over real protocols, each part a process of its own: recorded pairs as two GigE Vision cameras
# (gv_cameras) -> pelorusd -> LCM -> lcm-logger, in a network of its own on this machine. Prints what the listener saw.
#
# usage: gigevision.sh [-s SECONDS] [-r RATE_HZ] [-b BUILD_FOLDER] [-l MAX_LOST_SHARE] [-f "SECOND COMMAND"]... [DATASET]
#   -f  a fault, e.g. "5 off left": a line for gv_cameras at that second
#   DATASET  an EuRoC folder, which also brings the calibration; default: 60 pairs rendered into out/hil/dive
# Exit code: 0 good, 1 results are missing, 77 when a part is not there.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
if [ -z "${PELORUS_HIL_INSIDE:-}" ]; then
  private=(unshare -rn)
  [ "$(id -u)" -ne 0 ] || private=(unshare -n)
  "${private[@]}" true 2>/dev/null || { echo "gigevision.sh: no private network: unshare is not permitted" >&2; exit 77; }
  PELORUS_HIL_INSIDE=1 exec "${private[@]}" "${BASH_SOURCE[0]}" "$@"
fi
seconds=20 rate=20 build=$root/build/release max_lost=0 faults=()
while getopts s:r:b:l:f: option; do
  case $option in
    s) seconds=$OPTARG ;;
    r) rate=$OPTARG ;;
    b) build=$OPTARG ;;
    l) max_lost=$OPTARG ;;
    f) faults+=("$OPTARG") ;;
    *) exit 2 ;;
  esac
done
shift $((OPTIND - 1))
[ $# -le 1 ] || { sed -n '2,9p' "${BASH_SOURCE[0]}" >&2; exit 2; }
dataset=${1:-$root/out/hil/dive}
if [ $# -eq 0 ] && [ ! -d "$dataset" ]; then
  "$root/build/bin/pelorus" synth paper --frames 60 --out "$dataset"
fi
pelorusd=${PELORUSD:-$root/build/bin/pelorusd}
for part in "$pelorusd" "$build/tests/gv_cameras" "$(command -v lcm-logger || echo lcm-logger)"; do
  [ -x "$part" ] || { echo "gigevision.sh: $part is not there" >&2; exit 77; }
done

ip link set lo up
ip address add 127.0.1.2/8 dev lo
ip route add 224.0.0.0/4 dev lo

work=$(mktemp -d)
started=()
finish() {
  exec 3>&- || true
  [ ${#started[@]} -eq 0 ] || kill "${started[@]}" 2>/dev/null || true
  wait || true
  rm -rf "$work"
}
trap finish EXIT
cat >"$work/pelorus.yaml" <<YAML
source:
  kind: aravis
  calibration: $dataset
camera:
  left: 127.0.0.1
  right: 127.0.1.2
  rate_hz: $rate
  clock: ptp
  tolerance_ms: ${PELORUS_HIL_TOLERANCE_MS:-2}
recorder:
  folder: $work/recordings
${PELORUS_HIL_SETTINGS:-}
YAML

mkfifo "$work/commands"
"$build/tests/gv_cameras" "$dataset" 127.0.0.1 127.0.1.2 "$rate" <"$work/commands" >"$work/cameras.txt" &
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
"$pelorusd" --config "$work/pelorus.yaml" &
service=$!
started+=("$service")
for second in $(seq "$seconds"); do
  sleep 1
  for fault in ${faults[@]+"${faults[@]}"}; do
    if [ "${fault%% *}" = "$second" ]; then
      echo "second $second: ${fault#* }"
      echo "${fault#* }" >&3
    fi
  done
done
kill -TERM $service
wait $service || echo "gigevision.sh: pelorusd ended with code $?"
kill -INT $logger
wait $logger || true
log=$(find "$work" -name "log.lcm*" | head -1)
exec 3>&-
wait "${started[0]}" || true
cat "$work/cameras.txt"
python3 "$root/tests/hil/lcm_check.py" --max-lost "$max_lost" --least-results "$((seconds * rate / 4))" "$log"
