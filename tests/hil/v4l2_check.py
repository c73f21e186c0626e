#!/usr/bin/env python3
"""One session of pelorusd on V4L2 cameras (v4l2_service_guest.sh): frames in are results out, unplugged cameras are told
and taken up again, and CAN says what LCM says.

usage: v4l2_check.py FOLDER RATE_HZ
Exit code 1 when it is not so.
"""

import json
import os
import sys

from gv_record import NO_PICTURES
from lcm_log import results_and_reports

CAUSES = "dropped_in_source dropped_ring_full dropped_superseded dropped_unpaired results_dropped".split()
WITHIN_PERIODS = 5
BACK_S = 8  # a camera that is back is found, opened and started first, here by a slow machine


def outages(path):
    """From the first side that is off until none is: [begin, end] in microseconds."""
    found, sides = [], set()
    with open(path, encoding="ascii") as lines:
        for _, time_ns, verb, side in map(str.split, lines):
            if verb == "off":
                if not sides:
                    found.append([int(time_ns) / 1000, None])
                sides.add(side)
            else:
                sides.discard(side)
                if not sides:
                    found[-1][1] = int(time_ns) / 1000
    return found


def check_flow(results, reports, away, period_us):
    """Periods without a result, outages aside, against the counted losses."""
    pictures = [r for r in results if r["reason"] != NO_PICTURES]
    missing = 0
    for a, b in zip(pictures, pictures[1:]):
        if not any(a["utime"] <= end + BACK_S * 1e6 and b["utime"] >= begin for begin, end in away):
            missing += max(0, round((b["utime"] - a["utime"]) / period_us) - 1)
    counted = {name: reports[-1][name] for name in CAUSES}
    poses = sum(r["valid"] for r in pictures)
    print(f"results of pictures {len(pictures)} ({poses} with a pose) in {(pictures[-1]['utime'] - pictures[0]['utime']) / 1e6:.1f} s, "
          f"pairs captured {reports[-1]['pairs_captured']}; periods without one, outages aside: {missing}; counted: "
          + (", ".join(f"{name} {value}" for name, value in counted.items() if value) or "none"))
    return missing > sum(counted.values()) or not pictures


def check_outage(begin, end, results, period_us):
    told = next((r for r in results if r["utime"] > begin and r["state"] == "CAMERA_FAULT" and r["reason"] == NO_PICTURES), None)
    back = next((r for r in results if r["utime"] > end and r["reason"] != NO_PICTURES), None)
    if told is None or back is None:
        print(f"FAIL: outage was {'told' if told else 'not told'}, pictures {'came' if back else 'did not come'} back")
        return True
    # Pictures still come for a moment: it takes a slow machine's time to pull the plug.
    last = max((r["utime"] for r in results if r["utime"] < told["utime"] and r["reason"] != NO_PICTURES), default=begin)
    periods = (told["utime"] - last - period_us) / period_us
    late_s = (back["utime"] - end) / 1e6
    good = periods <= WITHIN_PERIODS and late_s <= BACK_S
    print(f"{'ok' if good else 'FAIL'}: told {periods:.1f} periods after the first exposure that did not come, pictures again "
          f"{late_s:.1f} s after its end ({back['state']})")
    return not good


def check_can(path, results):
    with open(path, encoding="utf-8") as lines:
        sets = [line for line in map(json.loads, filter(lambda l: l.startswith("{"), lines)) if "state" in line]
    same = [one["state"] for one in sets] == [result["state"] for result in results]
    print(f"{'ok' if same else 'FAIL'}: results on LCM {len(results)}, sets on CAN {len(sets)}, states of both "
          f"{'equal' if same else 'differ'}")
    return not same


def main(folder, rate_hz):
    results, reports = results_and_reports(os.path.join(folder, "log.lcm"))
    if not results or not reports:
        print("FAIL: nothing was published")
        return True
    period_us = 1e6 / float(rate_hz)
    away = outages(os.path.join(folder, "events"))
    with open(os.path.join(folder, "code"), encoding="ascii") as file:
        code = int(file.read())
    bad = [check_flow(results, reports, away, period_us), check_can(os.path.join(folder, "sets.json"), results), code != 0]
    bad += [check_outage(begin, end, results, period_us) for begin, end in away]
    print(f"exit code {code}; cameras opened anew {reports[-1]['camera_reopens']}, times without pictures "
          f"{reports[-1]['camera_timeouts']}")
    if reports[-1]["camera_timeouts"] < len(away) or (away and reports[-1]["camera_reopens"] < len(away)):
        print("FAIL: counted less often than it happened")
        bad.append(True)
    return any(bad)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(1 if main(sys.argv[1], sys.argv[2]) else 0)
