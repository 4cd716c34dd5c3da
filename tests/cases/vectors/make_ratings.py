#!/usr/bin/env python3
"""Writes ratings.json beside itself: ratings of ISO/TS 18571 by the package objective-rating-metrics 1.3, and of CORA.

    pip install objective-rating-metrics==1.3
    python3 make_ratings.py

Signals: 1200 samples of each pair of this folder from the start of its section; and sums of sines, some shifted, scaled, offset.
The package rounds nothing here (ndigits=-1). Its shift depends on rounding where two shifts correlate equally: no such case is taken.
CORA has no published package: its numbers are of the code below, which was written apart from the program.
"""
import csv
import json
from pathlib import Path

import numpy as np
from objective_rating_metrics.rating import ISO18571

here = Path(__file__).parent
COUNT = 1200


def iso(s, m):
    t = np.arange(len(m)) / 200
    rating = ISO18571(np.column_stack([t, m]), np.column_stack([t, s]), dt=1 / 200)
    parts = ("corridor", "phase", "magnitude", "slope", "overall")
    return {part: float(getattr(rating, part + "_rating")(ndigits=-1)) for part in parts} | {"shift": int(rating._n_eps)}


def cora(s, m):
    n, best = len(m), None
    for k in range(int(np.floor(0.2 * n)) + 1):
        for a, b in [(s[k:], m[: n - k]), (s[: n - k], m[k:])]:
            cosine = np.sum(a * b) / np.sqrt(np.sum(a * a) * np.sum(b * b))
            if best is None or cosine > best[0] + 1e-12:
                best = (cosine, k, np.sum(a * a), np.sum(b * b))
    cosine, k, of_s, of_m = best
    outer, inner = 0.5 * np.max(np.abs(m)), 0.05 * np.max(np.abs(m))
    corridor = np.mean(np.clip((outer - np.abs(s - m)) / (outer - inner), 0, 1) ** 2)
    progression, size = ((cosine + 1) / 2) ** 10, min(of_s, of_m) / max(of_s, of_m)
    phase = float(np.clip((0.12 - k / (n - 1)) / (0.12 - 0.01), 0, 1))
    total = 0.5 * corridor + 0.5 * (0.5 * progression + 0.25 * size + 0.25 * phase)
    return {"corridor": corridor, "progression": progression, "size": size, "phase": phase, "total": total}


def wave(late, count=700):
    x = np.arange(count) - late
    return np.sin(2 * np.pi * x / 190) + 0.4 * np.cos(2 * np.pi * x / 47) + 0.15 * np.sin(2 * np.pi * x / 13)


found = []
for name in ("pair_Y_offset_200Hz", "pair_Q_gain_500Hz", "pair_ay_shift_400Hz", "pair_az_noise_1000Hz"):
    pair = json.loads((here / "expected.json").read_text())["pairs"][name]
    data = np.array(list(csv.reader(open(here / f"{name}.csv")))[1:], float)
    inside = (pair["start"] <= data[:, 1]) & (data[:, 1] <= pair["end"])
    m, s = data[inside][:COUNT, 2], data[inside][:COUNT, 3]
    found.append({"pair": name, "iso": iso(s, m), "cora": cora(s, m)})
for late, gain, offset in [(0, 1, 0), (0, 1.3, 0), (0, 1, 0.5), (9, 1, 0), (-31, 0.8, 0.1), (60, 1, -0.2)]:
    s, m = gain * wave(late) + offset, wave(0)
    found.append({"late": late, "gain": gain, "offset": offset, "iso": iso(s, m), "cora": cora(s, m)})
(here / "ratings.json").write_text(json.dumps(found, indent=1) + "\n")
