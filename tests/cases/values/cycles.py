"""Numbers of cycles in `cycles.fp`, of examples/coach, by another way of counting: the four-point method, in which an inner
range that both its neighbours cover is a cycle, and the ranges that are left are half cycles.

Writes cycles.json: {quantity: {section: value}}.
"""
import csv
import json
import os

import numpy as np

from conditions import coach, here, record


def half_cycles(values):
    values = values[np.append(True, np.diff(values) != 0)]
    turns = np.sign(np.diff(values))
    points = list(values[np.concatenate([[True], turns[1:] != turns[:-1], [True]])])
    found, at = [], 0
    while at + 3 < len(points):
        a, b, c = np.abs(np.diff(points[at : at + 4]))
        if b <= a and b <= c:
            found += [b, b]
            del points[at + 1 : at + 3]
            at = max(at - 2, 0)
        else:
            at += 1
    return np.array(found + list(np.abs(np.diff(points))))


found = {}
for row in csv.DictReader(open(os.path.join(coach, "sections.csv"))):
    section, start, end = row["section"], float(row["start [m]"]), float(row["end [m]"])
    m, s = record("measurement", section), record("simulation", section)
    inside = (m["distance"] >= start) & (m["distance"] <= end)
    ranges = half_cycles(m["Q_1R"][inside])
    both = half_cycles(np.interp(m["distance"][inside], s["distance"], s["Q_1R"]))
    values = {
        "number": np.sum(ranges > 4) / 2,
        "damage": np.sum(ranges**5) / 2,
        "large": np.percentile(ranges, 95) + max(ranges),
        "both": np.sum(both**5) / np.sum(ranges**5),
    }
    for quantity, value in values.items():
        found.setdefault(quantity, {})[section] = float(value)
json.dump(found, open(os.path.join(here, "cycles.json"), "w"), indent=1)
