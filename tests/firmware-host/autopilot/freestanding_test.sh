#!/bin/sh
# The autopilot's receiver compiles as C99 without a hosted library, with every warning an error, and its objects ask
# the linker for nothing but memcpy and memset (which every freestanding compiler may ask for itself).
# usage: freestanding_test.sh COMPILER SOURCE_ROOT
set -eu
compiler=$1
folder=$2/firmware-host/autopilot
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

cp "$folder"/pelorus_can.c "$folder"/pelorus_can_fields.c "$folder"/*.h "$out"
cd "$out"
for source in pelorus_can.c pelorus_can_fields.c; do
  "$compiler" -std=c99 -ffreestanding -Wall -Wextra -pedantic -Werror -Os -c "$source" -o "${source%.c}.o"
done

foreign=$(nm -u ./*.o | awk 'NF == 2 && $1 == "U" {print $2}' | grep -Ev '^(memcpy|memset|pelorus_can_.*)$' || true)
[ -z "$foreign" ] || { echo "asks for: $foreign"; exit 1; }
includes=$(grep -hoE '^ *# *include *<[^>]+>' ./*.c ./*.h | grep -Ev '<(stdint|stdbool|string)\.h>' || true)
[ -z "$includes" ] || { echo "includes: $includes"; exit 1; }
data=$(size -A ./*.o | awk '$1 ~ /^\.(data|bss)/ {sum += $2} END {print sum + 0}')
[ "$data" -eq 0 ] || { echo "has $data bytes of writable globals"; exit 1; }
size ./*.o
