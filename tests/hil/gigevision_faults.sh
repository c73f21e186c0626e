#!/usr/bin/env bash
# What the service tells of cameras that fail and come back: one side off, both pulled, one frozen, a clock that jumps, few
# lost packets and one in a hundred, late pictures, pictures of the wrong side; and of what happens around it: it is stopped
# for 300 ms, the multicast route goes, the recorder's disk fills up. Each has to be told as its state within five frames,
# counted as often as it was injected, and TRACKING has to come back when it is over; every exposure without a result has
# to be counted with its cause. The bus that goes down: gigevision_can.sh.
# usage: gigevision_faults.sh [DATASET]
set -euo pipefail
exec "$(dirname "${BASH_SOURCE[0]}")/gigevision.sh" -s 116 -l 1 \
  -f "6 off left" -f "9 on left" -f "15 off right" -f "18 on right" \
  -f "24 off left" -f "24 off right" -f "27 on left" -f "27 on right" \
  -f "33 freeze right 1" -f "35 freeze right 0" -f "38 freeze left 1" -f "40 freeze left 0" \
  -f "43 clock left 3600" -f "45 clock left 0" -f "49 clock left 3600" -f "49 clock right 3600" \
  -f "52 clock left 0" -f "52 clock right 0" -f "56 loss left 0.0005" -f "60 loss left 0" \
  -f "63 late right 3" -f "66 late right 0" -f "70 swap left 1" -f "73 swap left 0" \
  -f "77 swap left 1" -f "77 swap right 1" -f "80 swap left 0" -f "80 swap right 0" \
  -f "85 loss left 0.01" -f "88 loss left 0" \
  -f "92 hold service" -f "96 route lcm 1" -f "99 route lcm 0" -f "102 record service 1" -f "105 disk recorder 1" \
  -f "108 disk recorder 0" -f "112 record service 0" "$@"
