"""Weighted estimates and numbers of several groups with NumPy and SciPy, of the values of quantity Q_max in assessment-values.csv.

Writes weights.json: a list of estimates, each with its name as in weights.fp, zone (or "all") and value in kN, m, or a plain number.
Weighted percentiles are those of Akinshin, "Weighted quantile estimators" (2024), type 7 with the effective sample size of Kish.
"""
import csv
import json
import os

import numpy as np
from scipy import stats

here = os.path.dirname(os.path.abspath(__file__))
sections = {row["section"]: row for row in csv.DictReader(open(os.path.join(here, "../../../examples/coach-good/sections.csv")))}
rows = [row for row in csv.DictReader(open(os.path.join(here, "assessment-values.csv"))) if row["quantity"] == "Q_max"]
length = {name: float(row["end [m]"]) - float(row["start [m]"]) for name, row in sections.items()}
speed = {name: float(row["speed [km/h]"]) for name, row in sections.items()}


def percentile(x, w, q):
    order = np.argsort(x)
    x, w = x[order], w[order]
    n = w.sum() ** 2 / (w**2).sum()
    t = np.concatenate([[0.0], np.cumsum(w)]) / w.sum()
    h = q * (n - 1) + 1
    f = np.clip(t * n - (h - 1), 0, 1)
    return np.diff(f) @ x


def upper_mean(x, w, site, confidence):
    mean = np.average(x, weights=w)
    sums = np.array([np.sum((w * (x - mean))[site == one]) for one in dict.fromkeys(site)])
    g = len(sums)
    return mean + stats.t.ppf(confidence, g - 1) * np.sqrt(g / (g - 1) * np.sum(sums**2)) / w.sum()


def draws(sites, count, seed):
    """SplitMix64."""
    state, mask = seed, 2**64 - 1
    out = np.empty((count, sites), int)
    for at in range(count * sites):
        state = (state + 0x9E3779B97F4A7C15) & mask
        z = state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & mask
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & mask
        z ^= z >> 31
        out[at // sites, at % sites] = int((z >> 11) / 2**53 * sites)
    return out


def by(keys, statistic, taken):
    groups = dict.fromkeys(tuple(row[key] for key in keys) for row in taken)
    return np.array([statistic([row for row in taken if tuple(row[key] for key in keys) == group]) for group in groups])


def values(taken):
    return np.array([float(row["value"]) for row in taken])


def weights(taken):
    return np.array([length[row["section"]] for row in taken])


mean = lambda taken: np.mean(values(taken))
maximum = lambda taken: np.mean(values(taken)) + 3 * np.std(values(taken), ddof=1)
weighted = lambda taken: np.average(values(taken), weights=weights(taken))
found = []
for zone in ("all", "1", "2", "3", "4"):
    taken = [row for row in rows if zone in ("all", row["zone"])]
    x, w = values(taken), weights(taken)
    both = w * np.array([speed[row["section"]] for row in taken])
    site = np.array([row["section"] for row in taken])
    names = list(dict.fromkeys(site))
    one = lambda name, value: found.append({"estimate": name, "zone": zone, "value": float(value)})
    one("mean weighted by length", np.average(x, weights=w))
    one("std weighted by (length * speed)", np.sqrt(np.cov(x, aweights=both)))
    one("rms weighted by length", np.sqrt(np.average(x**2, weights=w)))
    one("median weighted by length", percentile(x, w, 0.5))
    one("p80 weighted by length", percentile(x, w, 0.8))
    one("upper 95 % of mean weighted by length", upper_mean(x, w, site, 0.95))
    one("share weighted by length where value <= 60 kN", np.average(x <= 60.0, weights=w))
    one("mean of speed weighted by length", np.average([speed[name] / 3.6 for name in names], weights=[length[name] for name in names]))
    one("mean of (mean for each section)", np.mean(by(["section"], mean, taken)))
    one("std of (mean weighted by length for each wheelset)", np.std(by(["wheelset"], weighted, taken), ddof=1))
    one("maximum of (mean + 3 * std for each wheelset and zone)", np.max(by(["wheelset", "zone"], maximum, taken)))
    if zone == "all":
        of_zones = lambda taken: np.mean(by(["zone"], mean, taken))
        one("zone_mean", of_zones(rows))
        of_section = {name: [row for row in rows if row["section"] == name] for name in names}
        drawn = [of_zones(sum((of_section[names[at]] for at in draw), [])) for draw in draws(len(names), 2000, 14363)]
        one("upper 95 % of zone_mean", np.percentile(drawn, 95))
        drawn = [weighted(sum((of_section[names[at]] for at in draw), [])) for draw in draws(len(names), 2000, 14363)]
        one("upper 95 % of mean weighted by length by bootstrap", np.percentile(drawn, 95))
with open(os.path.join(here, "weights.json"), "w") as out:
    out.write("[\n" + ",\n".join(json.dumps(one) for one in found) + "\n]\n")
