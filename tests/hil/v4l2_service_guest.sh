#!/usr/bin/env bash
# Inside the virtual machine: pelorusd on V4L2 devices, heard on LCM and vcan0; leaves what was said in /out for
# v4l2_check.py.       usage: v4l2_service_guest.sh FOLDER_WITH_PROGRAMS FOLDER_WITH_TEST_PROGRAMS
set -euo pipefail
bin=$1 tests=$2
now_ns() { date +%s%N; }

# begin NAME RATE_HZ [fd]: the listeners and the service, with the settings of section camera from standard input.
begin() {
  local fd=false
  [ $# -lt 3 ] || fd=true
  out=/out/$1
  work=/tmp/$1
  rm -rf "$out"
  mkdir -p "$out" "$work"
  : >"$out/events"
  {
    printf 'camera:\n  rate_hz: %s\n' "$2"
    cat
    printf 'source:\n  kind: v4l2\n  calibration: %s\n' "$work/rig.yaml"
    printf 'timing:\n  latency_ms: 900\n  deadline_tolerance_ms: 1000\n'
    printf 'capture:\n  frame_timeout_ms: %s\n' $((3000 / $2))
    printf 'mounting:\n  given: true\nprocess:\n  pin: false\ncan:\n  enabled: true\n  interface: vcan0\n  fd: %s\n' $fd
  } >"$work/pelorus.yaml"
  lcm-logger -q -f "$work/log.lcm" &
  logger=$!
  "$bin/pelorus" can dump vcan0 --sets --json >"$work/sets.json" 2>"$work/sets.txt" &
  dump=$!
  sleep 1
  "$bin/pelorusd" --config "$work/pelorus.yaml" >"$out/service.log" 2>&1 &
  service=$!
}
# until_log TEXT COUNT SECONDS: the service has written it so many times.
until_log() {
  local end=$((SECONDS + $3))
  until [ "$(grep -c "$1" "$out/service.log")" -ge "$2" ]; do
    kill -0 $service || { echo "pelorusd ended"; cat "$out/service.log"; exit 1; }
    [ $SECONDS -lt $end ] || { echo "FAIL: '$1' was not said $2 times in $3 s"; cat "$out/service.log"; exit 1; }
    sleep 0.2
  done
}
finish() {
  local start code=0
  start=$(now_ns)
  kill -TERM $service
  wait $service || code=$?
  echo "ended with $code after $((($(now_ns) - start) / 1000000)) ms"
  echo "$code" >"$out/code"
  sleep 1
  kill -INT $logger
  kill -TERM $dump
  wait $logger $dump || true
  cp "$work"/log.lcm* "$out/log.lcm"
  cp "$work/sets.json" "$out/"
}
quiet() { sleep 8; }  # between outages: so long the flow of results is checked
event() { echo "obeyed $(now_ns) $1 $2" >>"$out/events"; }

vivid() {
  local driver=/sys/bus/platform/drivers/vivid
  for i in 0 1; do v4l2-ctl -d /dev/video$i -c timestamp_source=1; done  # start of exposure; else it stamps the future
  mkdir -p /tmp/vivid
  sed -e 's/320, *240/320, 180/' /out/rig.yaml >/tmp/vivid/rig.yaml
  begin vivid 5 <<YAML
  left: /dev/video0
  right: /dev/video1
  pixel_format: GREY
  width_px: 320
  height_px: 180
  tolerance_ms: 99
YAML
  until_log 'few points' 1 30
  quiet
  # While a second program holds the device, it stays away after the service has let go of it.
  exec 9</dev/video0
  event off left
  v4l2-ctl -d /dev/video0 -c disconnect=1
  until_log 'no pictures' 1 10
  sleep 3
  event on left
  exec 9<&-
  until_log 'few points' 2 20
  quiet
  event off left
  event off right
  echo vivid.0 >$driver/unbind
  until_log 'no pictures' 2 10
  sleep 3
  event on left
  event on right
  echo vivid.0 >$driver/bind
  until_log 'few points' 3 20
  quiet
  finish
}

# film NAME RIGHT_DEVICE PIXELS [fd]: recorded pairs, from the moment at which the service has its cameras open.
film() {
  mkdir -p "/tmp/$1"
  cp /out/rig.yaml "/tmp/$1/"
  mkfifo "/tmp/$1/commands"
  "$tests/v4l2_cameras" /out/dive /dev/video10 "$2" 2 "$3" "/tmp/$1/shown.csv" <"/tmp/$1/commands" >"/tmp/$1/cameras" &
  local cameras=$!
  exec 8>"/tmp/$1/commands"
  until grep -q ready "/tmp/$1/cameras"; do kill -0 $cameras; sleep 0.2; done
  begin "$1" 2 ${4:+"$4"} <<YAML
  left: /dev/video10
  right: "${2#-}"
  pixel_format: $3
  width_px: 320
  height_px: 240
  tolerance_ms: 200
  reopen_after_s: 30
YAML
  cp "$work/pelorus.yaml" "$out/replay.yaml"
  until_log 'no pictures' 1 20
  echo >&8
  until_log TRACKING 1 20
  sleep 20
  finish
  exec 8>&-
  wait $cameras
  cp "$work/shown.csv" "$out/"
}

vivid
film gray /dev/video11 GREY
ip link set vcan0 down
ip link set vcan0 mtu 72
ip link set vcan0 up
film mjpg - MJPG fd
