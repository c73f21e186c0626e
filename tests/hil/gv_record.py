"""What the software cameras took (gv_cameras SHOWN_CSV), and what the service said of it (log of lcm-logger)."""

import csv
import math

NO_PICTURES = "no pictures"
COUNT_LAG_US = 400_000  # between what happened and the report that counts it


def growth(reports, name, from_us, to_us):
    """Of a counter of VIS_HEALTH; not a number, which fails every comparison, without a report before and after."""
    before = [r for r in reports if r["utime"] <= from_us]
    after = [r for r in reports if r["utime"] >= to_us + COUNT_LAG_US]
    return after[0][name] - before[-1][name] if before and after else math.nan


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
