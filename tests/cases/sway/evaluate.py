#!/usr/bin/env python3
"""Matching error on the hysteresis loops of examples/sway, in plain Python: writes expected.json beside itself.

The records are split where the cant turns. Each measured sample is compared with the simulation on the branch of the same
number, interpolated linearly over the cant; error = |simulated - measured|.
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
    parts = list(zip(branches(xs), branches(xm)))
    errors = []
    for number, ((i, j), (k, n)) in enumerate(parts):
        # The sample at a turn is counted once, on the branch that it begins.
        last = n + 1 if number == len(parts) - 1 else n
        for m in range(k, last):
            at = interpolate(xs[i : j + 1], simulated[signal][i : j + 1], xm[m])
            errors.append((abs(at - measured[signal][m]), number, xm[m]))
    worst = max(errors)
    return {"maximum": worst[0], "mean": sum(e for e, *_ in errors) / len(errors), "at_cant_mm": worst[2], "on_branch": worst[1] + 1,
            "samples": len(errors)}


if __name__ == "__main__":
    values = []
    for loop in ("loop-1", "loop-2"):
        simulated, measured = (read(CAMPAIGN / side / f"{loop}.csv") for side in ("simulation", "measurement"))
        for signal in ("primary roll angle", "secondary roll angle"):
            values.append({"record": loop, "signal": signal, **compare(simulated, measured, signal)})
    lines = ",\n".join("  " + json.dumps(value) for value in values)
    (HERE / "expected.json").write_text(f'{{\n "campaign": "sway",\n "unit": "mrad",\n "values": [\n{lines}\n ]\n}}\n')
