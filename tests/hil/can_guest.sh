#!/usr/bin/env bash
# Inside the virtual machine: the CAN output on real SocketCAN interfaces, healthy and with faults; leaves its recordings in
# FOLDER for can_check.py.
# usage: can_guest.sh BUILD_BIN BUILD_TESTS FOLDER
set -euo pipefail
bin=$1 tests=$2 out=$3

# record NAME INTERFACE [--fd]: what other programs see on the bus, until stop.
record() {
  candump -L "$2" >"$out/$1.log" &
  listeners=($!)
  "$bin/pelorus" can dump "$2" --sets --json >"$out/$1.sets" 2>"$out/$1.summary" &
  listeners+=($!)
  "$bin/example_autopilot" "$2" "${@:3}" >"$out/$1.autopilot" &
  listeners+=($!)
  # All three listen: candump and the autopilot to everything, the tool to a range and to error frames.
  until [ "$(cat /proc/net/can/rcvlist_{all,fil,inv,sff,eff,err} | grep -c "^ *$2 .* raw")" -ge 4 ]; do sleep 0.1; done
}
# Jobs of a script ignore SIGINT.
stop() {
  sleep 0.5
  kill -TERM "${listeners[@]}" 2>/dev/null || true
  wait "${listeners[@]}" || true
}
# send NAME INTERFACE SETS [fd]: in the background.
send() {
  "$tests/can_sender" "$2" "$3" 20 "$out/$1.sent" "${@:4}" >"$out/$1.status" &
  sender=$!
}
# wait_for NAME WORD COUNT: until the sender has reported that state of the interface so many times.
wait_for() {
  until [ "$(grep -c "^[a-z0-9]* $2," "$out/$1.status")" -ge "$3" ]; do
    kill -0 $sender || { echo "the sender of $1 ended before it was $2"; exit 1; }
    sleep 0.05
  done
}

echo "== classic"
record classic vcan0
send classic vcan0 200
wait $sender
stop

echo "== FD"
record fd vcan0 --fd
send fd vcan0 200 fd
wait $sender
stop

echo "== interface down for a second and a half"
record down vcan0
send down vcan0 120
wait_for down active 1
sleep 1.5
ip link set vcan0 down
wait_for down down 1
sleep 1.5
ip link set vcan0 up
wait_for down active 2
wait $sender
stop

echo "== interface absent at the start, removed, back again"
send absent vcan5 200
wait_for absent absent 1
ip link add vcan5 type vcan
ip link set vcan5 up
wait_for absent active 1
timeout 1.5 candump -L vcan5 >"$out/absent_first.log" || true
ip link del vcan5
wait_for absent absent 2
ip link add vcan5 type vcan
ip link set vcan5 up
wait_for absent active 2
timeout 1.5 candump -L vcan5 >"$out/absent_second.log" || true
wait $sender

# A frame on vcan counts 16 bytes: 8 kbit/s let a set of seven through in 112 ms, and 20 are made in a second.
echo "== a bus that is too slow for the rate"
tc qdisc add dev vcan1 root tbf rate 8kbit burst 72 limit 4000
record slow vcan1
send slow vcan1 120
wait $sender
stop
tc qdisc del dev vcan1 root

echo "== a queue of five frames, shorter than a set"
tc qdisc add dev vcan1 root tbf rate 100kbit burst 72 limit 80
record short vcan1
send short vcan1 100
wait $sender
stop
tc qdisc del dev vcan1 root
