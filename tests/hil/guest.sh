#!/usr/bin/env bash
# Runs one command in a throw-away virtual machine with Debian's own kernel and real device nodes that this machine may
# not have: two vivid cameras (/dev/video0, 1), vcan0 and vcan1. The guest's root is this file system, read-only under
# a RAM overlay, so programs built here run unchanged. Needs no rights and no KVM; the kernel is downloaded once.
#
# usage: guest.sh [-t SECONDS] [-o FOLDER] [-m "MODULE ..."] [-v] [-r FOLDER] [-s | -S] -- COMMAND [ARGUMENT ...]
#   -o  shared with the guest, writable, as /out     -v  kernel messages
#   -m  further kernel modules; v4l2loopback (/dev/video10, 11) is built from Debian's sources once, nothing is installed
#   -r  the guest's root in place of this file system    -s  boots that root's systemd; the command is a service of it
#   -S  this file system's systemd as process 1, with none of this machine's services; the command is a unit of it
# Exit code: the command's; 124 after the time limit (default 300), 125 when the guest died, 77 when the machine
# lacks what is needed. PELORUS_HIL_CACHE: where the kernel is kept (default build/hil).
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
cache=${PELORUS_HIL_CACHE:-$root/build/hil}
limit=300 out='' modules='' noise=quiet guest_root=/ systemd=no bare_systemd=''
while getopts t:o:m:vr:sS option; do
  case $option in
    t) limit=$OPTARG ;;
    o) out=$OPTARG ;;
    m) modules=$OPTARG ;;
    S) bare_systemd=yes ;;
    v) noise=ignore_loglevel ;;
    r) guest_root=$(realpath "$OPTARG") ;;
    s) systemd=yes ;;
    *) exit 2 ;;
  esac
done
shift $((OPTIND - 1))
[ $# -gt 0 ] || { echo "guest.sh: no command" >&2; exit 2; }
for tool in qemu-system-x86_64 busybox cpio depmod modprobe python3; do
  PATH=$PATH:/sbin:/usr/sbin command -v $tool >/dev/null || {
    echo "guest.sh: $tool is missing (apt-get install qemu-system-x86 busybox-static cpio kmod)" >&2
    exit 77
  }
done
PATH=$PATH:/sbin:/usr/sbin
modules="vcan can-raw vivid $modules"

# The kernel and its modules, unpacked, never installed; the image decompressed once, which saves a second of each boot.
fetch_kernel() {
  local package work
  package=$(apt-cache depends linux-image-amd64 2>/dev/null | awk '/Depends: linux-image/ {print $2; exit}')
  [ -n "$package" ] || { echo "guest.sh: apt knows no linux-image-amd64" >&2; exit 77; }
  mkdir -p "$cache"
  work=$(mktemp -d "$cache/fetch.XXXXXX")
  (cd "$work" && apt-get -q download "$package" >&2 && dpkg-deb -x ./*.deb kernel && rm ./*.deb) || {
    rm -rf "$work"
    echo "guest.sh: the package $package cannot be had" >&2
    exit 77
  }
  depmod -b "$work/kernel" "$(ls "$work/kernel/lib/modules")"
  python3 - "$work"/kernel/boot/vmlinuz-* "$work/kernel/vmlinux" <<'PY'
import lzma, sys
image = open(sys.argv[1], "rb").read()
start = image.find(b"\xfd7zXZ\x00")
open(sys.argv[2], "wb").write(lzma.LZMADecompressor(format=lzma.FORMAT_XZ).decompress(image[start:]))
PY
  mv -T "$work/kernel" "$cache/kernel" 2>/dev/null || true  # another run may have been faster
  rm -rf "$work"
}
[ -e "$cache/kernel/vmlinux" ] || fetch_kernel
version=$(ls "$cache/kernel/lib/modules")

# v4l2loopback for that kernel. Headers are unpacked only; what they say of their own place is set right.
build_loopback() {
  local work headers=linux-headers-$version
  work=$(mktemp -d "$cache/build.XXXXXX")
  (cd "$work" && apt-get -q download "$headers" "${headers%-amd64}-common" "linux-kbuild-${version%.*}" v4l2loopback-dkms >&2 &&
    for package in ./*.deb; do dpkg-deb -x "$package" .; done &&
    sed -i "s#/usr/src/#$work/usr/src/#" "usr/src/$headers/Makefile" &&
    make -s -C usr/src/v4l2loopback-* KERNEL_DIR="$work/usr/src/$headers" v4l2loopback.ko >&2 &&
    mv usr/src/v4l2loopback-*/v4l2loopback.ko "$cache/v4l2loopback-$version.ko") || {
    rm -rf "$work"
    echo "guest.sh: v4l2loopback cannot be built for the kernel $version (needs build-essential and the packages of apt)" >&2
    exit 77
  }
  rm -rf "$work"
}
case " $modules " in
  *" v4l2loopback "*)
    loopback=$cache/v4l2loopback-$version.ko
    [ -e "$loopback" ] || build_loopback
    modules=${modules/v4l2loopback/$loopback}
    ;;
esac

share=${out:-$(mktemp -d)}
boot=$(mktemp -d)
trap 'rm -rf "$boot"; [ -n "$out" ] || rm -rf "$share"' EXIT
mkdir -p "$share" "$boot"/{bin,modules,dev,proc,sys,host,over,root}
rm -f "$share/.exit_code" "$share/.hil.service"

# The command with its arguments, run in this folder.
folder=$PWD
[ "$guest_root" = / ] || folder=/
{
  printf 'cd %q\nexport PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root\n' "$folder"
  printf 'exec'
  printf ' %q' "$@"
  echo
} >"$share/.command"
if [ -n "$bare_systemd" ]; then
  cat >"$share/.hil.service" <<'UNIT'
[Unit]
DefaultDependencies=no
Requires=systemd-journald.socket
After=systemd-journald.socket systemd-journald.service
SuccessAction=poweroff-force
FailureAction=poweroff-force
[Service]
Type=oneshot
TimeoutStartSec=infinity
StandardOutput=tty
StandardError=tty
TTYPath=/dev/console
ExecStart=/bin/bash -c 'bash /out/.command; echo $? >/out/.code; mv /out/.code /out/.exit_code'
UNIT
fi

cp "$(command -v busybox)" "$boot/bin/busybox"
case $PWD/ in /tmp/*) touch "$boot/project-in-tmp" ;; esac # its /tmp is an overlay then, like the rest of the root
for module in virtio_pci 9pnet_virtio 9p overlay $modules; do
  case $module in
    /*) echo "insmod $module" ;;
    *) modprobe -d "$cache/kernel" -S "$version" --show-depends "$module" ;;
  esac
done | awk '$1 == "insmod" && !seen[$2]++ {print $2}' >"$boot/list"
while read -r file; do
  cp "$file" "$boot/modules/"
  basename "$file"
done <"$boot/list" >"$boot/modules/order"

cat >"$boot/init" <<'INIT'
#!/bin/busybox sh
b=/bin/busybox
$b mount -t devtmpfs none /dev; $b mount -t proc none /proc; $b mount -t sysfs none /sys
for module in $($b cat /modules/order); do
  case $module in
    vivid.ko) options="n_devs=2 num_inputs=1,1 input_types=0,0 node_types=0x1,0x1 vid_cap_nr=0,1 no_error_inj=0" ;;
    v4l2loopback*.ko) options="devices=2 video_nr=10,11 exclusive_caps=1,1" ;;
    *) options= ;;
  esac
  $b insmod /modules/$module $options || echo "guest: module $module failed"
done
share="trans=virtio,version=9p2000.L,msize=512000"
$b mount -t 9p -o $share,cache=loose,ro host /host
$b mount -t tmpfs none /over; $b mkdir /over/upper /over/work
$b mount -t overlay -o lowerdir=/host,upperdir=/over/upper,workdir=/over/work none /root
$b mkdir -p /root/out
$b mount -t 9p -o $share out /root/out
$b ip link set lo up; $b ip route add 224.0.0.0/4 dev lo
for i in 0 1; do $b ip link add vcan$i type vcan && $b ip link set vcan$i up; done
if [ -e /boot-systemd ]; then
  $b cp /boot-systemd /root/etc/systemd/system/guest-command.service
  for i in dev proc sys; do $b umount /$i; done
  exec $b switch_root /root /lib/systemd/systemd
fi
for i in dev proc sys; do $b mount --move /$i /root/$i; done
if [ -e /root/out/.hil.service ]; then
  # None of what this machine starts at boot: neither units that others pull in, nor those that generators make.
  $b rm -rf /root/etc/systemd/system/*.wants /root/lib/systemd/system/*.wants /root/lib/systemd/system-generators \
    /root/var/log/journal
  $b cp /root/out/.hil.service /root/etc/systemd/system/hil.service
  echo 0123456789abcdef0123456789abcdef >/root/etc/machine-id
  : >/root/etc/fstab
  exec $b switch_root /root /lib/systemd/systemd --unit=hil.service
fi
$b mount -t tmpfs none /root/run; [ -e /project-in-tmp ] || $b mount -t tmpfs none /root/tmp
$b mkdir -p /root/dev/shm /root/dev/pts
$b mount -t tmpfs none /root/dev/shm; $b mount -t devpts none /root/dev/pts
$b chroot /root /bin/bash /out/.command </root/dev/null
code=$?
echo $code >/root/out/.code && $b mv /root/out/.code /root/out/.exit_code
$b poweroff -f
INIT
chmod +x "$boot/init"
[ $systemd = no ] || cat >"$boot/boot-systemd" <<'UNIT'
[Unit]
After=multi-user.target
[Service]
StandardOutput=tty
StandardError=tty
TTYPath=/dev/console
ExecStart=/bin/bash -c '/bin/bash /out/.command </dev/null; echo $$? >/out/.code; mv /out/.code /out/.exit_code; systemctl poweroff -ff'
UNIT
(cd "$boot" && find . | cpio -o -H newc --quiet >"$boot.cpio")

systemd_options=''
[ $systemd = no ] || systemd_options="systemd.wants=guest-command.service systemd.show_status=0"
[ -z "$bare_systemd" ] || systemd_options="systemd.log_level=warning systemd.show_status=0"
boot_guest() {
  timeout -k 5 "$limit" qemu-system-x86_64 -M pc,usb=off,vmport=off -accel tcg,thread=multi -cpu max -smp 2 -m 1024 \
    -nodefaults -no-user-config -display none -no-reboot -serial stdio \
    -kernel "$cache/kernel/vmlinux" -initrd "$boot.cpio" \
    -append "console=ttyS0 $noise panic=-1 mitigations=off nokaslr tsc=reliable no_timer_check nowatchdog $systemd_options" \
    -fsdev local,id=host,path="$guest_root",security_model=none,readonly=on,multidevs=remap \
    -device virtio-9p-pci,fsdev=host,mount_tag=host,disable-legacy=on \
    -fsdev local,id=out,path="$share",security_model=none \
    -device virtio-9p-pci,fsdev=out,mount_tag=out,disable-legacy=on </dev/null
}
set +e
boot_guest
ended=$?
set -e
rm -f "$boot.cpio"
if [ -e "$share/.exit_code" ]; then exit "$(cat "$share/.exit_code")"; fi
[ $ended = 124 ] || [ $ended = 137 ] && exit 124
exit 125
