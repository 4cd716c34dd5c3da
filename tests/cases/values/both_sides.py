"""Numbers of both sides' signals with NumPy, of the records of `examples/coach-good` as recorded.

Writes both_sides.json: a list of quantity, section, signal and value (of a difference: simulated and measured), in SI.
both_sides_filtered.json holds numbers of the low-pass filtered signals, made by an independent program.
"""
import csv
import json
import os

import numpy as np

here = os.path.dirname(os.path.abspath(__file__))
campaign = os.path.join(here, "../../../examples/coach-good")


def read(side, section):
    rows = list(csv.reader(open(os.path.join(campaign, side, section + ".csv"))))
    numbers = np.array(rows[1:], dtype=float)
    factor = {"kN": 1000.0}
    found = {}
    for at, name in enumerate(rows[0]):
        name, unit = name.rstrip("]").split(" [")
        found[name] = numbers[:, at] * factor.get(unit, 1.0)
    return found


def trapezoids(y, x):
    return np.concatenate([[0.0], np.cumsum(np.diff(x) * (y[1:] + y[:-1]) / 2)])


wheels = [f"Y_{wheelset}{side}" for wheelset in (1, 3) for side in "RL"]
out = []
for row in csv.DictReader(open(os.path.join(campaign, "sections.csv"))):
    section = row["section"]
    start, end = float(row["start [m]"]), float(row["end [m]"])
    records = {side: read(side, section) for side in ("simulation", "measurement")}
    cut = {side: (record["distance"] >= start) & (record["distance"] <= end) for side, record in records.items()}

    def both(quantity, signal, of):
        s, m = (float(of(records[side], cut[side])) for side in ("simulation", "measurement"))
        out.append({"quantity": quantity, "section": section, "signal": signal, "simulated": s, "measured": m, "value": s - m})

    rms = lambda x: np.sqrt(np.mean(x**2))
    for gear in ("I", "II"):
        ay = f"ay_{gear}"
        both("jerk_rms", f"jerk_{gear}", lambda r, c: rms(np.gradient(r[ay], r["time"])[c]))
        both("speed_gained", f"sway_speed_{gear}", lambda r, c: np.ptp(trapezoids(r[ay], r["time"])[c][[0, -1]]) * np.sign(
            trapezoids(r[ay], r["time"])[c][-1] - trapezoids(r[ay], r["time"])[c][0]))
    for wheel in wheels:
        place = wheel[2:]
        q = f"Q_{place}"
        both("slope_rms", f"Y_slope_{place}", lambda r, c: rms(np.gradient(r[wheel], r["distance"])[c]))
        both("area", f"Y_area_{place}", lambda r, c: trapezoids(r[wheel], r["distance"])[c][-1] - trapezoids(r[wheel], r["distance"])[c][0])
        both("moved", f"Y_moved_{place}", lambda r, c: np.mean(np.interp(r["distance"] - 2.0, r["distance"], r[wheel])[c]))
        both("largest_rms_2m", wheel, lambda r, c: max(
            rms(r[wheel][c][(r["distance"][c] >= a - 1e-6) & (r["distance"][c] < a + 2.0 - 1e-6)])
            for a in np.arange(start, end - 2.0 + 1e-9, 0.5)))
        for quantity in ("Y_over_Q", "Y_over_Q_named"):
            both(quantity, wheel, lambda r, c: np.cov(r[q][c], r[wheel][c])[0, 1] / np.var(r[q][c], ddof=1))
        s, m = records["simulation"], records["measurement"]
        x = m["distance"][cut["measurement"]]
        at = lambda shift: np.interp(x - shift, s["distance"], s[wheel])
        measured = m[wheel][cut["measurement"]]
        one = lambda quantity, value: out.append({"quantity": quantity, "section": section, "signal": wheel, "value": float(value)})
        one("mean_difference", np.mean(np.abs(at(0.0) - measured)))
        one("apart", rms(at(0.0) - measured))
        one("difference_moved", rms(at(2.0) - measured))
        one("difference_about_mean", np.std(at(0.0) - measured))
        both("about_mean", f"Y_about_mean_{place}", lambda r, c: rms(r[wheel][c] - np.mean(r[wheel][c])))
        one("difference_of_slopes", np.percentile(np.abs(np.gradient(at(0.0), x) - np.gradient(measured, x)), 90))
with open(os.path.join(here, "both_sides.json"), "w") as file:
    file.write("[\n" + ",\n".join(json.dumps(one) for one in out) + "\n]\n")
