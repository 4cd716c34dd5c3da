#!/usr/bin/env python3
"""Matching error on the hysteresis loops of examples/sway, in plain Python: writes expected.json beside itself.

The records are split where the cant turns; the sample at a turn belongs to both branches. Each measured sample is compared
with the simulation on the branch of the same number, interpolated linearly over the cant: error = |simulated - measured|.
maximum: the largest error. mean: over the cant, not over time: the branches of one direction put together in the order of the cant,
the error integrated by trapezia; both directions together.
"""
import bisect
import csv
import json
from pathlib import Path

HERE = Path(__file__).parent
CAMPAIGN = HERE / "../../../examples/sway"


def read(path):
    with open(path, newline="") as f:
        rows = csv.reader(f)
        names = [head.split(" [")[0] for head in next(rows)]
        return dict(zip(names, zip(*(map(float, row) for row in rows))))


def branches(x):
    """Index ranges between turning points; a turning point belongs to both."""
    turns = [i for i in range(1, len(x) - 1) if (x[i] - x[i - 1]) * (x[i + 1] - x[i]) < 0]
    ends = [0, *turns, len(x) - 1]
    return list(zip(ends, ends[1:]))


def interpolate(x, y, at):
    if x[0] > x[-1]:
        x, y = x[::-1], y[::-1]
    i = min(max(bisect.bisect_right(x, at), 1), len(x) - 1)
    return y[i - 1] + (y[i] - y[i - 1]) * (at - x[i - 1]) / (x[i] - x[i - 1])


def compare(simulated, measured, signal):
    xs, xm = simulated["cant"], measured["cant"]
    errors = {True: [], False: []}
    for (i, j), (k, n) in zip(branches(xs), branches(xm), strict=True):
        for m in range(k, n + 1):
            at = interpolate(xs[i : j + 1], simulated[signal][i : j + 1], xm[m])
            errors[xm[n] > xm[k]].append((xm[m], abs(at - measured[signal][m])))
    area = length = 0.0
    for way in errors.values():
        way.sort()
        for (x, e), (x_next, e_next) in zip(way, way[1:]):
            area += 0.5 * (e + e_next) * (x_next - x)
            length += x_next - x
    worst = max((e, x, "rising" if rising else "falling") for rising, way in errors.items() for x, e in way)
    return {"maximum": worst[0], "mean": area / length, "at_cant_mm": worst[1], "while": worst[2]}


if __name__ == "__main__":
    values = []
    for loop in ("loop-1", "loop-2"):
        simulated, measured = (read(CAMPAIGN / side / f"{loop}.csv") for side in ("simulation", "measurement"))
        for signal in ("primary roll angle", "secondary roll angle"):
            values.append({"record": loop, "signal": signal, **compare(simulated, measured, signal)})
    lines = ",\n".join("  " + json.dumps(value) for value in values)
    (HERE / "expected.json").write_text(f'{{\n "campaign": "sway",\n "unit": "mrad",\n "values": [\n{lines}\n ]\n}}\n')
