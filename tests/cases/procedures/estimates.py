"""Estimates of the on-track assessments of `examples/coach-good`, with NumPy and SciPy.

values.csv: values of each section, group (wheelset or running gear) and quantity, by an independent program that reads the
records itself. Writes estimates.json: a list with record, method, quantity, zone, group and value; null where there are too
few values or regressors do not vary.
"""
import csv
import json
import os

import numpy as np
from scipy import stats

here = os.path.dirname(os.path.abspath(__file__))
sections = {row["section"]: row for row in csv.DictReader(open(os.path.join(here, "../../../examples/coach-good/sections.csv")))}
values = list(csv.DictReader(open(os.path.join(here, "values.csv"))))
TARGET = 1.1 * 130.0
SAFETY = ("SigmaY_max", "YQ_max", "SigmaY_instability", "ayb_rms")
QUASI_STATIC = ("Y_qst", "Q_qst", "B_qst", "ay_qst")


def column(name):
    return next(key for key in next(iter(sections.values())) if key.startswith(name))


I, SPEED, RADIUS, DIRECTION = column("cant deficiency"), column("speed"), column("radius"), column("direction")
CANT_DEFICIENCY = {name: float(row[I]) for name, row in sections.items()}
VELOCITY = {name: float(row[SPEED]) for name, row in sections.items()}
CURVING = {name: 0.0 if row[DIRECTION] == "straight" else 1.0 / float(row[RADIUS]) for name, row in sections.items()}


def fit(y, columns, at, confidence):
    """Fitted value, or the upper end of the two-sided prediction interval."""
    x = np.column_stack([np.ones(len(y))] + columns)
    scaled = x / np.linalg.norm(x, axis=0) if all(np.ptp(column) > 0 for column in columns) else np.zeros((1, 1))
    if len(y) <= x.shape[1] or np.linalg.svd(scaled, compute_uv=False)[-1] < 1e-10:
        return None
    beta, *_ = np.linalg.lstsq(x, y, rcond=None)
    x0 = np.array([1.0] + at)
    if confidence is None:
        return float(x0 @ beta)
    degrees = len(y) - x.shape[1]
    s = np.sqrt(np.sum((y - x @ beta) ** 2) / degrees)
    h = float(x0 @ np.linalg.pinv(x.T @ x) @ x0)
    return float(x0 @ beta) + stats.t.ppf(0.5 + confidence / 2, degrees) * s * np.sqrt(1 + h)


def of(record, quantity, group, zones):
    rows = [row for row in values if (row["record"], row["quantity"], row["group"]) == (record, quantity, group) and row["zone"] in zones]
    return np.array([float(row["value"]) for row in rows]), [row["section"] for row in rows]


def mean_of(data, zone):
    return float(np.mean([data[name] for name, row in sections.items() if row[column("zone")] == zone]))


found = []
for record in ("measured", "simulated"):
    for quantity in dict.fromkeys(row["quantity"] for row in values):
        k, confidence = (3.0, 0.99) if quantity in SAFETY else (0.0, None) if quantity in QUASI_STATIC else (2.2, 0.95)
        for group in sorted({row["group"] for row in values if row["quantity"] == quantity}):
            pooled, of_pooled = of(record, quantity, group, "234")
            columns = [np.array([data[name] for name in of_pooled]) for data in (VELOCITY, CANT_DEFICIENCY, CURVING)]
            for zone in "1234":
                y, names = of(record, quantity, group, zone)
                if len(y) == 0:
                    continue
                one = float(np.mean(y) + k * np.std(y, ddof=1))
                deficiency = np.array([CANT_DEFICIENCY[name] for name in names])
                two = one if zone == "1" else fit(y, [deficiency], [TARGET], confidence)
                target = [mean_of(VELOCITY, zone), TARGET, mean_of(CURVING, zone)]
                multiple = one if zone == "1" else fit(pooled, columns, target, confidence)
                for method, value in (("one-dimensional", one), ("two-dimensional", two), ("multiple", multiple)):
                    found.append({"record": record, "method": method, "quantity": quantity, "zone": zone, "group": group, "value": value})
with open(os.path.join(here, "estimates.json"), "w") as out:
    out.write("[\n" + ",\n".join(json.dumps(one) for one in found) + "\n]\n")
