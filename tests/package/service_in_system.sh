#!/usr/bin/env bash
# In the virtual machine, under systemd: the service on a small scene, rendered live. The processor is emulated, so
# nothing here says anything about speed. Changes to the system are gone with the machine.
# shellcheck disable=SC2016,SC2317 # commands are handed on in quotes, functions as words
# shellcheck source=tests/package/checks_in_system.sh
. "$(dirname "$0")/checks_in_system.sh"
packages=$(dirname "$0")
main_pid() { systemctl show -P MainPID pelorusd; }
# until_true SECONDS COMMAND...
until_true() {
  local end=$((SECONDS + $1))
  shift
  until "$@"; do
    [ "$SECONDS" -lt "$end" ] || return 1
    sleep 0.5
  done
}
replaced() { [ "$(main_pid)" != "$1" ] && [ "$(main_pid)" != 0 ] && systemctl -q is-active pelorusd; }

check "an unconfigured service fails once and is left alone" bash -c '
  ! systemctl start pelorusd && [ "$(systemctl show -P NRestarts pelorusd)" = 0 ]'
install -D -m 644 "$packages/scene.yaml" /var/lib/pelorus/scene.yaml
cat >/etc/pelorus/pelorus.yaml <<'YAML'
source: {kind: synthetic, path: /var/lib/pelorus/scene.yaml, repeat: true}
# An emulated processor needs its time.
timing: {latency_ms: 1000}
capture: {frame_timeout_ms: 4000}
YAML
systemctl reset-failed pelorusd
check "it can be enabled" systemctl enable pelorusd
check "it starts, with its first result" systemctl start pelorusd
check "it is active" systemctl is-active pelorusd
check "it runs under its account" same pelorus stat -c %U "/proc/$(main_pid)"
# CAMERA_FAULT too: an emulated processor may need seconds for the first picture.
check "status tells the state" bash -c 'systemctl show -P StatusText pelorusd | grep -E "INIT|TRACKING|DEGRADED|CAMERA_FAULT"'
check "its messages are heard: pelorus top --once" pelorus top --once --timeout 60
check "the kernel settings are in force after boot" same 8388608 cat /proc/sys/net/core/rmem_max

pid=$(main_pid)
kill -KILL "$pid"
check "killed, it is started again" until_true 60 replaced "$pid"
pid=$(main_pid)
kill -STOP "$pid"
check "standing still, the watchdog ends it and it is started again" until_true 90 replaced "$pid"
pid=$(main_pid)
check "an upgrade installs" dpkg -i "$packages/second.deb"
check "and the running service is the new one" until_true 60 replaced "$pid"
check "with the configuration as edited" grep -q "kind: synthetic" /etc/pelorus/pelorus.yaml
check "stop ends it" systemctl stop pelorusd
check "with success" same success systemctl show -P Result pelorusd
systemctl start pelorusd
check "remove stops a running service" bash -c '
  dpkg -r pelorus-dev pelorus && ! pgrep -x pelorusd 2>/dev/null && [ ! -e /usr/bin/pelorusd ] && ! ls /proc/[0-9]*/exe -l 2>/dev/null | grep -q pelorusd'
check "purge disables it and keeps what is in /var/lib/pelorus" bash -c '
  dpkg -P pelorus && ! ls /etc/systemd/system/*/pelorusd.service 2>/dev/null && [ -f /var/lib/pelorus/scene.yaml ]'
[ $failed = 0 ] || journalctl -u pelorusd --no-pager | tail -40
exit $failed
