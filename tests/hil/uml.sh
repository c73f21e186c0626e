#!/usr/bin/env bash
# Runs one command in user-mode Linux (Debian's package user-mode-linux): a real kernel as a process, with vcan0 and vcan1,
# SocketCAN and traffic control. Starts in seconds, runs programs at the speed of this machine, needs no rights; has no
# media devices (for those: guest.sh). The guest's root is this file system, read-only; FOLDER alone is writable.
#
# usage: uml.sh [-t SECONDS] [-m "MODULE ..."] -o FOLDER -- COMMAND [ARGUMENT ...]
# Exit code: the command's; 124 after the time limit (default 120), 125 when the guest died, 77 when the machine lacks
# what is needed. PELORUS_HIL_CACHE: where the kernel is kept (default build/hil).
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
cache=${PELORUS_HIL_CACHE:-$root/build/hil}
limit=120 folder='' modules=''
while getopts t:m:o: option; do
  case $option in
    t) limit=$OPTARG ;;
    m) modules=$OPTARG ;;
    o) folder=$OPTARG ;;
    *) exit 2 ;;
  esac
done
shift $((OPTIND - 1))
if [ $# -eq 0 ] || [ ! -d "$folder" ]; then
  echo "uml.sh: a command and an existing -o FOLDER are needed" >&2
  exit 2
fi
PATH=$PATH:/sbin:/usr/sbin
command -v modprobe >/dev/null || { echo "uml.sh: modprobe is missing (apt-get install kmod)" >&2; exit 77; }
folder=$(cd "$folder" && pwd)

# Unpacked, never installed.
if [ ! -e "$cache/uml/usr/bin/linux.uml" ]; then
  mkdir -p "$cache"
  work=$(mktemp -d "$cache/fetch.XXXXXX")
  (cd "$work" && apt-get -q download user-mode-linux >&2 && dpkg-deb -x ./*.deb uml) || {
    rm -rf "$work"
    echo "uml.sh: the package user-mode-linux cannot be had" >&2
    exit 77
  }
  mv -T "$work/uml" "$cache/uml" 2>/dev/null || true  # another run may have been faster
  rm -rf "$work"
fi
kernel=$cache/uml/usr
version=$(ls "$kernel/lib/uml/modules")

# modprobe looks for lib/modules/VERSION below a folder.
mkdir -p "$folder/.guest/lib/modules"
ln -sfn "$kernel/lib/uml/modules/$version" "$folder/.guest/lib/modules/$version"
for module in vcan can-raw $modules; do
  modprobe -d "$folder/.guest" -S "$version" --show-depends "$module"
done | awk '$1 == "insmod" && !seen[$2]++ {print $2}' >"$folder/.guest/modules"
{
  printf 'cd %q\nexport PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root\n' "$PWD"
  printf 'exec'
  printf ' %q' "$@"
  echo
} >"$folder/.guest/command"
cat >"$folder/.guest/init" <<INIT
#!/bin/bash
export PATH=/usr/sbin:/usr/bin:/sbin:/bin
mount -t proc none /proc; mount -t sysfs none /sys
mount -t hostfs -o '$folder' none '$folder'
while read -r module; do insmod "\$module" || echo "guest: module \$module failed"; done <'$folder/.guest/modules'
ip link set lo up
for i in 0 1; do ip link add vcan\$i type vcan && ip link set vcan\$i up; done
/bin/bash '$folder/.guest/command' </dev/null
echo \$? >'$folder/.guest/code' && mv '$folder/.guest/code' '$folder/.guest/exit_code'
echo o >/proc/sysrq-trigger
sleep 5
INIT
chmod +x "$folder/.guest/init"
rm -f "$folder/.guest/exit_code"

ended=0
TMPDIR=/dev/shm timeout -k 3 "$limit" "$kernel/bin/linux.uml" mem=512M root=/dev/root rootfstype=hostfs rootflags=/ ro \
  init="$folder/.guest/init" quiet con=null con0=fd:0,fd:1 ssl=null umid="pelorus$$" uml_dir=/dev/shm/ </dev/null || ended=$?
code=125
if [ "$ended" = 124 ] || [ "$ended" = 137 ]; then code=124; fi
[ ! -e "$folder/.guest/exit_code" ] || code=$(cat "$folder/.guest/exit_code")
rm -rf "$folder/.guest"
exit "$code"
