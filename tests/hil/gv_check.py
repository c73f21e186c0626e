#!/usr/bin/env python3
"""What the service made of two cameras of which it is known what they took and when (gv_cameras SHOWN_CSV).

usage: gv_check.py drops LOG SHOWN RATE_HZ            every exposure is a result, or a counted loss with its cause
       gv_check.py played LOG SHOWN RATE_HZ DATASET OUT   the pairs of the results as an EuRoC folder, for pelorus replay
       gv_check.py poses LOG RESULTS [TOLERANCE_M TOLERANCE_DEG [TOLERANCE_OF_BODIES_DEG]]
                                                                   results and bodies against those of `pelorus replay` of
                                                                   the same pairs
       gv_check.py faults LOG SHOWN RATE_HZ CAMERAS_TXT [FRAMES]   each fault is told as a state within FRAMES (5), counted
                                                                   as injected, and over when it is over
Exit code 1 when it is not so.
"""

import csv
import math
import os
import sys

from gv_faults import check_faults
from gv_record import NO_PICTURES, Shown
from lcm_log import events, results_and_reports, tracks

CAUSES = "dropped_in_source dropped_ring_full dropped_superseded dropped_unpaired results_dropped".split()
MOST_ONE_SIDED = 0.02  # of the bodies: found or given up a pair earlier
TURNED_MORE = 2  # a body has few points and is small: its orientation is worth less than the vehicle's
HEALTH_LAG_US = 400_000  # a loss is in the counters so long after its exposure


def check_drops(log, shown_path, rate_hz):
    shown = Shown(shown_path, rate_hz)
    results, reports = results_and_reports(log)
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
    pictures = [r for r in results_and_reports(log)[0] if r["reason"] != NO_PICTURES]
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


def turned_deg(a, b):
    return math.degrees(2 * math.acos(min(1.0, abs(sum(x * y for x, y in zip(a, b))))))


class Differences:
    """Between the live and the stepped estimate of the same exposure."""

    def __init__(self, name):
        self.name, self.apart_m, self.turned_deg, self.sigmas = name, [], [], []

    def add(self, position, quaternion, live):
        self.apart_m.append(math.dist(position, live["position"]))
        self.turned_deg.append(turned_deg(quaternion, live["quaternion"]))
        self.sigmas.append(self.apart_m[-1] / math.sqrt(max(sum(live["variances"][:3]), 1e-18)))

    def tell(self):
        for what, values in (("apart [mm]", [1000 * d for d in self.apart_m]), ("turned [deg]", self.turned_deg),
                             ("apart in declared deviations", self.sigmas)):
            values = sorted(values)
            print(f"{self.name} {what}: p50 {values[len(values) // 2]:.4f} p99 {values[int(0.99 * len(values))]:.4f} "
                  f"max {values[-1]:.4f}")

    def beyond(self, tolerance_m, tolerance_deg):
        return max(self.apart_m) > float(tolerance_m) or max(self.turned_deg) > float(tolerance_deg)


def check_poses(log, results_folder, tolerance_m=None, tolerance_deg=None, bodies_deg=None):
    live = [r for r in results_and_reports(log)[0] if r["reason"] != NO_PICTURES]
    with open(os.path.join(results_folder, "frames.csv"), encoding="ascii") as rows:
        frames = list(csv.DictReader(rows))
    with open(os.path.join(results_folder, "camera.tum"), encoding="ascii") as rows:
        lines = [line.split() for line in rows if not line.startswith("#")]
    poses = {int(line[0].replace(".", "")): [float(value) for value in line[1:]] for line in lines}
    replayed = {int(frame["timestamp_ns"]): frame for frame in frames}
    renumbered = int(frames[0]["seq"]) - live[0]["seq"]
    differences, unequal, numbers = Differences("vehicle"), 0, 0
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
            differences.add(position, quaternion, result)
    equal = sum(distance < 1e-6 for distance in differences.apart_m)
    print(f"poses of the same exposure compared: {len(differences.apart_m)} of {len(live)}, of the same number {numbers}; "
          f"one valid, the other not: {unequal}; equal to 1e-6 m: {equal}")
    if not differences.apart_m:
        return True
    differences.tell()
    bodies_bad = check_bodies(log, results_folder, tolerance_m, bodies_deg or TURNED_MORE * float(tolerance_deg or 0))
    if tolerance_m is None:
        return False
    return unequal > 0 or differences.beyond(tolerance_m, tolerance_deg) or bodies_bad


# The body's own axes stay: T_body_cam * T_cam0_obj turns from one side only.
LOOKING_AHEAD = (0.5, 0.5, 0.5, 0.5)  # (w, x, y, z) of R_body_cam: image right is starboard, image down is down


def product(a, b):
    w, x, y, z = a
    v, p, q, r = b
    return (w * v - x * p - y * q - z * r, w * p + x * v + y * r - z * q, w * q - x * r + y * v + z * p,
            w * r + x * q - y * p + z * v)


def check_bodies(log, results_folder, tolerance_m, tolerance_deg):
    """Bodies by their number: the same in both, and in the same place."""
    with open(os.path.join(results_folder, "objects.csv"), encoding="ascii") as rows:
        stepped = {}
        for row in csv.DictReader(rows):
            stepped.setdefault(int(row["timestamp_ns"]) // 1000, {})[int(row["object_id"])] = row
    differences, one_sided, total = Differences("bodies"), 0, 0
    for _, channel, data in events(log):
        if not channel.endswith(".VIS_TRACKS"):
            continue
        live = tracks(data)
        other = stepped.get(live["utime"], {})
        total += len(live["bodies"].keys() | other.keys())
        one_sided += len(live["bodies"].keys() ^ other.keys())
        for ident in live["bodies"].keys() & other.keys():
            row = {name: float(value) for name, value in other[ident].items() if name[:2] in ("p_", "q_")}
            position, _ = in_body((row["p_x"], row["p_y"], row["p_z"]), (1, 0, 0, 0))
            quaternion = product(LOOKING_AHEAD, (row["q_w"], row["q_x"], row["q_y"], row["q_z"]))
            differences.add(position, quaternion, live["bodies"][ident])
    print(f"bodies of the same exposure and number compared: {len(differences.apart_m)}; in one of the two only: "
          f"{one_sided} of {total}")
    if not differences.apart_m:
        print("no body in both")
        return True
    differences.tell()
    if tolerance_m is None:
        return False
    return one_sided > MOST_ONE_SIDED * total or differences.beyond(tolerance_m, tolerance_deg)


CHECKS = {"drops": check_drops, "played": write_played, "poses": check_poses, "faults": check_faults}

if __name__ == "__main__":
    if len(sys.argv) < 4 or sys.argv[1] not in CHECKS:
        sys.exit(__doc__)
    sys.exit(1 if CHECKS[sys.argv[1]](*sys.argv[2:]) else 0)
