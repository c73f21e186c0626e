#!/usr/bin/env bash
# Inside the virtual machine, as root under systemd: installs pelorusd as docs/service.md says and checks what systemd makes
# of it: READY, the state in its status, death and silence (watchdog: all threads, vision alone) followed by a restart, a
# quick clean stop, exposure.
# usage: systemd_guest.sh FOLDER_WITH_PROGRAMS      /out/dive: a recording to play
# shellcheck disable=SC2317  # functions that until_true calls
set -uo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
failed=0
ok() { printf 'ok: %s\n' "$1"; }
wrong() {
  printf 'FAIL: %s\n' "$1"
  failed=1
}
property() { systemctl show pelorusd --value -p "$1"; }
now_ms() { date +%s%3N; }
# until_true SECONDS COMMAND...: prints the milliseconds it took; fails when it never came true.
until_true() {
  local start limit=$1
  start=$(now_ms)
  shift
  until "$@"; do
    [ $(($(now_ms) - start)) -lt $((limit * 1000)) ] || return 1
    sleep 0.1
  done
  echo $(($(now_ms) - start))
}
restarted() { [ "$(property NRestarts)" -ge "$1" ] && [ "$(property ActiveState)" = active ]; }
status_shows() { systemctl status pelorusd --no-pager | grep -q "Status: \"$1"; }

install -m 755 "$1/pelorusd" /usr/bin/pelorusd
install -m 644 "$root/systemd/pelorusd.service" /usr/lib/systemd/system/pelorusd.service
systemd-sysusers "$root/systemd/pelorus.sysusers.conf"
mkdir -p /srv/pelorus /etc/pelorus
cp -r /out/dive /srv/pelorus/dive
chmod -R a+rX /srv/pelorus
# This machine computes some fifty times slower than a real one.
cat >/etc/pelorus/pelorus.yaml <<'YAML'
source:
  path: /srv/pelorus/dive
  rate_hz: 1
  repeat: true
timing:
  latency_ms: 900
  deadline_tolerance_ms: 1000
capture:
  frame_timeout_ms: 5000
recorder:
  folder: /var/lib/pelorus
YAML
systemctl daemon-reload

# Type=notify: start returns after READY, which comes with the first result.
start=$(now_ms)
if systemctl start pelorusd; then
  ok "started and READY after $(($(now_ms) - start)) ms as $(ps -o user= -p "$(property MainPID)"): $(property StatusText)"
else
  wrong "does not start: $(property Result)"
  systemctl stop pelorusd
  journalctl --no-pager -o cat | grep -i 'pelorus\|seccomp' | tail -20
  exit 1
fi
journalctl -u pelorusd --no-pager -o cat | grep -q '^ready$' || wrong "the journal does not say ready"
if took=$(until_true 20 status_shows TRACKING); then
  ok "systemctl status after $took ms: $(systemctl status pelorusd --no-pager | sed -n 's/^ *Status: //p')"
else
  wrong "systemctl status does not show TRACKING: $(property StatusText)"
fi
refused=$(journalctl -u pelorusd --no-pager -o cat -p warning | grep -i 'real-time\|scheduling\|memory')
if [ -z "$refused" ]; then ok "real-time scheduling and locked memory granted"; else wrong "refused: $refused"; fi

# Vision and its helper on processors of their own (process.pin), the others of the program where the kernel likes.
threads=$(ps -L -o class=,rtprio=,comm= -p "$(property MainPID)" | grep -c FF)
pinned=$(for task in /proc/"$(property MainPID)"/task/*; do taskset -cp "${task##*/}"; done | grep -vc '0,1')
if [ "$threads" -ge 3 ] && [ "$pinned" -ge 1 ]; then
  ok "$threads threads in real time, $pinned pinned to a processor"
else
  wrong "$threads threads in real time, $pinned pinned to a processor"
  ps -L -o tid=,class=,rtprio=,psr=,comm= -p "$(property MainPID)"
fi

kill -KILL "$(property MainPID)"
if took=$(until_true 30 restarted 1); then ok "killed: READY again after $took ms"; else wrong "killed: not restarted"; fi

# hung NAME LEAST_MS MOST_MS RESTARTS: the process whose number is in $hung ends by the watchdog and is started again.
gone() { ! kill -0 "$hung" 2>/dev/null; }
hung() {
  took=$(until_true 20 gone) || took=never
  if [ "$took" != never ] && [ "$took" -ge "$2" ] && [ "$took" -le "$3" ]; then
    ok "$1: ended by the watchdog after $took ms"
  else
    wrong "$1: ended after $took ms"
  fi
  if took=$(until_true 30 restarted "$4"); then ok "and READY again $took ms later"; else wrong "$1: not restarted"; fi
  [ "$(journalctl -u pelorusd --no-pager -o cat | grep -c 'Watchdog timeout')" -eq $(($4 - 1)) ] ||
    wrong "it was not the watchdog that ended it"
  until_true 20 status_shows TRACKING >/dev/null || wrong "not TRACKING after the watchdog"
}

# SIGSTOP: alive, and feeds the watchdog no more. WatchdogSec=5 counts from the last feed, at most 1.25 s before.
until_true 20 status_shows TRACKING >/dev/null || wrong "not TRACKING after the restart"
hung=$(property MainPID)
kill -STOP "$hung"
hung "all threads hung" 3000 9000 2

# Vision alone: the others live, so the service feeds on for the two seconds of its own patience.
hung=$(property MainPID)
"$root/tests/hil/hold_thread.py" "$hung" vision >/tmp/held &
until_true 20 grep -q held /tmp/held >/dev/null || wrong "vision cannot be held: $(cat /tmp/held)"
hung "vision alone hung" 5000 11000 3
journalctl -u pelorusd --no-pager -o cat | grep -q '^vision stands still$' || wrong "the journal does not name vision"

# By the journal of systemd: starting systemctl alone may take a second here, and a unit that nobody needs any more is
# forgotten with its result.
stamp_ms() {
  journalctl -u pelorusd --no-pager -o short-unix | grep "$1" | sed -n '$s/^\([0-9]*\)\.\([0-9]\{3\}\).*/\1\2/p'
}
systemctl stop pelorusd
journalctl --sync
asked=$(stamp_ms 'Stopping pelorusd')
ended=$(stamp_ms 'Deactivated successfully')
if [ "${ended:-0}" -ge "${asked:-1}" ] && [ $((ended - asked)) -le 1000 ]; then
  ok "stopped in $((ended - asked)) ms: exit code 0"
else
  wrong "asked to stop at ${asked:-never}, ended well at ${ended:-never} ms"
fi

if exposure=$(systemd-analyze security --no-pager --threshold=25 pelorusd); then
  ok "systemd-analyze security: ${exposure##*Overall}"
else
  wrong "systemd-analyze security: ${exposure##*Overall}"
fi
[ "$failed" = 0 ] || journalctl -u pelorusd --no-pager -o short-monotonic | tail -40
exit "$failed"
