#!/usr/bin/env python3
"""Recordings of can_guest.sh against the LCM messages of the same results.

Every frame that candump saw is decoded with pelorus.dbc by canmatrix, every set comes from the autopilot's C99 receiver
(pelorus can dump --sets); both have to agree with LCM to half a step of the contract. Then the faults: what has to be
reported, lost and recovered. Prints one line per check; exit code 1 when any fails.
usage: can_check.py SOURCE_ROOT FOLDER
"""

import bisect
import contextlib
import io
import json
import logging
import math
import os
import re
import sys
import warnings

warnings.simplefilter("ignore")
logging.disable(logging.CRITICAL)
import canmatrix.formats  # noqa: E402
logging.disable(logging.NOTSET)

ROOT, FOLDER = sys.argv[1], sys.argv[2]
FLOAT = 2e-7  # relative, of a binary32
failures = 0


def check(condition, text):
    global failures
    print(("ok    " if condition else "FAIL  ") + text)
    failures += 0 if condition else 1


def lines_of(name):
    with open(os.path.join(FOLDER, name), encoding="utf-8") as file:
        return file.read().splitlines()


def json_lines(name):
    return [json.loads(line) for line in lines_of(name) if line.startswith("{")]


def read_log(name):
    """(time in seconds, identifier, bytes) of every frame."""
    frames = []
    for line in lines_of(name):
        match = re.match(r"\((\d+\.\d+)\) \w+ ([0-9A-F]{3})#(?:#[0-9A-F])?([0-9A-F]*)", line)
        if match:
            frames.append((float(match.group(1)), int(match.group(2), 16), bytes.fromhex(match.group(3))))
    return frames


class Sent:
    """What LCM said, found again by the time a frame was seen and by its counter."""

    def __init__(self, name):
        self.messages = json_lines(name)
        self.times = [m["released_ns"] * 1e-9 for m in self.messages]

    def of(self, time_s, counter, modulus):
        last = bisect.bisect_right(self.times, time_s + 0.001) - 1
        for i in range(last, max(-1, last - 14), -1):
            if self.messages[i]["number"] % modulus == counter:
                return self.messages[i]
        return None


def euler(w, x, y, z):
    """Roll, pitch, yaw of a quaternion, order yaw pitch roll."""
    return (math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)), math.asin(2 * (w * y - z * x)),
            math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))


def expected_of(message):
    """The contract's signals as LCM has them; None where LCM says there is none."""
    no = [None] * 3
    tracking = message["state"] == "TRACKING"
    vel = message["vel_body_mps"] if tracking and message["step_s"] > 0 else no
    step = message["step_pos_m"] if tracking and message["step_s"] > 0 else no
    pos = message["pos_m"] if tracking else no
    rpy = euler(*message["quat_wxyz"]) if tracking else no
    want = dict(zip(("VX", "VY", "VZ", "DX", "DY", "DZ", "X", "Y", "Z", "ROLL", "PITCH", "YAW"),
                    list(vel) + list(step) + list(pos) + list(rpy)))
    body = message["body_m"] if tracking else no
    if body[0] is None:
        want.update(BEARING=None, ELEVATION=None, RANGE=None)
    else:
        want.update(BEARING=math.atan2(body[1], body[0]), RANGE=math.hypot(*body),
                    ELEVATION=math.atan2(-body[2], math.hypot(body[0], body[1])))
    want["QUALITY"] = max(1, message["quality_percent"]) if tracking else 0
    want["RESETS"] = message["reset_counter"]
    want["LATENCY"] = 0.08
    want["CALIBRATION"] = 0x5EAF100D
    return want


def tolerance_of(signal, value):
    if signal.is_float:
        return abs(value) * FLOAT + 1e-9
    return 0.5 * float(signal.factor) * (1 + 1e-6) + 1e-9


def check_candump(matrix, name, modulus):
    """Every signal of every frame, by another decoder."""
    sent = Sent(name + ".sent")
    compared = wrong = unknown = 0
    worst = 0.0
    for time_s, ident, payload in read_log(name + ".log"):
        frame = next(f for f in matrix.frames if f.arbitration_id.id == ident)
        values = frame.decode(payload)
        message = sent.of(time_s, values["COUNTER"].raw_value, modulus)
        if message is None:
            unknown += 1
            continue
        want = expected_of(message)
        for signal in frame.signals:
            if signal.name not in want:
                continue
            seen = float(values[signal.name].phys_value)
            invalid = signal.values.get(values[signal.name].raw_value) == "INVALID" or math.isnan(seen)
            truth = want[signal.name]
            if truth is not None and not signal.is_float and not signal.min <= truth <= signal.max:
                truth = None  # beyond the field: has to be sent as invalid
            compared += 1
            if truth is None or invalid:
                wrong += 0 if truth is None and invalid else 1
                continue
            allowed = tolerance_of(signal, truth)
            worst = max(worst, abs(seen - truth) / allowed)
            wrong += 1 if abs(seen - truth) > allowed else 0
    check(unknown == 0, f"{name}: every frame of candump belongs to a result ({unknown} do not)")
    check(compared > 1000 and wrong == 0,
          f"{name}: candump + DBC agree with LCM: {compared} values, {wrong} wrong, worst {worst:.3f} of the tolerance")


def check_receiver(name, modulus, fd):
    """Every set, by the autopilot's receiver."""
    sent = Sent(name + ".sent")
    steps = {"velocity_mps": 5e-4, "step_m": 5e-5, "position_m": 5e-3, "angle": 5e-5, "body_range_m": 5e-3}
    if fd:
        steps.update(velocity_mps=2e-6, step_m=1e-8, position_m=1e-6)  # and the interval's half step, below
    compared = wrong = 0
    sets = [s for s in json_lines(name + ".sets") if "state" in s]
    for one in sets:
        message = sent.of(one["time_s"], one["counter"], modulus)
        if message is None:
            wrong += 1
            continue
        want = expected_of(message)
        share = 1e-5 / one["interval_s"] if fd and one["interval_s"] else 0
        pairs = [(one["velocity_mps"][i], want["V" + "XYZ"[i]],
                  steps["velocity_mps"] + share * abs(want["V" + "XYZ"[i]] or 0)) for i in range(3)]
        pairs += [(one["position_m"][i], want["XYZ"[i]], steps["position_m"]) for i in range(3)]
        pairs += [(one["step_m"][i], want["D" + "XYZ"[i]], steps["step_m"]) for i in range(3)]
        pairs += [(one[k + "_rad"], want[k.upper()], steps["angle"]) for k in ("roll", "pitch", "yaw")]
        pairs += [(one["body_bearing_rad"], want["BEARING"], steps["angle"]),
                  (one["body_range_m"], want["RANGE"], steps["body_range_m"])]
        for seen, truth, half_step in pairs:
            if seen is None:
                continue  # slow frames, a step after a loss: less is legal, other numbers are not
            compared += 1
            wrong += 1 if truth is None or abs(seen - truth) > half_step + abs(truth) * 3 * FLOAT else 0
        wrong += 0 if one["state"] == message["state"] and one["resets"] == message["reset_counter"] else 1
        lost = message["state"] == "LOST"
        wrong += 1 if lost and any(v is not None for v in one["velocity_mps"]) else 0
    check(len(sets) == len(sent.messages), f"{name}: the receiver completed {len(sets)} of {len(sent.messages)} sets")
    check(compared > 1000 and wrong == 0, f"{name}: the C99 receiver agrees with LCM: {compared} values, {wrong} wrong")
    ages = [s["age_ms"] for s in sets if s["age_ms"] is not None]
    check(len(ages) == len(sets) and min(ages, default=0) >= 80,
          f"{name}: age {min(ages, default=0):.1f} .. {max(ages, default=0):.1f} ms, declared 80")


def check_autopilot(name, least):
    text = lines_of(name + ".autopilot")
    usable = int(text[-1].split()[0])
    check(usable >= least and "0 bad CRC" in text[-1], f"{name}: example_autopilot: {text[-1]}")
    return text


def status_states(name):
    return [line.split()[1].rstrip(",:") for line in lines_of(name + ".status") if not line.startswith("{")]


def check_down():
    states = status_states("down")
    check("down" in states and states[-1] == "active", f"down: the sender reports {' -> '.join(states)}")
    text = check_autopilot("down", 60)
    links = [line.split()[1] for line in text if line.startswith("link")]
    check(links[:5] == ["STARTING", "UP", "TIMEOUT", "STARTING", "UP"], f"down: the autopilot's link {links}")


def check_absent():
    states = status_states("absent")
    check(states[0] == "absent" and states.count("absent") == 2 and states[-1] == "active",
          f"absent: the sender reports {' -> '.join(states)}")
    check(json_lines("absent.status")[-1]["opened"] == 2, "absent: opened twice")
    for part in ("absent_first.log", "absent_second.log"):
        check(len(read_log(part)) > 100, f"absent: {len(read_log(part))} frames in {part}")


def check_slow():
    """A set takes 112 ms: none may wait behind an older one, so none arrives more than its own and one other's time late."""
    end = json_lines("slow.status")[-1]
    sent = Sent("slow.sent")
    waits = []
    for time_s, ident, payload in read_log("slow.log"):
        message = sent.of(time_s, payload[1] & 15, 16) if ident == 0x129 else None
        if message:
            waits.append(time_s - message["released_ns"] * 1e-9)
    check(end["dropped"] > 40 and end["sent"] + end["dropped"] >= 119,
          f"slow: {end['sent']} sets sent, {end['dropped']} dropped and counted")
    check(len(waits) >= 20 and max(waits) < 0.3,
          f"slow: {len(waits)} sets arrived, the oldest {max(waits, default=math.inf) * 1e3:.0f} ms after its release")


def check_short():
    end = json_lines("short.status")[-1]
    sets = [s for s in json_lines("short.sets") if "state" in s]
    check(end["sent"] >= 95 and len(sets) >= 95, f"short queue: {end['sent']} sets sent in parts, {len(sets)} received whole")


def main():
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        matrix = canmatrix.formats.loadp_flat(os.path.join(ROOT, "firmware-host", "autopilot", "pelorus.dbc"))
    check(said.getvalue() == "", "canmatrix takes the DBC without a word")
    for name, modulus in (("classic", 16), ("fd", 256)):
        check_candump(matrix, name, modulus)
        check_receiver(name, modulus, name == "fd")
        check_autopilot(name, 180)
    check_down()
    check_absent()
    check_slow()
    check_short()
    print(f"can_check: {failures} failure(s)")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
