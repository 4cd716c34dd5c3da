"""Ratings of ISO/TS 18571 of the same records, by objective-rating-metrics 1.3; run it after
independent.py, whose expected.csv it extends.

    pip install numpy scipy objective-rating-metrics==1.3
"""

import pathlib

import numpy as np
from objective_rating_metrics.rating import ISO18571

from independent import RATE, SECTIONS, cut, low, positions, record

HERE = pathlib.Path(__file__).parent
NAMES = {"Y": "rating", "Q": "Q_rating", "ay": "ay_rating"}
WEIGHTS = {"Y": 0.5, "Q": 0.3, "ay": 0.2}


def rating(m, s):
    t = np.arange(len(m)) / RATE
    return float(ISO18571(np.column_stack([t, m]), np.column_stack([t, s]), dt=1 / RATE).overall_rating(ndigits=-1))


rows, ratings = [], {name: [] for name in NAMES}
for section in range(SECTIONS):
    measured, simulated = ({n: np.array(v, float) for (n, _), v in record(section, side).items()} for side in (0, 1))
    for name, at in positions():
        m, s = (cut(low(side[f"{name}_{at}"], 20)) for side in (measured, simulated))
        ratings[name].append(rating(m, s))
        rows.append(f"iso18571-weighted-rating,S{section + 1},{NAMES[name]},{at},{ratings[name][-1]!r}")
lines = (HERE / "expected.csv").read_text().splitlines()
lines = [line for line in lines if not line.startswith("iso18571")]
(HERE / "expected.csv").write_text("\n".join(lines + rows) + "\n")
print("weighted", sum(WEIGHTS[name] * np.mean(of) for name, of in ratings.items()))
