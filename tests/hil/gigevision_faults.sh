#!/usr/bin/env bash
# What the service tells of cameras that fail and come back: one side off, both pulled, one frozen (each has to be told as a
# CAMERA_FAULT within five frames); then a clock that jumps, lost packets, late pictures, whose states are printed. Results
# have to come again at the end, and every exposure without one has to be counted with its cause.
# usage: gigevision_faults.sh [DATASET]
set -euo pipefail
exec "$(dirname "${BASH_SOURCE[0]}")/gigevision.sh" -s 56 -l 1 \
  -f "6 off left" -f "9 on left" -f "15 off right" -f "18 on right" \
  -f "24 off left" -f "24 off right" -f "27 on left" -f "27 on right" \
  -f "33 freeze right 1" -f "35 freeze right 0" -f "37 freeze left 1" -f "39 freeze left 0" \
  -f "42 clock left 3600" -f "44 clock left 0" -f "47 loss left 0.01" -f "49 loss left 0" \
  -f "51 late right 3" -f "53 late right 0" "$@"
