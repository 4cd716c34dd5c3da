"""Estimates of an on-track assessment from values of sections, with NumPy and SciPy.

assessment-values.csv: values of each section, wheelset and quantity of `examples/coach-good`, by an independent program
that reads the records itself. Columns: section, zone, quantity, wheelset, value [kN, or a plain number].
Writes assessment.json: a list of estimates, each with quantity, estimate, zone, wheelset and value (null where there is none).
"""
import csv
import json
import os

import numpy as np
from scipy import stats

here = os.path.dirname(os.path.abspath(__file__))
sections = {row["section"]: row for row in csv.DictReader(open(os.path.join(here, "../../../examples/coach-good/sections.csv")))}
values = list(csv.DictReader(open(os.path.join(here, "assessment-values.csv"))))
TARGET = 1.1 * 130.0


def column(name):
    return next(key for key in next(iter(sections.values())) if key.startswith(name))


I, SPEED, RADIUS, DIRECTION = column("cant deficiency"), column("speed"), column("radius"), column("direction")


def curving(section):
    return 0.0 if section[DIRECTION] == "straight" else 1.0 / float(section[RADIUS])


def fit(y, columns, at, confidence):
    """Fitted value, or the upper end of the two-sided prediction interval, by the normal equations of centred columns."""
    x = np.column_stack([np.ones(len(y))] + columns)
    if any(np.ptp(column) == 0 for column in columns):
        return None
    scaled = x / np.linalg.norm(x, axis=0)
    if len(y) < x.shape[1] + (confidence is not None) or np.linalg.svd(scaled, compute_uv=False)[-1] < 1e-10:
        return None
    beta, *_ = np.linalg.lstsq(x, y, rcond=None)
    x0 = np.array([1.0] + at)
    found = float(x0 @ beta)
    if confidence is None:
        return found
    degrees = len(y) - x.shape[1]
    s = np.sqrt(np.sum((y - x @ beta) ** 2) / degrees)
    h = float(x0 @ np.linalg.pinv(x.T @ x) @ x0)
    return found + stats.t.ppf(0.5 + confidence / 2, degrees) * s * np.sqrt(1 + h)


def estimates(quantity, rows):
    y = np.array([float(row["value"]) for row in rows])
    i = np.array([float(sections[row["section"]][I]) for row in rows])
    v = np.array([float(sections[row["section"]][SPEED]) for row in rows])
    r = np.array([curving(sections[row["section"]]) for row in rows])
    names = sorted({row["section"] for row in rows})
    v0 = float(np.mean([float(sections[name][SPEED]) for name in names]))
    r0 = float(np.mean([curving(sections[name]) for name in names]))
    one = lambda k: float(np.mean(y) + k * np.std(y, ddof=1)) if len(y) > 1 else None
    if quantity in ("SigmaY_max", "YQ_max"):
        yield "safety", one(3.0)
        yield "safety_2d", fit(y, [i], [TARGET], 0.99)
        if quantity == "SigmaY_max":
            yield "safety_multiple", fit(y, [v, i, r], [v0, TARGET, r0], 0.99)
    elif quantity == "Q_max":
        yield "loading", one(2.2)
        yield "loading_2d", fit(y, [i], [TARGET], 0.95)
    else:
        yield "mean", float(np.mean(y))
        if quantity == "Y_qst":
            yield "quasi_static_2d", fit(y, [i], [TARGET], None)


found = []
for quantity in dict.fromkeys(row["quantity"] for row in values):
    for zone in "1234":
        for wheelset in "1234":
            rows = [row for row in values if (row["quantity"], row["zone"], row["wheelset"]) == (quantity, zone, wheelset)]
            for name, value in estimates(quantity, rows) if rows else []:
                found.append({"quantity": quantity, "estimate": name, "zone": zone, "wheelset": wheelset, "value": value})
with open(os.path.join(here, "assessment.json"), "w") as out:
    json.dump(found, out, indent=0)
    out.write("\n")
