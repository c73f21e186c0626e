#!/usr/bin/env bash
# Inside the virtual machine: the CAN output on real SocketCAN interfaces, healthy and with faults; leaves its recordings in
# FOLDER for can_check.py.
# usage: can_guest.sh BUILD_BIN BUILD_TESTS FOLDER
set -euo pipefail
bin=$1 tests=$2 out=$3

# record NAME INTERFACE: what other programs see on the bus, until stop.
record() {
  candump -L "$2" >"$out/$1.log" &
  listeners=($!)
  "$bin/pelorus" can dump "$2" --sets --json >"$out/$1.sets" 2>"$out/$1.summary" &
  listeners+=($!)
  "$bin/example_autopilot" "$2" "${@:3}" >"$out/$1.autopilot" &
  listeners+=($!)
  sleep 1
}
stop() {
  sleep 0.5
  kill -INT "${listeners[@]}" 2>/dev/null || true
  wait "${listeners[@]}" || true
}

echo "== classic"
record classic vcan0
"$tests/can_sender" vcan0 200 20 "$out/classic.sent" >"$out/classic.status"
stop

echo "== FD"
record fd vcan0 --fd
"$tests/can_sender" vcan0 200 20 "$out/fd.sent" fd >"$out/fd.status"
stop

echo "== interface down for 1.5 s"
record down vcan0
"$tests/can_sender" vcan0 120 20 "$out/down.sent" >"$out/down.status" &
sender=$!
sleep 2
ip link set vcan0 down
sleep 1.5
ip link set vcan0 up
wait $sender
stop

echo "== interface absent at the start, removed, back again"
"$tests/can_sender" vcan5 200 20 "$out/absent.sent" >"$out/absent.status" &
sender=$!
sleep 1.5
ip link add vcan5 type vcan
ip link set vcan5 up
timeout 2 candump -L vcan5 >"$out/absent_first.log" || true
ip link del vcan5
sleep 1.5
ip link add vcan5 type vcan
ip link set vcan5 up
timeout 2 candump -L vcan5 >"$out/absent_second.log" || true
wait $sender

echo "== a bus that takes 300 ms for each frame"
tc qdisc add dev vcan1 root netem delay 300ms
record slow vcan1
"$tests/can_sender" vcan1 120 20 "$out/slow.sent" >"$out/slow.status"
stop
tc qdisc del dev vcan1 root

echo "== a queue of five frames, shorter than a set"
tc qdisc add dev vcan1 root netem delay 5ms limit 5
record short vcan1
"$tests/can_sender" vcan1 100 20 "$out/short.sent" >"$out/short.status"
stop
tc qdisc del dev vcan1 root
