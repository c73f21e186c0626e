#!/usr/bin/env python3
"""What the service made of two cameras of which it is known what they took and when (gv_cameras SHOWN_CSV).

usage: gv_check.py drops LOG SHOWN RATE_HZ            every exposure is a result, or a counted loss with its cause
       gv_check.py played LOG SHOWN RATE_HZ DATASET OUT   the pairs of the results as an EuRoC folder, for pelorus replay
       gv_check.py poses LOG RESULTS [TOLERANCE_M TOLERANCE_DEG]   results against those of `pelorus replay` of the same pairs
       gv_check.py faults LOG SHOWN RATE_HZ CAMERAS_TXT [FRAMES]   each fault is told as a state within FRAMES (5)
Exit code 1 when it is not so.
"""

import csv
import math
import os
import sys

from lcm_log import events, health, odom

CAUSES = "dropped_in_source dropped_ring_full dropped_superseded dropped_unpaired results_dropped".split()
NO_PICTURES = "no pictures"
HEALTH_LAG_US = 400_000  # a loss is in the counters so long after its exposure


def read_log(path):
    results, reports = [], []
    for received_us, channel, data in events(path):
        if channel.endswith(".VIS_ODOM"):
            results.append({**odom(data), "received": received_us})
        elif channel.endswith(".VIS_HEALTH"):
            reports.append(health(data))
    return results, reports


class Shown:
    """Exposures by number: multiples of the period on the wall clock."""

    def __init__(self, path, rate_hz):
        self.period_us = 1e6 / float(rate_hz)
        self.frames = {"left": {}, "right": {}}
        with open(path, encoding="ascii") as rows:
            for side, time_ns, frame in csv.reader(rows):
                self.frames[side][self.tick(int(time_ns) / 1000)] = int(frame)

    def tick(self, time_us):
        return round(time_us / self.period_us)


def check_drops(log, shown_path, rate_hz):
    shown = Shown(shown_path, rate_hz)
    results, reports = read_log(log)
    pictures = [r for r in results if r["reason"] != NO_PICTURES]
    first, last = shown.tick(pictures[0]["utime"]), shown.tick(pictures[-1]["utime"])
    answered = {shown.tick(r["utime"]) for r in pictures}
    not_taken, lost = {"left": 0, "right": 0, "both": 0}, []
    for tick in range(first, last + 1):
        sides = [side for side in ("left", "right") if tick not in shown.frames[side]]
        if sides:
            not_taken["both" if len(sides) == 2 else sides[0]] += 1
        elif tick not in answered:
            lost.append(tick)
    counted = {name: reports[-1][name] for name in CAUSES}
    unexplained = [t for t in lost if not counted_around(t, shown, reports)]
    bad = unexplained or len(lost) > sum(counted.values())
    foreign = [t for t in answered if t not in shown.frames["left"] or t not in shown.frames["right"]]
    print(f"exposures {last - first + 1} in {(last - first) * shown.period_us / 1e6:.1f} s, results {len(answered)}; "
          f"not taken by the software cameras: left {not_taken['left']}, right {not_taken['right']}, "
          f"both {not_taken['both']}")
    print(f"taken and without result: {len(lost)}; counted by the service: "
          + (", ".join(f"{name} {value}" for name, value in counted.items() if value) or "none")
          + f"; unexplained: {len(unexplained)}; results of no exposure: {len(foreign)}")
    gaps = sum(b["seq"] - a["seq"] - 1 for a, b in zip(pictures, pictures[1:]))
    print(f"results shed optional work {reports[-1]['steps_shed']} times, later than declared "
          f"{sum(r['late'] for r in pictures)}, gaps in their numbers {gaps}")
    return bool(bad or foreign)


def counted_around(tick, shown, reports):
    """Whether the counters of the reports before and after this exposure differ."""
    time_us = tick * shown.period_us
    before = [r for r in reports if r["utime"] < time_us] or [dict.fromkeys(CAUSES, 0)]
    after = [r for r in reports if r["utime"] > time_us + HEALTH_LAG_US]
    if not after:
        return False
    return any(after[0][name] > before[-1][name] for name in CAUSES)


def write_played(log, shown_path, rate_hz, dataset, out):
    shown = Shown(shown_path, rate_hz)
    pictures = [r for r in read_log(log)[0] if r["reason"] != NO_PICTURES]
    mav0 = os.path.join(dataset, "mav0") if os.path.isdir(os.path.join(dataset, "mav0")) else dataset
    mav0 = os.path.realpath(mav0)
    for camera, side in (("cam0", "left"), ("cam1", "right")):
        folder = os.path.join(out, "mav0", camera)
        os.makedirs(folder)
        for name in ("data", "sensor.yaml"):
            os.symlink(os.path.join(mav0, camera, name), os.path.join(folder, name))
        with open(os.path.join(mav0, camera, "data.csv"), encoding="ascii") as rows:
            names = [row[1].strip() for row in csv.reader(rows) if row and not row[0].startswith("#")]
        with open(os.path.join(folder, "data.csv"), "w", encoding="ascii") as rows:
            for result in pictures:
                rows.write(f"{result['utime'] * 1000},{names[shown.frames[side][shown.tick(result['utime'])]]}\n")
    return False


def in_body(position, quaternion):
    """From camera axes (right, down, ahead) to those of a body whose camera looks ahead, at its origin."""
    x, y, z = position
    w, qx, qy, qz = quaternion
    return (z, x, y), (w, qz, qx, qy)


def check_poses(log, results_folder, tolerance_m=None, tolerance_deg=None):
    live = [r for r in read_log(log)[0] if r["reason"] != NO_PICTURES]
    with open(os.path.join(results_folder, "frames.csv"), encoding="ascii") as rows:
        frames = list(csv.DictReader(rows))
    with open(os.path.join(results_folder, "camera.tum"), encoding="ascii") as rows:
        lines = [line.split() for line in rows if not line.startswith("#")]
    poses = {int(line[0].replace(".", "")): [float(value) for value in line[1:]] for line in lines}
    replayed = {int(frame["timestamp_ns"]): frame for frame in frames}
    renumbered = int(frames[0]["seq"]) - live[0]["seq"]
    distances, angles, sigmas, unequal, numbers = [], [], [], 0, 0
    for result in live:
        frame = replayed.get(result["utime"] * 1000)
        if frame is None:
            print(f"result {result['seq']} is not in the replay")
            return True
        numbers += int(frame["seq"]) - renumbered == result["seq"]
        if bool(int(frame["pose_valid"])) != result["valid"]:
            unequal += 1
        elif result["valid"]:
            x, y, z, qx, qy, qz, qw = poses[int(frame["timestamp_ns"])]
            position, quaternion = in_body((x, y, z), (qw, qx, qy, qz))
            distances.append(math.dist(position, result["position"]))
            dot = abs(sum(a * b for a, b in zip(quaternion, result["quaternion"])))
            angles.append(math.degrees(2 * math.acos(min(1.0, dot))))
            sigmas.append(distances[-1] / math.sqrt(max(sum(result["variances"][:3]), 1e-18)))
    equal = sum(distance < 1e-6 for distance in distances)
    print(f"poses of the same exposure compared: {len(distances)} of {len(live)}, of the same number {numbers}; one valid, the other not: {unequal}; "
          f"equal to 1e-6 m: {equal}")
    if not distances:
        return True
    for name, values in (("apart [mm]", [1000 * d for d in distances]), ("turned [deg]", angles),
                         ("apart in declared deviations", sigmas)):
        values.sort()
        print(f"{name}: p50 {values[len(values) // 2]:.4f} p99 {values[int(0.99 * len(values))]:.4f} max {values[-1]:.4f}")
    if tolerance_m is None:
        return False
    return unequal > 0 or distances[-1] > float(tolerance_m) or angles[-1] > float(tolerance_deg)


FAULTS = {"off": ("CAMERA_FAULT", "no pictures"), "freeze": ("CAMERA_FAULT", "frozen")}


def first_affected(fault, at_us, shown):
    """The first exposure that the fault spoils: not taken, or the same picture again."""
    verb, side = fault
    frames = shown.frames[side]
    after = sorted(tick for tick in frames if tick * shown.period_us > at_us - shown.period_us)
    if verb == "freeze":
        return next((tick for tick in after if tick - 1 in frames and frames[tick] == frames[tick - 1]), None)
    return max(tick for tick in frames if tick * shown.period_us <= at_us) + 1  # of this side


def check_faults(log, shown_path, rate_hz, cameras, within=5):
    shown = Shown(shown_path, rate_hz)
    results = read_log(log)[0]
    bad, checked = False, 0
    with open(cameras, encoding="utf-8") as lines:
        obeyed = [line.split() for line in lines if line.startswith("obeyed")]
    for _, time_ns, verb, side, *values in obeyed:
        if verb not in FAULTS or values == ["0"]:
            continue
        checked += 1
        at_us = int(time_ns) / 1000
        spoiled = first_affected((verb, side), at_us, shown)
        if spoiled is None:
            print(f"{verb} {side}: spoiled no exposure")
            bad = True
            continue
        spoiled_us = spoiled * shown.period_us
        state, reason = FAULTS[verb]
        told = next((r for r in results if r["utime"] >= spoiled_us and r["state"] == state and reason in r["reason"]), None)
        doubted = next((r for r in results if r["utime"] >= spoiled_us and r["state"] != "TRACKING"), None)
        frames = (told["utime"] - spoiled_us) / shown.period_us if told else math.inf
        out_ms = (told["publish_utime"] - spoiled_us) / 1000 if told else math.inf
        note = f"; first not TRACKING: {doubted['state']} ({doubted['reason']}), " \
               f"{(doubted['utime'] - spoiled_us) / shown.period_us:.1f} frames" if doubted else ""
        good = frames <= float(within)
        bad = bad or not good
        print(f"{'ok' if good else 'FAIL'}: {verb} {side}: {state} ({reason}) {frames:.1f} frames after the first "
              f"exposure it spoiled, published after {out_ms:.0f} ms{note}")
    if not checked:
        print("no fault was injected")
    return bad or not checked


CHECKS = {"drops": check_drops, "played": write_played, "poses": check_poses, "faults": check_faults}

if __name__ == "__main__":
    if len(sys.argv) < 4 or sys.argv[1] not in CHECKS:
        sys.exit(__doc__)
    sys.exit(1 if CHECKS[sys.argv[1]](*sys.argv[2:]) else 0)
