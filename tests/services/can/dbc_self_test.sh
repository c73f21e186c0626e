#!/bin/sh
# dbc_test.py must be able to fail: each kind of damage to the DBC is done once in a copy.
# usage: dbc_self_test.sh PYTHON SOURCE_ROOT
set -eu
python=$1
root=$2
here=$(cd "$(dirname "$0")" && pwd)
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT

# must_fail WHAT SED_EXPRESSION: the damage is real and is found.
must_fail() {
  rm -rf "${copy:?}"/*
  mkdir -p "$copy/docs" "$copy/firmware-host/autopilot"
  cp "$root/docs/can.md" "$copy/docs/"
  cp "$root"/firmware-host/autopilot/*.log "$copy/firmware-host/autopilot/"
  sed "$2" "$root/firmware-host/autopilot/pelorus.dbc" > "$copy/firmware-host/autopilot/pelorus.dbc"
  if cmp -s "$root/firmware-host/autopilot/pelorus.dbc" "$copy/firmware-host/autopilot/pelorus.dbc"; then
    echo "no damage done: $1"
    exit 1
  fi
  if "$python" "$here/dbc_test.py" "$copy" > "$copy/said" 2>&1; then
    echo "not found: $1"
    exit 1
  fi
  tail -n 1 "$copy/said"
}

"$python" "$here/dbc_test.py" "$root" > /dev/null 2>&1 || exit $?
must_fail "a signal over another" 's/SG_ VY : 32/SG_ VY : 24/'
must_fail "another scale" 's/SG_ ROLL : 16|16@1- (0.0001,0)/SG_ ROLL : 16|16@1- (0.001,0)/'
must_fail "another sign" 's/SG_ VX : 16|16@1-/SG_ VX : 16|16@1+/'
must_fail "a line that is no signal" 's/ SG_ YAW : 48/ SG_ YAW ; 48/'
must_fail "another byte order" 's/SG_ X : 16|24@1-/SG_ X : 16|24@0-/'
must_fail "a signal that leaves its frame" 's/SG_ VZ : 48|16/SG_ VZ : 56|16/'
must_fail "an invalid value that is not told" '/VAL_ 288 VX/d'
must_fail "another identifier" 's/BO_ 288 VIS_VEL/BO_ 300 VIS_VEL/'
