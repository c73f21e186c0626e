#!/usr/bin/env bash
# What the service tells of cameras that fail and come back: one off, one frozen, a clock that jumps, lost packets, late
# pictures. The states are printed; the check is that results still come at the end.
# usage: gigevision_faults.sh [DATASET]
set -euo pipefail
exec "$(dirname "${BASH_SOURCE[0]}")/gigevision.sh" -s 40 -l 1 \
  -f "6 off left" -f "10 on left" -f "18 freeze right 1" -f "20 freeze right 0" \
  -f "24 clock left 3600" -f "27 clock left 0" -f "31 loss left 0.01" -f "34 loss left 0" \
  -f "36 late right 3" -f "38 late right 0" "$@"
