#!/bin/sh
# Exports a small dive as MCAP and has a reader that others wrote judge it. Exit code 77: that reader is not here.
# usage: mcap_test.sh PELORUS SOURCE_DIR NODE_MODULES
set -eu
pelorus=$1 sources=$2 modules=$3
command -v node >/dev/null || { echo "skipped: no node"; exit 77; }
[ -d "$modules/@mcap/core" ] || {
  echo "skipped: no @mcap/core in $modules (npm install --prefix build/npm tests/firmware-host/pelorus/mcap_reader)"
  exit 77
}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# Long enough for several chunks.
sed 's/^frames: 16$/frames: 60/' "$sources/tests/golden/small_dive.yaml" >"$folder/dive.yaml"
"$pelorus" replay "$folder/dive.yaml" --out "$folder/run" >/dev/null 2>&1
"$pelorus" export "$folder/run" --format mcap --out "$folder/run.mcap"
node "$sources/tests/firmware-host/pelorus/mcap_reader/mcap_check.js" "$modules" "$folder/run.mcap" "$folder/run"
