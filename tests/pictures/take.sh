#!/usr/bin/env bash
# The pictures of docs/ that show screens, taken anew: the report of the demo, pelorus top, lcm-spy. Nothing of them is
# compared: look at them before they are committed.
# usage: take.sh FOLDER-OF-PROGRAMS BUILD-FOLDER-OF-THE-PAGE FOLDER-OF-PICTURES      (./run pictures)
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
[ $# -eq 3 ] || { echo "usage: take.sh PROGRAMS PAGE-BUILD PICTURES" >&2; exit 2; }
programs=$(realpath "$1") page_build=$(realpath "$2") pictures=$(realpath "$3")
for tool in Xvfb xterm xdotool import convert node chromium; do
  command -v $tool >/dev/null || { echo "take.sh: $tool is missing (./run pictures installs it)" >&2; exit 1; }
done

work=$(mktemp -d)
started=()
end() {
  [ ${#started[@]} -eq 0 ] || kill "${started[@]}" 2>/dev/null || true
  rm -rf "$work"
}
trap end EXIT

# in_background COMMAND...: ended with this script.
in_background() {
  "$@" >>"$work/log" 2>&1 &
  started+=($!)
}

# window NAME: its number, once it is there.
window() {
  timeout 60 xdotool search --sync --onlyvisible --name "$1" | head -n 1 ||
    { echo "take.sh: no window '$1' within a minute; the programs said:" >&2; tail -n 20 "$work/log" >&2; return 1; }
}

# few_colors PNG: screens have few; the file shrinks to a third.
few_colors() {
  convert "$1" -strip -colors 128 "PNG8:$1"
}

report_pictures() {
  "$programs/pelorus" demo --out "$work/demo" >"$work/demo.log"
  node "$here/report_pictures.mjs" "$work/demo/results/report.html" "$page_build" "$pictures"
}

# A service of its own port, so that none that runs here shows in the pictures; on the dive that the demo rendered.
url='udpm://239.255.76.67:17667?ttl=0'
start_service() {
  cat >"$work/live.yaml" <<YAML
source: {path: $work/demo/dataset, rate_hz: 5, repeat: true}
lcm: {url: "$url"}
YAML
  in_background "$programs/pelorusd" --config "$root/config/pelorus.yaml" --config "$work/live.yaml"
  sleep 6 # bodies are confirmed, the latencies of some seconds known; the dive lasts 18 s before it begins anew
}

# The server chooses a number that is free and writes it down when it can be used: another's screen is never taken.
start_screen() {
  local number
  mkfifo "$work/screen"
  in_background Xvfb -displayfd 3 -screen 0 1000x620x24 3<>"$work/screen"
  read -r -t 60 number <>"$work/screen" || { echo "take.sh: Xvfb does not start: $(cat "$work/log")" >&2; exit 1; }
  export DISPLAY=:$number
}

top_picture() {
  in_background xterm -geometry 80x24 -fa 'DejaVu Sans Mono' -fs 12 -bg black -fg gray90 -title pelorus-top \
    -e "$programs/pelorus" top --url "$url"
  local terminal
  terminal=$(window '^pelorus-top$')
  sleep 6
  import -window "$terminal" "$pictures/top.png"
  kill "${started[-1]}"
}

# The list of channels above, the fields of one of them below. Without a window manager nothing places them.
spy_picture() {
  in_background "$programs/pelorus-spy" "--lcm-url=$url"
  local channels fields
  channels=$(window '^LCM Spy$')
  sleep 8
  local row_of_tracks=92
  xdotool mousemove 60 $row_of_tracks click --repeat 2 --delay 80 1
  fields=$(window 'VIS_TRACKS')
  xdotool windowsize "$channels" 1000 150
  xdotool windowmove "$fields" 0 150 windowsize "$fields" 1000 470
  sleep 12 # the little curves fill
  import -window root "$pictures/spy.png"
}

report_pictures
start_screen
start_service
top_picture
spy_picture
for picture in top spy report_replay report_paths report_errors report_figures; do few_colors "$pictures/$picture.png"; done
ls -l "$pictures"/{top,spy,report_replay,report_paths,report_errors,report_figures}.png
