#!/usr/bin/env bash
# The packages in a bare Debian 12: installed, run under systemd, upgraded over an edited configuration, removed, purged.
# One line for each thing checked; exit code 1 when one failed, 77 when this machine cannot do it. Needs root and a
# Debian mirror; systemd runs in the virtual machine of tests/hil/guest.sh, since containers have no kernel of their own.
#
# usage: package_test.sh FOLDER-OF-PACKAGES      (./run package-test)
# PELORUS_PACKAGE_TEST_CACHE: where the bare system is kept between runs (default build/package-test).
set -uo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source_root=$(cd "$here/../.." && pwd)
cache=${PELORUS_PACKAGE_TEST_CACHE:-$source_root/build/package-test}
[ $# -eq 1 ] || { echo "usage: package_test.sh FOLDER-OF-PACKAGES" >&2; exit 2; }
main_deb=$(realpath "$1"/pelorus_*.deb) dev_deb=$(realpath "$1"/pelorus-dev_*.deb)
for package in "$main_deb" "$dev_deb"; do
  [ -f "$package" ] || { echo "package_test.sh: $1 holds no packages (./run package)" >&2; exit 2; }
done
[ "$(id -u)" = 0 ] || { echo "package_test.sh: needs root, for chroot" >&2; exit 77; }
for tool in mmdebstrap unshare dpkg-deb pkg-config g++; do
  command -v $tool >/dev/null || { echo "package_test.sh: $tool is missing" >&2; exit 77; }
done

# shellcheck source=tests/package/checks_in_system.sh
. "$here/checks_in_system.sh"

work=$(mktemp -d)
root=$work/root
trap 'rm -rf "$work"' EXIT

# inside COMMAND...: in the bare system, with its own /proc that goes with the command.
inside() {
  # shellcheck disable=SC2016 # "$1" is for the inner shell
  unshare --mount --pid --fork sh -c 'r=$1; shift; mount -t proc proc "$r/proc"; exec chroot "$r" "$@"' sh "$root" \
    env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 HOME=/root DEBIAN_FRONTEND=noninteractive "$@"
}

# The bare system with what the package depends on, but without the package. Kept, for the next run.
prepare_root() {
  local depends base
  depends=$(dpkg-deb -f "$main_deb" Depends)
  base=$cache/root-$(printf '%s' "$depends" | sha256sum | cut -c1-12).tar
  mkdir -p "$cache" "$root"
  if [ ! -f "$base" ]; then
    mmdebstrap --quiet --variant=minbase --include=ca-certificates bookworm "$root" || return
    cp /etc/resolv.conf "$root/etc/resolv.conf"
    inside apt-get update -q || return
    inside apt-get satisfy -y -q --no-install-recommends "$depends" || return
    inside apt-get clean
    tar -C "$root" -cf "$base.partial" . && mv "$base.partial" "$base"
  else
    tar -C "$root" -xf "$base"
  fi
}

# next_version FROM TO EDIT REVISION: the same package as a later one, its configuration changed by sed.
next_version() {
  local tree=$work/next
  rm -rf "$tree"
  dpkg-deb -R "$1" "$tree"
  sed -i -E 's/^(Version: .*-)[0-9]+$/\1'"$4"'/' "$tree/DEBIAN/control"
  [ -z "$3" ] || sed -i "$3" "$tree/etc/pelorus/pelorus.yaml"
  (cd "$tree" && find etc usr -type f -exec md5sum {} + >DEBIAN/md5sums)
  dpkg-deb --root-owner-group -b "$tree" "$2" >/dev/null
}

# Everything in the system but what dpkg and the linker keep about themselves.
files() { (cd "$root" && find . -xdev \( -path ./proc -o -path ./tmp -o -path ./var/lib/dpkg -o -path ./var/log \
  -o -path ./var/cache \) -prune -o -print | sort); }

printf '== lintian\n'
if command -v lintian >/dev/null; then
  # Nothing is suppressed: warnings are shown, errors fail.
  lintian --tag-display-limit 0 --allow-root "$main_deb" "$dev_deb" >"$work/lintian.log" 2>&1
  cat "$work/lintian.log"
  check "lintian: $(grep -c '^W:' "$work/lintian.log") warnings, no error" same 0 grep -c '^E:' "$work/lintian.log"
else
  printf 'skipped: no lintian here\n'
fi

printf '== a bare Debian 12\n'
prepare_root >"$work/prepare.log" 2>&1 || { tail -20 "$work/prepare.log"; echo "package_test.sh: no bare system" >&2; exit 77; }
files >"$work/before"
mkdir "$root/srv/packages"
cp "$main_deb" "$root/srv/packages/first.deb"
cp "$dev_deb" "$root/srv/packages/dev.deb"
next_version "$main_deb" "$root/srv/packages/second.deb" '' 2
next_version "$main_deb" "$root/srv/packages/third.deb" 's/^source:/# Pairs come in here.\n&/' 3
cp "$source_root/tests/golden/small_dive.yaml" "$root/srv/packages/scene.yaml"
cp "$here"/*_in_system.sh "$root/srv/packages/"

printf '== install\n'
check "installs with what it depends on and nothing else" inside dpkg -i /srv/packages/first.deb /srv/packages/dev.deb
check "no dependency is a compiler, node or Java" sh -c \
  "! dpkg-deb -f '$main_deb' Depends Recommends | grep -E 'gcc-[0-9]|g\+\+|-dev|nodejs|npm|jre|jdk'"
inside bash /srv/packages/installed_in_system.sh || failed=1
check "no link of the installed documents dangles" python3 "$here/../check_links.py" "$root/usr/share/doc/pelorus"
receiver=$root/usr/share/pelorus/autopilot
check "the receiver of pelorus-dev compiles as C99" gcc -std=c99 -ffreestanding -Wall -Wextra -Werror -c \
  -o "$work/receiver.o" "$receiver/pelorus_can.c"
printf '#include <pelorus/vis_tracks_t.hpp>\nint main() { return pelorus::vis_tracks_t{}.getHash() == 0; }\n' >"$work/listen.cpp"
flags() { PKG_CONFIG_PATH="$root/usr/share/pkgconfig" pkg-config --define-prefix --cflags pelorus-messages; }
# shellcheck disable=SC2046 # one word for each flag
check "a listener compiles with pkg-config pelorus-messages" g++ -o "$work/listen" "$work/listen.cpp" $(flags)

printf '== under systemd\n'
"$source_root/tests/hil/guest.sh" -t 900 -r "$root" -s -- bash /srv/packages/service_in_system.sh
case $? in
  0) ;;
  77) printf 'skipped: no virtual machine here\n' ;;
  *) failed=1 ;;
esac

printf '== upgrade, remove, purge\n'
inside bash /srv/packages/upgrade_in_system.sh || failed=1
rm -r "$root/srv/packages"
files >"$work/after"
check "purge leaves the files of before" diff "$work/before" "$work/after"

[ $failed = 0 ] && printf 'all good\n' || printf 'FAILED\n'
exit $failed
