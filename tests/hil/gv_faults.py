"""Whether each injected fault was told in time, counted as injected, and over when it was over."""

import math
import os
from collections import namedtuple

from gv_outputs import CHECKS as AROUND
from gv_record import NO_PICTURES, Shown, growth
from lcm_log import results_and_reports

# What a fault has to lead to: a state and its reason, and the counter that has to grow.
Fault = namedtuple("Fault", "state reason counter")
FAULTS = {
    "off": Fault("CAMERA_FAULT", "no pictures", "camera_timeouts"),
    "freeze": Fault("CAMERA_FAULT", "frozen", "frozen_spells"),
    "clock": Fault("CAMERA_FAULT", "no pictures", "time_jumps"),  # of one side: the stamps of the two no longer match
    "clock of both": Fault("DEGRADED", "time stamps jumped", "time_jumps"),
    "loss": Fault("DEGRADED", "pairs dropped", "dropped_in_source"),
    "heavy loss": Fault("CAMERA_FAULT", "no pictures", "camera_timeouts"),  # hardly a picture is whole
    "late": Fault("LOST", "few points", "losses_of_track"),
    "swap": Fault("LOST", "few points", "losses_of_track"),
}
NO_POSE = ("late", "swap")  # nobody can know what is wrong, but no pose may come of it
EXCHANGED = "left and right pictures exchanged"  # of both sides, when it has lasted for three seconds
BACK_FRAMES = {"off": 100, "heavy loss": 100}  # a camera that is on again is found, opened and started first
BACK_OTHERS = 20
HEAVY_LOSS = 0.005  # of the packets, of which a picture has hundreds


class Episode:
    """Faults of one kind that overlap: from the first command to that which ends the last of them."""

    def __init__(self, verb, sides, start_us, end_us):
        self.verb, self.sides, self.start_us, self.end_us = verb, sides, start_us, end_us

    @property
    def fault(self):
        both = f"{self.verb} of both"
        return FAULTS[both] if len(self.sides) == 2 and both in FAULTS else FAULTS.get(self.verb)

    @property
    def name(self):
        return f"{self.verb} {'+'.join(sorted(self.sides))}"


def episodes(folder):
    found, open_sides, current, obeyed = [], set(), None, []
    for name in ("cameras.txt", "around.txt"):
        with open(os.path.join(folder, name), encoding="utf-8") as lines:
            obeyed += [line.split() for line in lines if line.startswith("obeyed")]
    for _, time_ns, verb, side, *values in sorted(obeyed, key=lambda words: int(words[1])):
        time_us = int(time_ns) / 1000
        if verb == "on" or values == ["0"]:
            open_sides.discard(side)
            if current and not open_sides:
                current.end_us = time_us
                found.append(current)
                current = None
        else:
            open_sides.add(side)
            if verb == "loss" and float(values[0]) >= HEAVY_LOSS:
                verb = "heavy loss"
            if current is None:
                current = Episode(verb, set(), time_us, None)
            current.sides.add(side)
    return found + ([current] if current else [])


def first_spoiled(episode, shown, answered):
    """The first exposure that shows the fault: not taken, the same picture again, lost on the way, of the wrong picture."""
    side = sorted(episode.sides)[0]
    frames = shown.frames[side]
    after = sorted(tick for tick in frames if tick * shown.period_us > episode.start_us - shown.period_us)
    if episode.verb == "freeze":
        return next((tick for tick in after if tick - 1 in frames and frames[tick] == frames[tick - 1]), None)
    if episode.verb == "off":
        return max(max(t for t in shown.frames[s] if t * shown.period_us <= episode.start_us) for s in episode.sides) + 1
    if episode.verb in ("loss", "heavy loss"):
        both = shown.frames["left"].keys() & shown.frames["right"].keys()
        return next((tick for tick in after if tick in both and tick not in answered), None)
    return next((tick for tick in after if tick * shown.period_us >= episode.start_us), None)


def spells(results, fault):
    """Runs of results of that state and reason."""
    count, inside = 0, False
    for result in results:
        matches = result["state"] == fault.state and fault.reason in result["reason"]
        count += matches and not inside
        inside = matches
    return count


def between(results, from_us, to_us):
    return [r for r in results if from_us <= r["utime"] <= to_us]


def check_no_pose(episode, shown, results):
    """Of results of wrong pictures."""
    wrong = between(results, shown.tick(episode.start_us + shown.period_us) * shown.period_us, episode.end_us)
    said = sorted({f"{r['state']} ({r['reason']})" for r in wrong})
    poses = sum(r["valid"] for r in wrong)
    exchanged = any(r["reason"] == EXCHANGED for r in wrong)
    return (len(wrong) > 5 and poses == 0 and exchanged == (episode.verb == "swap" and len(episode.sides) == 2),
            f"{len(wrong)} results of wrong pictures, {poses} with a pose; said was {', '.join(said)}")


def check_told(episode, fault, shown, results, within):
    answered = {shown.tick(r["utime"]) for r in results if r["reason"] != NO_PICTURES}
    spoiled = first_spoiled(episode, shown, answered)
    if spoiled is None:
        return False, "spoiled no exposure"
    spoiled_us = spoiled * shown.period_us
    inside = between(results, spoiled_us, episode.end_us + within * shown.period_us)
    told = next((r for r in inside if r["state"] == fault.state and fault.reason in r["reason"]), None)
    if told is None:
        seen = ", ".join(sorted({f"{r['state']} ({r['reason']})" for r in inside}))
        return False, f"not told; said was {seen}"
    out_us = told["publish_utime"] - spoiled_us
    frames = out_us / shown.period_us
    return frames <= within, (f"{told['state']} ({told['reason']}) published {frames:.1f} frames, {out_us / 1000:.0f} ms, "
                              f"after the first exposure it spoiled")


def check_back(episode, shown, results):
    allowed = BACK_FRAMES.get(episode.verb, BACK_OTHERS)
    back = next((r for r in results if r["utime"] > episode.end_us and r["state"] == "TRACKING"), None)
    frames = (back["utime"] - episode.end_us) / shown.period_us if back else math.inf
    return frames <= allowed, f"TRACKING {frames:.1f} frames after its end", back


def check_counted(episode, fault, shown, results, reports, until_us):
    grown = growth(reports, fault.counter, episode.start_us, until_us)
    if math.isnan(grown):
        return False, "no VIS_HEALTH before or after"
    inside = between(results, episode.start_us, until_us)
    if episode.verb == "loss":
        answered = {shown.tick(r["utime"]) for r in inside if r["reason"] != NO_PICTURES}
        both = shown.frames["left"].keys() & shown.frames["right"].keys()
        lost = [t for t in both if episode.start_us <= t * shown.period_us <= until_us and t not in answered]
        others = sum(growth(reports, name, episode.start_us, until_us)
                     for name in ("dropped_ring_full", "dropped_superseded", "results_dropped"))
        # Each picture lost on the way costs an exposure; what costs one beside it has a counter too, but some of that
        # is the other picture of an exposure that is lost already.
        return 0 < grown <= len(lost) <= grown + others, (f"{len(lost)} exposures lost, {fault.counter} +{grown}, "
                                                          f"dropped elsewhere +{others}")
    if episode.verb == "clock":
        return grown == 2 * len(episode.sides), f"{fault.counter} +{grown}"  # away and back
    if episode.verb == "off":
        reopened = growth(reports, "camera_reopens", episode.start_us, until_us)
        if reopened != len(episode.sides):
            return False, f"camera_reopens +{reopened}"
    told = spells(inside, fault)
    good = grown == told and grown >= 1 and (episode.verb != "freeze" or grown == 1)
    return good, f"{told} spells told, {fault.counter} +{grown}"


def check_faults(log, shown_path, rate_hz, folder, within=5):
    shown = Shown(shown_path, rate_hz)
    results, reports = results_and_reports(log)
    bad, found = False, episodes(folder)
    for episode in found:
        if episode.verb in AROUND and episode.end_us is not None:
            for good, said in AROUND[episode.verb](episode, shown, results, reports, folder, float(within)):
                print(f"{'ok' if good else 'FAIL'}: {episode.name}: {said}")
                bad = bad or not good
            continue
        fault = episode.fault
        if fault is None or episode.end_us is None:
            print(f"FAIL: {episode.name}: {'is no fault' if fault is None else 'was not ended'}")
            bad = True
            continue
        told, how = check_told(episode, fault, shown, results, float(within))
        over, when, back = check_back(episode, shown, results)
        counted, count = check_counted(episode, fault, shown, results, reports, back["utime"] if back else episode.end_us)
        no_pose, poses = check_no_pose(episode, shown, results) if episode.verb in NO_POSE else (True, "")
        bad = bad or not (told and over and counted and no_pose)
        for good, said in ((told, how), (no_pose, poses), (over, when), (counted, count)):
            if said:
                print(f"{'ok' if good else 'FAIL'}: {episode.name}: {said}")
    if not found:
        print("no fault was injected")
    return bad or not found
