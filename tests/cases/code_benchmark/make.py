"""Deviations of examples/code-benchmark from the reference, with SciPy 1.17.1 and NumPy 2.4.6: the numbers in tests/campaigns/records.rs."""
import csv
import pathlib

import numpy as np
from scipy.signal import butter, sosfiltfilt

EXAMPLE = pathlib.Path(__file__).resolve().parents[3] / "examples" / "code-benchmark"
RATE, CUT, ORDER = 200.0, 20.0, 4


def record(folder, section):
    with open(EXAMPLE / folder / f"{section}.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    return {key.split(" ")[0]: np.array([float(row[key]) for row in rows]) for key in rows[0]}


# -3 dB of forward and backward together at 20 Hz, on the prewarped axis.
warped = np.tan(np.pi * CUT / RATE) / (np.sqrt(2) - 1) ** (1 / (2 * ORDER))
SOS = butter(ORDER, np.arctan(warped) / np.pi * 2, output="sos")

with open(EXAMPLE / "sections.csv", newline="") as file:
    SECTIONS = list(csv.DictReader(file))
for row in SECTIONS:
    start, end = float(row["start [m]"]), float(row["end [m]"])
    for code in ["independent", "built_in", "midpoint", "polach"]:
        one, reference = record(f"codes/{code}", row["section"]), record("reference", row["section"])
        inside = (one["distance"] >= start) & (one["distance"] <= end)
        smooth = {name: [sosfiltfilt(SOS, side[name])[inside] for side in (one, reference)] for name in ["Y_1L", "Q_1L"]}
        for name, (a, b) in smooth.items():
            print(row["section"], code, name, "median", repr(float(np.median(a) - np.median(b))), "rms", repr(float(np.sqrt(np.mean((a - b) ** 2)))))
