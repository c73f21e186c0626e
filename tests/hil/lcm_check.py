#!/usr/bin/env python3
"""What a listener on LCM saw of pelorusd, from the log of lcm-logger, as a table.

usage: lcm_check.py LOG [--least-results N] [--max-lost SHARE]
Exit code 1 when fewer results came, or a larger share of the pairs was lost, after the first result that tracks.
"""

import argparse
import math
import sys

from lcm_log import ODOM, STATES, events, health

def percentiles(values):
    values = sorted(values)
    at = lambda share: values[max(0, math.ceil(share * len(values) - 1e-9) - 1)]  # nearest rank
    return {"p50": at(0.5), "p99": at(0.99), "p99.9": at(0.999), "max": values[-1], "jitter": values[-1] - values[0]}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("log")
    parser.add_argument("--least-results", type=int, default=1)
    parser.add_argument("--max-lost", type=float, default=0.0)
    arguments = parser.parse_args()
    results, counters = [], {}
    for received_us, channel, data in events(arguments.log):
        if channel.endswith(".VIS_ODOM"):
            results.append((received_us, *ODOM.unpack_from(data)[1:]))
        elif channel.endswith(".VIS_HEALTH"):
            counters = health(data)
    spells = []
    for result in results:
        state = STATES[result[6]]
        if not spells or spells[-1][0] != state:
            spells.append([state, 0])
        spells[-1][1] += 1
    print("states:", " ".join(f"{state}x{count}" for state, count in spells))
    first = next((i for i, result in enumerate(results) if STATES[result[6]] == "TRACKING"), len(results))
    settled = results[first:]
    if len(settled) < arguments.least_results or not settled:
        print(f"only {len(settled)} results from the first that tracks, {arguments.least_results} asked for")
        return 1
    span = settled[-1][5] - settled[0][5] + 1
    lost = span - len({result[5] for result in settled})
    print(f"pairs {span}, results {len(settled)}, pairs without result {lost}, "
          f"deadlines missed {sum(result[4] for result in settled)}")
    for name, values in (("capture to LCM listener", [(r[0] - r[1]) / 1000 for r in settled]),
                         ("capture to publication", [(r[2] - r[1]) / 1000 for r in settled])):
        print(f"{name} [ms]: " + " ".join(f"{k} {v:.2f}" for k, v in percentiles(values).items()))
    print("counters:", " ".join(f"{name}={value:g}" for name, value in counters.items() if value and isinstance(value, (int, float)) and name != "utime"))
    print("granted:", counters.get("privileges_text", "no VIS_HEALTH"))
    return 1 if lost > arguments.max_lost * span else 0


if __name__ == "__main__":
    sys.exit(main())
