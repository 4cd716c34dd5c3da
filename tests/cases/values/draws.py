"""The verdicts of `draws.fp` on examples/coach-good, from the values of the sections, with NumPy.

    python draws.py VALUES.csv

VALUES.csv is `tables/values.csv` of a certification with that protocol: the table of the single values,
of which nothing but section, zone and difference is read. Prints, for each verdict, the number of the
2000 draws in which its rule holds, and how often each limit is not met.
"""
import csv
import os
import sys
from collections import Counter

import numpy as np

MASK = (1 << 64) - 1


def split_mix(state):
    """SplitMix64 (Steele, Lea and Flood, 2014): numbers from 0 to 1 from the upper 53 bits."""
    while True:
        state = (state + 0x9E3779B97F4A7C15) & MASK
        z = state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
        yield ((z ^ (z >> 31)) >> 11) / float(1 << 53)


folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../examples/coach-good")
table = csv.DictReader(open(os.path.join(folder, "sections.csv")))
radius = {row["section"]: row["radius [m]"] for row in table}
values, zones = {}, {}
for row in csv.DictReader(open(sys.argv[1])):
    zones.setdefault(row["zone"], [])
    if row["section"] not in zones[row["zone"]]:
        zones[row["zone"]].append(row["section"])
    values.setdefault((row["quantity"], row["section"]), []).append(float(row["difference"]))

of_zones = list(zones.items())
random = split_mix(14363)
held, failed = Counter(), Counter()
for _ in range(2000):
    drawn = [[sections[int(next(random) * len(sections))] for _ in sections] for _, sections in of_zones]
    everything = [section for sections in drawn for section in sections]

    def of(quantity, sections=everything):
        return np.concatenate([values[quantity, section] for section in sections])

    limits = {
        "Y_qst std": of("Y_qst").std(ddof=1) <= 1.3,
        "Y_qst share": np.mean(np.abs(of("Y_qst")) <= 2.0) >= 0.85,
        "Y_max std": of("Y_max").std(ddof=1) <= 3.5,
        "Y_max each": np.abs(of("Y_max")).max() <= 12.0,
        # Units that are drawn twice are two units.
        "Q_qst n": len(everything) <= 13,
    }
    for (zone, _), sections in zip(of_zones, drawn):
        limits["Y_max mean " + zone] = abs(of("Y_max", sections).mean()) <= 4.0
    failed.update(name for name, holds in limits.items() if not holds)
    # A limit for each zone counts once for each of them.
    counted = [holds for name, holds in limits.items() if name.startswith("Y_")]
    quantities = [all(h for n, h in limits.items() if n.startswith(q)) for q in ("Y_qst", "Y_max", "Q_qst")]
    # A line through sections of one curve radius has no slope.
    held["line in zone 2"] += len({radius[section] for section in drawn[1]}) > 1
    held["every limit"] += all(limits.values())
    held["five limits"] += sum(counted) >= 5
    held["two quantities"] += sum(quantities) >= 2
print(dict(held), failed.most_common())
