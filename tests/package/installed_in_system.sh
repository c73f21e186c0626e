#!/usr/bin/env bash
# In the bare system, after the installation: programs, account, configuration, manual, completion. No systemd runs here.
# shellcheck disable=SC2016,SC2317 # commands are handed on in quotes, functions as words
# shellcheck source=tests/package/checks_in_system.sh
. "$(dirname "$0")/checks_in_system.sh"
version=$(dpkg-query -W -f '${Version}' pelorus)
check "pelorus is of the package's version" same "pelorus ${version%-*}" pelorus --version
check "pelorusd is of the package's version" same "pelorusd ${version%-*}" pelorusd --version
check "every verb has its manual page" bash -c '
  for verb in $(. /usr/share/bash-completion/completions/pelorus; COMP_WORDS=(pelorus "") COMP_CWORD=1; _pelorus; echo "${COMPREPLY[@]}"); do
    pelorus "$verb" --help >/dev/null && zcat "/usr/share/man/man1/pelorus-$verb.1.gz" | grep -q "^.SH OPTIONS" || exit 1
    n=$((n + 1))
  done
  [ "$n" -ge 10 ]'
check "completion knows the values of an option" same "kalibr" bash -c '
  . /usr/share/bash-completion/completions/pelorus; COMP_WORDS=(pelorus calib convert --to k) COMP_CWORD=4
  _pelorus; echo "${COMPREPLY[@]}"'
check "completion knows the options of the service" same "--check-config" bash -c '
  . /usr/share/bash-completion/completions/pelorusd; COMP_WORDS=(pelorusd --ch) COMP_CWORD=1
  _pelorusd; echo "${COMPREPLY[@]}"'
check "the service has its manual page in section 8" bash -c 'zcat /usr/share/man/man8/pelorusd.8.gz | grep -q "check.*config"'
check "pelorus-spy has its manual page" bash -c 'zcat /usr/share/man/man1/pelorus-spy.1.gz | grep -q "^.SH"'
check "the udev rule of the cameras is there" grep -q '^SUBSYSTEM' /usr/lib/udev/rules.d/60-pelorus-cameras.rules
check "the service's account is there, without a shell, in group video" bash -c '
  [[ $(getent passwd pelorus) == *:/var/lib/pelorus:*nologin ]] && id -nG pelorus | grep -qw video'
check "the configuration is a conffile and nothing else is" same "/etc/pelorus/pelorus.yaml" bash -c '
  dpkg-query -W -f "\${Conffiles}\n" pelorus | awk "NF {print \$1}"'
check "all files are as packed" same "" dpkg --verify pelorus pelorus-dev
check "the service is not enabled by itself" bash -c '! ls /etc/systemd/system/*/pelorusd.service'
check "the shipped configuration says what is missing" bash -c '
  pelorusd --config /etc/pelorus/pelorus.yaml --check-config 2>&1 | grep -q "source.path is not given"'
work=$(mktemp -d)
check "a shipped scene renders and is processed" bash -c '
  cd "$1" && pelorus synth paper --frames 6 --out dive && pelorus replay dive --out result &&
  [ "$(grep -vc "^#" result/camera.tum)" = 6 ] && [ ! -e result/INCOMPLETE ]' - "$work"
check "the run is judged against its truth" bash -c 'pelorus eval "$1/dive" "$1/result" | grep -q "absolute error, mean"' - "$work"
check "its report is a whole page, over 500 kB" bash -c '
  pelorus report "$1/result" "$1/dive" && [ "$(stat -c %s "$1/result/report.html")" -gt 500000 ] &&
  tail -c 20 "$1/result/report.html" | grep -q "</html>"' - "$work"
rm -rf "$work"
check "the types for lcm-spy are there, and pelorus-spy asks for Java only" bash -c '
  [ -s /usr/share/pelorus/pelorus-messages.jar ] && pelorus-spy 2>&1 | grep -q "Java is missing"'
check "the DBC describes the messages" grep -q "^BO_ .* VIS_VEL" /usr/share/pelorus/autopilot/pelorus.dbc
check "the documents lie with their pictures" bash -c '
  cd /usr/share/doc/pelorus && [ -s docs/overlay.png ] && [ -s core/README.md ] && [ -s README.md ]'
exit $failed
