"""What the software cameras took (gv_cameras SHOWN_CSV), and what the service said of it (log of lcm-logger)."""

import csv

NO_PICTURES = "no pictures"


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
