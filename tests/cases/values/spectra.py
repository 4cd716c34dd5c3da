"""Numbers of spectra in `spectra.fp`, of examples/coach, with `scipy.signal.welch`.

Writes spectra.json: {quantity: {section: value}}, SI. Lines above 0 Hz only; the band with a slack of a hundredth of the
distance of the lines.
"""
import csv
import json
import os

import numpy as np
from scipy.signal import welch

from conditions import coach, here, longest, record


def density(values, rate, segment, overlap=0.5, band=(0.0, np.inf)):
    length = round(segment * rate)
    lines, found = welch(values, rate, nperseg=length, noverlap=int(overlap * length + 1e-9))
    slack = 0.01 * rate / length
    inside = (lines > 0) & (lines >= band[0] - slack) & (lines <= band[1] + slack)
    return lines[inside], found[inside]


found = {}
for row in csv.DictReader(open(os.path.join(coach, "sections.csv"))):
    section, start, end = row["section"], float(row["start [m]"]), float(row["end [m]"])
    m, s = record("measurement", section), record("simulation", section)
    inside = (m["distance"] >= start) & (m["distance"] <= end)
    rate = (len(m["time"]) - 1) / (m["time"][-1] - m["time"][0])
    y = m["ay_I"][inside]
    both = np.interp(m["distance"][inside], s["distance"], s["ay_I"])
    lines, named = density(y, rate, 2, band=(1, 40))
    f, most = density(y, rate, 1.5, 0.75)
    all_lines, whole = density(y, rate, 2)
    level = 10 * np.log10(density(both, rate, 2, band=(1, 10))[1] / density(y, rate, 2, band=(1, 10))[1])
    ratio = density(both, rate, 2)[1] / whole
    values = {
        "largest": max(named),
        "band": np.mean(most[(f > 2) & (f <= 8)]),
        "margin": min(10 * np.log10(np.interp(all_lines, [0, 2, 10], [0.2, 0.05, 0.002]) / whole)),
        "wide": longest(lines, named > 0.3 * np.mean(named)),
        "level": max(abs(level)),
        "within": np.mean((ratio <= 2) & (ratio >= 0.5) & (all_lines > 3.2)),
    }
    for quantity, value in values.items():
        found.setdefault(quantity, {})[section] = float(value)
json.dump(found, open(os.path.join(here, "spectra.json"), "w"), indent=1)
