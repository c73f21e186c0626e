#!/usr/bin/env python3
"""The unit file as systemd itself reads it: no unknown key, exposure at most 2.5; and that this test can fail.

Usage: unit_test.py SYSTEMD_ANALYZE UNIT PROGRAM. Exit code 77: skipped.
"""

import os
import subprocess
import sys
import tempfile

THRESHOLD = "25"  # tenths


def run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    return done.returncode, done.stdout


def unit_with(folder, text, program):
    """A copy of the unit that names the program where it was built: verify insists that it exists."""
    path = os.path.join(folder, "pelorusd.service")
    with open(path, "w", encoding="utf-8") as unit:
        unit.write(text.replace("/usr/bin/pelorusd", program))
    return path


def problems(analyze, folder, text, program):
    path = unit_with(folder, text, program)
    found = []
    code, said = run(analyze, "verify", "--man=no", path)
    # Unknown keys are only warnings with exit code 0; other units of the host are none of ours.
    ours = [line for line in said.splitlines() if "pelorusd" in line]
    if code != 0 and ours or ours:
        found.append("verify: " + "\n".join(ours))
    code, said = run(analyze, "security", "--offline=true", "--threshold=" + THRESHOLD, "--no-pager", path)
    if code != 0:
        found.append("security: " + said.strip().splitlines()[-1])
    return found


def main(arguments):
    analyze, unit, program = arguments[1:]
    with open(unit, encoding="utf-8") as file:
        text = file.read()
    with tempfile.TemporaryDirectory() as folder:
        if run(analyze, "security", "--offline=true", unit_with(folder, text, program))[0] == 127:
            print("skipped: systemd-analyze cannot work offline here")
            return 77
        for problem in (found := problems(analyze, folder, text, program)):
            print(problem)
        broken = {
            "an unknown key": text.replace("WatchdogSec=", "WatchdogSecs="),
            "an absent program": text.replace("ExecStart=/usr/bin/", "ExecStart=/nonexistent/"),
            "an open system": text.replace("ProtectSystem=strict", "").replace("SystemCallFilter", "# "),
        }
        blind = [name for name, bad in broken.items() if not problems(analyze, folder, bad, program)]
        for name in blind:
            print(f"self-test: {name} was not noticed")
    return 1 if found or blind else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
