#!/usr/bin/env bash
# The whole service on V4L2 in a virtual machine with Debian's kernel: cameras as device nodes -> pelorusd -> LCM and
# SocketCAN, each with its own listener. Three sessions (v4l2_service_guest.sh): vivid's test card on two devices,
# which are unplugged; recorded pairs through v4l2loopback on two devices; the same as MJPG on one device, side by
# side. Checked here: every exposure is a result or a counted loss, every result a set on CAN, an unplugged camera is
# told within five periods and taken up again, and the poses of recorded pairs are those of `pelorus replay`.
# A boot that hangs is tried again.
# usage: v4l2_service.sh [BUILD_FOLDER [FOLDER_FOR_RECORDINGS]]
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
build=$(cd "${1:-$root/build/release}" && pwd)
out=${2:-$(mktemp -d)}
[ $# -ge 2 ] || trap 'rm -rf "$out"' EXIT
for tool in v4l2-ctl lcm-logger make; do
  command -v $tool >/dev/null || {
    echo "v4l2_service.sh: $tool is missing (apt-get install v4l-utils liblcm-bin build-essential)" >&2
    exit 77
  }
done
# Small, because the guest computes some fifty times slower than this machine.
sed -e 's/width_px: 512/width_px: 320/' -e 's/height_px: 384/height_px: 240/' -e 's/f_px: 400/f_px: 250/' \
  "$root/tests/golden/small_dive.yaml" >"$out/scene.yaml"
"$root/build/bin/pelorus" synth "$out/scene.yaml" --out "$out/dive" >/dev/null
"$root/build/bin/pelorus" calib convert "$out/dive" --to kalibr --out "$out/rig.yaml" >/dev/null
for attempt in 1 2; do
  code=0
  "$here/guest.sh" -t 280 -m v4l2loopback -o "$out" -- \
    "$here/v4l2_service_guest.sh" "$root/build/bin" "$build/tests" || code=$?
  [ $code = 124 ] || [ $code = 125 ] || break
  echo "v4l2_service.sh: the guest did not come up (attempt $attempt)" >&2
done
[ "$code" = 0 ] || exit "$code"

failed=0
check() {
  python3 "$@" || { echo "FAIL: ${*##*/}"; failed=1; }
}
for session in vivid:5 gray:2 mjpg:2; do
  name=${session%:*} rate=${session#*:}
  echo "== $name at $rate Hz"
  check "$here/v4l2_check.py" "$out/$name" "$rate"
  [ "$name" != vivid ] || continue
  check "$here/gv_check.py" drops "$out/$name/log.lcm" "$out/$name/shown.csv" "$rate"
  check "$here/gv_check.py" played "$out/$name/log.lcm" "$out/$name/shown.csv" "$rate" "$out/dive" "$out/$name/played"
  "$root/build/bin/pelorus" replay "$out/$name/played" --config "$out/$name/replay.yaml" --out "$out/$name/replayed" \
    >"$out/$name/replay.txt" 2>&1 || { cat "$out/$name/replay.txt"; failed=1; }
  # Of 320x240 pixels a body has few points; JPEG moves them by some hundredths of a pixel.
  tolerance=(0.002 0.02 0.6)
  [ "$name" = gray ] || tolerance=(0.01 0.05 1.5)
  check "$here/gv_check.py" poses "$out/$name/log.lcm" "$out/$name/replayed" "${tolerance[@]}"
done
[ "$failed" = 0 ] && echo "ok"
