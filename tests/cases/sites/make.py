#!/usr/bin/env python3
"""Writes intervals.json beside itself: confidence intervals of differences that are independent between sites only.

    python3 make.py RESULTS.JSON SECTIONS.CSV        (NumPy 2.4.6, SciPy 1.17.1)

RESULTS.JSON is of a campaign of eight sections, four of them measured again (column `repeat of`).
"""
import csv
import json
import sys
from pathlib import Path

import numpy as np
from scipy import stats

results = json.loads(Path(sys.argv[1]).read_text())
again = {row["section"]: row["repeat of"] for row in csv.DictReader(open(sys.argv[2]))}
out = []
for quantity in results["quantities"]:
    difference = np.array([value["difference"] for value in quantity["values"]])
    names = [again[value["section"]] or value["section"] for value in quantity["values"]]
    order = list(dict.fromkeys(names))
    site = np.array([order.index(name) for name in names])
    sites, n = len(order), len(difference)
    mean, std = difference.mean(), difference.std(ddof=1)
    sums = np.array([(difference[site == j] - mean).sum() for j in range(sites)])
    reach = stats.t.ppf(0.975, sites - 1) * np.sqrt(sites / (sites - 1) * (sums**2).sum()) / n
    low, high = std * np.sqrt((sites - 1) / stats.chi2.ppf([0.975, 0.025], sites - 1))
    out.append({"quantity": quantity["id"], "site": site.tolist(), "difference": difference.tolist(),
                "mean_interval": [mean - reach, mean + reach], "std_interval": [low, high]})
Path(__file__).with_name("intervals.json").write_text(json.dumps(out).replace("{", "\n{") + "\n")
