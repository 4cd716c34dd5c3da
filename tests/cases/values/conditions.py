"""Conditions on samples and on single values in `conditions.fp`, of examples/coach, with NumPy.

Writes conditions.json: {quantity: {section: value}}, SI but for forces in kN; null where no sample satisfies the condition.
`mixed` holds [simulated, measured] of each section.
"""
import csv
import json
import os

import numpy as np

here = os.path.dirname(os.path.abspath(__file__))
coach = os.path.join(here, "../../../examples/coach")
LEVEL = 60.0


def record(side, section):
    path = os.path.join(coach, side, section + ".csv")
    names = [name.split("[")[0].strip() for name in open(path).readline().strip().split(",")]
    data = np.genfromtxt(path, delimiter=",", skip_header=1)
    return {name: data[:, at] for at, name in enumerate(names)}


def longest(axis, holds):
    best, start = 0.0, None
    for at, one in zip(axis, holds):
        start = (at if start is None else start) if one else None
        best = max(best, at - start) if start is not None else best
    return best


def rms(values):
    return float(np.sqrt(np.mean(values**2))) if len(values) else None


found = {}
for row in csv.DictReader(open(os.path.join(coach, "sections.csv"))):
    section, start, end = row["section"], float(row["start [m]"]), float(row["end [m]"])
    m, s = record("measurement", section), record("simulation", section)
    inside = (m["distance"] >= start) & (m["distance"] <= end)
    x, t, y, q, ay = (m[name][inside] for name in ("distance", "time", "Y_1R", "Q_1R", "ay_I"))
    both = np.interp(x, s["distance"], s["Y_1R"])
    own = (s["distance"] >= start) & (s["distance"] <= end)
    right = row["direction"] == "right"
    values = {
        "low_share": float(np.mean((q < 52) & (ay > 0))),
        "run": longest(x, q < LEVEL),
        "run_time": longest(t, q < LEVEL),
        "masked": float(np.mean(y[q > 58])) if (q > 58).any() else None,
        "chosen": rms(np.where(q > LEVEL, y, np.where((q > 50) & right, 0.0, -y / 2))),
        "raised": rms(np.where(y > 1, y, 1.0)),
        "outside": float(np.mean(np.abs(both - y) > 2)),
        "masked_both": rms((both - y)[y > 1]),
        "mixed": [float(np.percentile(s["Y_1R"][own], 99.85)), float(np.percentile(y, 99.85))],
    }
    for quantity, value in values.items():
        found.setdefault(quantity, {})[section] = value
json.dump(found, open(os.path.join(here, "conditions.json"), "w"), indent=1)
