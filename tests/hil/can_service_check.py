#!/usr/bin/env python3
"""CAN against LCM of the same pelorusd: every result is one set with the same numbers; how
long after the exposure each is there; and a bus that goes down is in VIS_HEALTH within five pictures.

usage: can_service_check.py sets FOLDER NAME RESULTS   NAME.lcm and NAME.sets.json of can_service.sh
       can_service_check.py live FOLDER                log.lcm and log.sets.json of gigevision.sh
       can_service_check.py down FOLDER RATE_HZ        down.lcm and down_ns of can_service.sh
Exit code 1 when it is not so.
"""

import glob
import json
import math
import os
import sys

from lcm_check import percentiles
from lcm_log import results_and_reports

# Half a step of the contract (docs/can.md).
HALF_STEP = {"velocity_mps": 5e-4, "position_m": 5e-3, "angle_rad": 5e-5}
MOST_APART_US = 150_000  # between the release of a result and the last frame of its set


def log_of(folder, name):
    (path,) = glob.glob(os.path.join(folder, name + ".lcm*"))
    return path


def euler(w, x, y, z):
    """Roll, pitch, yaw of a quaternion, order yaw pitch roll."""
    return (math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)), math.asin(2 * (w * y - z * x)),
            math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))


def set_of(result, sets):
    """The set that left with this result: the first whose last frame came after its release."""
    return next((s for s in sets if 0 <= s["time_s"] * 1e6 - result["publish_utime"] + 1000 <= MOST_APART_US), None)


def wrong_numbers(result, one):
    """Names of what CAN and LCM do not agree on; and how many numbers were compared."""
    pairs = []
    if result["velocity"] is not None:
        pairs += [("velocity_mps", a, b) for a, b in zip(one["velocity_mps"], result["velocity"])]
    if result["valid"]:
        pairs += [("position_m", a, b) for a, b in zip(one["position_m"], result["position"])]
        pairs += [("angle_rad", one[name + "_rad"], b)
                  for name, b in zip(("roll", "pitch", "yaw"), euler(*result["quaternion"]))]
    compared = [(name, a, b) for name, a, b in pairs if a is not None]  # slow frames come with every few sets
    wrong = [name for name, a, b in compared if abs(a - b) > HALF_STEP[name] + 1e-6 * abs(b)]
    wrong += [name for name, same in (("state", one["state"] == result["state"]), ("resets", one["resets"] == result["resets"]))
              if not same]
    return wrong, len(compared)


def sets_in(folder, name):
    with open(os.path.join(folder, name + ".sets.json"), encoding="utf-8") as lines:
        return [line for line in map(json.loads, filter(lambda l: l.startswith("{"), lines)) if "state" in line]


def compare(results, sets):
    """Each result with its set: how many have none, how many numbers agree, the names of those that do not."""
    compared, to_can, to_lcm, wrong, without = 0, [], [], [], []
    for result in results:
        one = set_of(result, sets)
        if one is None:
            without.append(result["seq"])
            continue
        differing, count = wrong_numbers(result, one)
        wrong += differing
        compared += count
        to_lcm.append((result["received"] - result["utime"]) / 1000)
        to_can.append(one["time_s"] * 1e3 - result["utime"] / 1000)
    print(f"numbers of CAN compared with LCM: {compared}, beyond half a step: {len(wrong)} {sorted(set(wrong))}")
    for name, values in (("capture to LCM", to_lcm), ("capture to CAN", to_can)):
        print(f"{name} [ms]: " + " ".join(f"{k} {v:.2f}" for k, v in percentiles(values).items()))
    return without, compared, wrong


def check_sets(folder, name, results_published):
    expected = int(results_published)
    results, reports = results_and_reports(log_of(folder, name))
    sets = sets_in(folder, name)
    counted = reports[-1]["can_sets_sent"]  # the last results leave after the last report
    bad = len(results) != expected or len(sets) != expected or not len(sets) - 3 <= counted <= len(sets)
    print(f"results on LCM {len(results)}, sets on CAN {len(sets)}, last VIS_HEALTH counts {counted}")
    without, compared, wrong = compare(results, sets)
    if without:
        print(f"results without a set: {without}")
    return bad or bool(without) or bool(wrong) or compared < 6 * expected


def check_live_sets(folder):
    """Of a run in which the bus may have been down: a result without a set has to be counted as unheard or dropped."""
    results, reports = results_and_reports(log_of(folder, "log"))
    sets = sets_in(folder, "log")
    without, compared, wrong = compare(results, sets)
    uncounted = len(without) - reports[-1]["can_sets_unheard"] - reports[-1]["can_sets_dropped"]
    print(f"results on LCM {len(results)}, sets on CAN {len(sets)}, without a set {len(without)}, counted as unheard "
          f"{reports[-1]['can_sets_unheard']}, as dropped {reports[-1]['can_sets_dropped']}")
    poses = sum(r["valid"] for r in results)
    return bool(wrong) or uncounted > 0 or compared < 3 * (poses - len(without))


def check_down(folder, rate_hz):
    _, reports = results_and_reports(log_of(folder, "down"))
    with open(os.path.join(folder, "down_ns"), encoding="ascii") as file:
        down_us = int(file.read()) / 1000
    told = next((r for r in reports if r["utime"] > down_us and " down" in r["can_text"]), None)
    if told is None:
        print(f"FAIL: the bus went down and VIS_HEALTH never said so: {reports[-1]['can_text']}")
        return True
    late_ms = (told["utime"] - down_us) / 1000
    print(f"bus down told after {late_ms:.0f} ms: {told['can_text']}")
    # Sooner than the next second's report would have had to come.
    return late_ms > min(5e3 / float(rate_hz), 500)


CHECKS = {"sets": check_sets, "live": check_live_sets, "down": check_down}

if __name__ == "__main__":
    if len(sys.argv) < 3 or sys.argv[1] not in CHECKS:
        sys.exit(__doc__)
    sys.exit(1 if CHECKS[sys.argv[1]](*sys.argv[2:]) else 0)
