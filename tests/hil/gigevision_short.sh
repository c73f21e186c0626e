#!/usr/bin/env bash
# gigevision.sh at a rate that a machine shared with others holds as well: each pair has 200 ms. For every change.
# usage: gigevision_short.sh [DATASET]
set -euo pipefail
exec "$(dirname "${BASH_SOURCE[0]}")/gigevision.sh" -s 30 -r 5 "$@"
