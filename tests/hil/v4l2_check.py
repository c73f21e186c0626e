#!/usr/bin/env python3
"""One session of pelorusd on V4L2 cameras (v4l2_service_guest.sh): frames in are results out, unplugged cameras are
told and taken up again, and CAN says what LCM says.

usage: v4l2_check.py FOLDER RATE_HZ
Exit code 1 when it is not so.
"""

import json
import math
import os
import sys

from gv_record import NO_PICTURES
from lcm_log import results_and_reports

CAUSES = "dropped_in_source dropped_ring_full dropped_superseded dropped_unpaired results_dropped".split()
WITHIN_PERIODS = 5
BACK_S = 8  # a camera that is back is found, opened and started first, here by a slow machine
LEAST_QUIET_PERIODS = 8  # between two outages: of fewer nothing would be known
COUNTED_AFTER_PERIODS = 2  # a pair's loss shows when its partner or the next pair comes
COUNTED_AFTER_S = 0.5  # and is in a report that is made after that


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


def quiet_spans(pictures, away):
    """Between the first picture and the first outage, and from the first picture after each to the next."""
    spans, start = [], pictures[0]["utime"]
    for begin, end in away:
        spans.append((start, begin))
        start = next((r["utime"] for r in pictures if r["utime"] > end), math.inf)
    return spans + [(start, pictures[-1]["utime"])]


def check_flow(results, reports, away, period_us):
    """Periods without a result in each quiet span, against the losses that were counted meanwhile: from its first
    report to its last, so that no outage adds to the counters."""
    pictures = [r for r in results if r["reason"] != NO_PICTURES]
    if not pictures:
        print("FAIL: no picture became a result")
        return True
    poses = sum(r["valid"] for r in pictures)
    print(f"results of pictures {len(pictures)} ({poses} with a pose) in "
          f"{(pictures[-1]['utime'] - pictures[0]['utime']) / 1e6:.1f} s, "
          f"pairs captured {reports[-1]['pairs_captured']}")
    return any([not check_span(*span, pictures, reports, period_us) for span in quiet_spans(pictures, away)])


def check_span(start, stop, pictures, reports, period_us):
    inside = [r for r in reports if start <= r["utime"] <= stop]
    if len(inside) < 2:
        print("FAIL: no two reports between two outages")
        return False
    first, last = inside[0]["utime"], inside[-1]["utime"] - COUNTED_AFTER_PERIODS * period_us - COUNTED_AFTER_S * 1e6
    missing = periods = 0
    for a, b in zip(pictures, pictures[1:]):
        count = round((b["utime"] - a["utime"]) / period_us)
        due = [a["utime"] + (b["utime"] - a["utime"]) * i / count for i in range(1, count + 1)] if count else []
        periods += sum(first <= time <= last for time in due)
        missing += sum(first <= time <= last for time in due[:-1])
    counted = {name: inside[-1][name] - inside[0][name] for name in CAUSES}
    good = periods >= LEAST_QUIET_PERIODS and missing <= sum(counted.values())
    print(f"{'ok' if good else 'FAIL'}: of {periods} periods without a result: {missing}; counted meanwhile: "
          + (", ".join(f"{name} {value}" for name, value in counted.items() if value) or "none"))
    return good


def check_outage(begin, end, limit, results, period_us):
    """Told while it lasts; pictures again after it, before `limit`, the next one."""
    told = next((r for r in results if begin < r["utime"] < end and r["state"] == "CAMERA_FAULT"
                 and r["reason"] == NO_PICTURES), None)
    back = next((r for r in results if end < r["utime"] < limit and r["reason"] != NO_PICTURES), None)
    if told is None or back is None:
        print(f"FAIL: outage was {'told' if told else 'not told while it lasted'}, pictures "
              f"{'came' if back else 'did not come'} back before the next")
        return True
    # Pictures still come for a moment: it takes a slow machine's time to pull the plug.
    last = max((r["utime"] for r in results if r["utime"] < told["utime"] and r["reason"] != NO_PICTURES),
               default=begin)
    periods = (told["utime"] - last - period_us) / period_us
    late_s = (back["utime"] - end) / 1e6
    good = periods <= WITHIN_PERIODS and late_s <= BACK_S
    print(f"{'ok' if good else 'FAIL'}: told {periods:.1f} periods after the first exposure that did not come, "
          f"pictures again {late_s:.1f} s after its end ({back['state']})")
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
    bad = [check_flow(results, reports, away, period_us), code != 0,
           check_can(os.path.join(folder, "sets.json"), results)]
    limits = [begin for begin, _ in away[1:]] + [math.inf]
    bad += [check_outage(*outage, limit, results, period_us) for outage, limit in zip(away, limits)]
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
