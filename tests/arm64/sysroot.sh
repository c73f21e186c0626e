#!/usr/bin/env bash
# Lays out Debian's arm64 libraries that core and its tests link with, for toolchain.cmake. Everything stays in the folder:
# apt reads the host's sources and keys but keeps its state here, so that the host never learns of a foreign architecture.
# usage: sysroot.sh FOLDER
set -euo pipefail
packages=(libeigen3-dev libgtest-dev libhwy-dev libhwy1)

folder=$(realpath -m "$1")
stamp=$folder/packages
if [ "$(cat "$stamp" 2>/dev/null)" = "${packages[*]}" ]; then exit 0; fi
printf 'run: fetching for arm64: %s\n' "${packages[*]}"
rm -rf "$folder"
state=$folder/apt
mkdir -p "$state/lists/partial" "$state/archives/partial"
: >"$state/status" # nothing is installed there, whatever the host has
# As the caller, not as apt's own user, who may not write here.
apt=(apt-get -qq -o APT::Sandbox::User=root -o Acquire::Retries=3
  -o APT::Architecture=arm64 -o APT::Architectures=arm64
  -o Dir::State="$state" -o Dir::State::status="$state/status" -o Dir::Cache="$state")
"${apt[@]}" update
(cd "$state" && "${apt[@]}" download "${packages[@]}")
for package in "$state"/*.deb; do
  dpkg -x "$package" "$folder"
done
rm -rf "$state"
printf '%s' "${packages[*]}" >"$stamp"
