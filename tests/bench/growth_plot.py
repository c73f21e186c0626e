#!/usr/bin/env python3
"""How a step's cost grows with points, bodies and picture size: out/bench/step_bench.csv -> a picture (docs/growth.png).

Usage: growth_plot.py CSV PNG   (Debian: python3-matplotlib)"""

import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend is chosen before)

STAGES = ["front_end", "partition", "ego_motion", "static_filters", "static_window", "objects", "refill"]
COLORS = ["#2a6f97", "#e07a1f", "#7b2cbf", "#588157", "#bc4749", "#00a3b4", "#8d99ae"]
PANELS = [("points", "points"), ("bodies", "bodies (600 points)"), ("size", "megapixels of a picture (600 points)")]


def rows_of(path):
    """The rows below Google Benchmark's preamble, by the name's parts: step/points/200/iterations:150."""
    with open(path, newline="") as file:
        lines = file.readlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("name,"))
    return [(row["name"].split("/"), row) for row in csv.DictReader(lines[start:])]


def abscissa(kind, parts):
    return float(parts[2]) * float(parts[3]) / 1e6 if kind == "size" else float(parts[2])


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    rows = rows_of(sys.argv[1])
    figure, axes = plt.subplots(1, 3, figsize=(11, 3.6), sharey=True)
    for axis, (kind, label) in zip(axes, PANELS):
        found = [(abscissa(kind, parts), row) for parts, row in rows if parts[:2] == ["step", kind]]
        if not found:
            sys.exit(f"{sys.argv[1]}: no rows step/{kind}: run ./run bench --benchmark_filter=step/")
        x = [place for place, _ in found]
        axis.stackplot(x, [[float(row[stage]) for _, row in found] for stage in STAGES], colors=COLORS, labels=STAGES,
                       alpha=0.85)
        axis.plot(x, [float(row["p50_ms"]) for _, row in found], "k-o", ms=3, lw=1.2, label="step, median")
        axis.plot(x, [float(row["p99_ms"]) for _, row in found], "k--o", ms=3, lw=1, label="step, p99")
        axis.set_xlabel(label)
        axis.set_xlim(min(x), max(x))
        axis.set_ylim(bottom=0)
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("ms, one thread")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.tight_layout(rect=(0, 0, 0.87, 1))
    figure.legend(handles[::-1], labels[::-1], loc="center right", fontsize=8, frameon=False)
    figure.savefig(sys.argv[2], dpi=80)


if __name__ == "__main__":
    main()
