#!/usr/bin/env python3
"""Writes distributions.json beside itself: signals of sections and what another program makes of their distributions.

    python3 make_distributions.py LIBRARY.JSON CAMPAIGN

LIBRARY.JSON holds the metrics of each section and signal of the campaign folder CAMPAIGN (NumPy 2.4.6, SciPy 1.17.1). The signals
are the records through a low-pass (20 Hz as applied, order 4, forward and backward), the simulation interpolated at the distances
measured in the section.
"""
import csv
import json
import sys
from pathlib import Path

import numpy as np
from scipy import signal

KEPT = [("S07", "Y_1L"), ("S08", "Y_3R"), ("S06", "az_I")]
library, folder = json.loads(Path(sys.argv[1]).read_text()), Path(sys.argv[2])
columns = library["metrics"]["columns"]
rows = {(row[0], row[3]): dict(zip(columns, row)) for row in library["metrics"]["rows"]}
sections = {row["section"]: row for row in csv.DictReader(open(folder / "sections.csv"))}


def record(side, section, channel):
    with open(folder / side / f"{section}.csv") as file:
        table = list(csv.reader(file))
    data = np.array(table[1:], float)
    names = [name.split(" [")[0] for name in table[0]]
    time, x, y = (data[:, names.index(name)] for name in ("time", "distance", channel))
    rate = (len(time) - 1) / (time[-1] - time[0])
    edge = np.tan(np.pi * 20 / rate) / (np.sqrt(2) - 1) ** (1 / 8)
    sos = signal.butter(4, 2 / np.pi * np.arctan(edge), output="sos")
    return x, signal.sosfiltfilt(sos, y)


out = []
for section, channel in KEPT:
    (x, m), (xs, s) = record("measurement", section, channel), record("simulation", section, channel)
    inside = (float(sections[section]["start [m]"]) <= x) & (x <= float(sections[section]["end [m]"]))
    case = {"section": section, "signal": channel}
    case |= {key: value for key, value in rows[section, channel].items() if key.startswith("bogojevic") or key in ("samples", "area")}
    case |= {"simulated": [float(f"{v:.13g}") for v in np.interp(x[inside], xs, s)], "measured": [float(f"{v:.13g}") for v in m[inside]]}
    out.append(case)
Path(__file__).with_name("distributions.json").write_text(json.dumps(out, separators=(",", ":")).replace('{"section"', '\n{"section"') + "\n")
