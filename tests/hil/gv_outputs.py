"""Whether what happened around the service (gigevision.sh: hold, route, bus, disk) was told in time, counted as injected,
and over when it was over. Each check gives pairs of good or not, and what was seen."""

import csv
import datetime
import glob
import math
import os
import re

from gv_record import COUNT_LAG_US, NO_PICTURES, growth

RETRY_FRAMES = 40  # an output that was gone is tried once a second
LOSSES = ("dropped_in_source", "dropped_ring_full", "dropped_superseded", "dropped_unpaired", "results_dropped")


def told_within(told_us, since_us, shown, within, what):
    if told_us is None:
        return False, f"{what} never told"
    frames = (told_us - since_us) / shown.period_us
    return frames <= within, f"{what} told after {frames:.1f} frames"


def first(reports, since_us, name, wanted):
    """When the field of VIS_HEALTH first was as wanted."""
    return next((r["utime"] for r in reports if r["utime"] >= since_us and wanted(r[name])), None)


def check_hold(episode, shown, results, reports, _folder, within):
    """The service stood still: nothing can be told meanwhile, but what comes next has to say so."""
    after = [r for r in results if r["publish_utime"] >= episode.end_us]
    reasons = ("deadline missed", "pairs dropped", NO_PICTURES)
    told = next((r for r in after if r["reason"] in reasons), None)
    yield told_within(told and told["publish_utime"], episode.end_us, shown, within, told["reason"] if told else "standstill")
    back = next((r for r in after if r["state"] == "TRACKING"), None)
    if back is None:
        yield False, "no TRACKING afterwards"
        return
    yield told_within(back["publish_utime"], episode.end_us, shown, RETRY_FRAMES, "TRACKING")
    until_us = back["utime"]
    inside = [r for r in results if episode.start_us - 4 * shown.period_us <= r["utime"] <= until_us]
    late, counted = sum(r["late"] for r in inside), growth(reports, "deadline_misses", episode.start_us, until_us)
    yield late == counted, f"{late} results later than declared, deadline_misses +{counted}"
    answered = {shown.tick(r["utime"]) for r in inside if r["reason"] != NO_PICTURES}
    both = shown.frames["left"].keys() & shown.frames["right"].keys()
    ticks = range(shown.tick(episode.start_us) - 3, shown.tick(until_us))
    lost = [t for t in ticks if t in both and t not in answered]
    dropped = sum(growth(reports, name, episode.start_us, until_us) for name in LOSSES)
    yield len(lost) <= dropped, f"{len(lost)} exposures without a result, counted as lost {dropped}"
    yield bool(late or lost), "something was late or lost"


def logged_us(folder, words, since_us):
    """When the service's log first had these words; its lines begin with the time of day."""
    day = datetime.datetime.fromtimestamp(since_us / 1e6)
    with open(os.path.join(folder, "service.log"), encoding="utf-8") as lines:
        for line in lines:
            time = re.match(r"(\d\d):(\d\d):(\d\d)\.(\d\d\d) ", line)
            if not time or words not in line:
                continue
            hour, minute, second, milli = map(int, time.groups())
            when_us = day.replace(hour=hour, minute=minute, second=second, microsecond=milli * 1000).timestamp() * 1e6
            if when_us >= since_us - 1000:
                return when_us
    return None


def check_route(episode, shown, results, reports, folder, within):
    """Over LCM nothing can be told of it: the journal does."""
    yield told_within(logged_us(folder, "LCM cannot be reached", episode.start_us), episode.start_us, shown, within, "in the journal")
    before = [r for r in results if r["publish_utime"] < episode.start_us][-1:]
    after = next((r for r in results if r["publish_utime"] > episode.end_us), None)
    if not before or after is None:
        yield False, "no result before or afterwards"
        return
    yield told_within(after["publish_utime"], episode.end_us, shown, within, "results")
    unheard = after["seq"] - before[0]["seq"] - 1
    counted = growth(reports, "lcm_errors", episode.start_us, after["utime"])
    # Two or three messages a result, and once a second a report and a picture.
    seconds = (episode.end_us - episode.start_us) / 1e6 + 1
    yield 2 * unheard <= counted <= 3 * unheard + 2 * seconds, f"{unheard} results unheard, lcm_errors +{counted}"


def check_bus(episode, shown, results, reports, _folder, within):
    told = first(reports, episode.start_us, "can_text", lambda text: " down" in text)
    yield told_within(told, episode.start_us, shown, within, "down")
    back = first(reports, episode.end_us, "can_text", lambda text: " down" not in text)
    yield told_within(back, episode.end_us, shown, RETRY_FRAMES, "up")
    lost = growth(reports, "can_sets_unheard", episode.start_us, back or episode.end_us)
    sent = growth(reports, "can_sets_sent", episode.start_us, back or episode.end_us)
    reported = [r["utime"] for r in reports]
    from_us = max((t for t in reported if t <= episode.start_us), default=math.nan)
    to_us = min((t for t in reported if t >= (back or episode.end_us) + COUNT_LAG_US), default=math.nan)
    published = sum(from_us < r["publish_utime"] <= to_us for r in results)
    down_frames = (episode.end_us - episode.start_us) / shown.period_us
    yield (abs(published - lost - sent) <= 1 and lost >= down_frames - 2,
           f"of {published} results {sent} went out as sets, can_sets_unheard +{lost}")


def check_disk(episode, shown, results, reports, folder, within):
    told = first(reports, episode.start_us, "recorder_text", lambda text: text.startswith("disk full"))
    yield told_within(told, episode.start_us, shown, within, "disk full")
    back = first(reports, episode.end_us, "recorder_text", lambda text: text.startswith("recording"))
    yield told_within(back, episode.end_us, shown, RETRY_FRAMES, "recording again")
    failed = growth(reports, "recorder_pairs_failed", episode.start_us, episode.end_us)
    yield failed == 1, f"recorder_pairs_failed +{failed}: the one that found the disk full"
    rows = 0
    for path in glob.glob(os.path.join(folder, "recordings", "*", "mav0", "cam0", "data.csv")):
        with open(path, encoding="ascii") as lines:
            rows += sum(bool(row) and not row[0].startswith("#") for row in csv.reader(lines))
    written = reports[-1]["recorder_pairs_written"]
    yield rows == written > 0, f"{rows} pairs in the recordings, recorder_pairs_written {written}"


CHECKS = {"hold": check_hold, "route": check_route, "bus": check_bus, "disk": check_disk}
