#!/usr/bin/env python3
"""Writes the records of this campaign: `python3 generate.py` in this folder. The model is described in README.md."""
import csv
import math
import random

BASE = 1500.0  # mm between the contact points, over which cant is measured

# Roll angle = (stuck * cant angle) + sum of share * play(cant angle, half width); widths and offsets in mrad.
SIMULATION = {
    "primary": {"stuck": 0.032, "friction": [(0.008, 4.0), (0.005, 12.0)], "offset": 0.0, "noise": 0.0},
    "secondary": {"stuck": 0.070, "friction": [(0.010, 6.0), (0.005, 15.0)], "offset": 0.0, "noise": 0.0},
}
MEASUREMENT = {
    "primary": {"stuck": 0.033, "friction": [(0.010, 6.0), (0.006, 16.0)], "offset": 0.03, "noise": 0.02},
    "secondary": {"stuck": 0.063, "friction": [(0.012, 9.0), (0.006, 20.0)], "offset": -0.05, "noise": 0.03},
}


def ramps(turns, speed, rate):
    """Cant in mm, sampled `rate` times a second, through the turning points at `speed` mm/s."""
    step, cant = speed / rate, [turns[0]]
    for start, end in zip(turns, turns[1:]):
        n = math.ceil(abs(end - start) / step)
        cant += [start + (end - start) * k / n for k in range(1, n + 1)]
    return [round(c, 2) + 0.0 for c in cant]  # + 0.0: no "-0.00" in the file


def play(inputs, half_width):
    """The end of a free link with backlash: follows once the backlash is used up. Starts centred."""
    out, p = [], 0.0
    for u in inputs:
        p = max(u - half_width, min(u + half_width, p))
        out.append(p)
    return out


def roll(cant, stage, noise):
    angle = [1e3 * math.asin(c / BASE) for c in cant]
    links = [(share, play(angle, width)) for share, width in stage["friction"]]
    return [stage["stuck"] * a + sum(share * p[i] for share, p in links) + stage["offset"] + noise.gauss(0.0, stage["noise"])
            for i, a in enumerate(angle)]


def write(path, vehicle, cant, rate, seed):
    noise = random.Random(seed)
    primary, secondary = (roll(cant, vehicle[stage], noise) for stage in ("primary", "secondary"))
    with open(path, "w", newline="") as f:
        w = csv.writer(f, lineterminator="\n")
        w.writerow(["time [s]", "cant [mm]", "primary roll angle [mrad]", "secondary roll angle [mrad]"])
        for i, row in enumerate(zip(cant, primary, secondary)):
            w.writerow([f"{i / rate:.1f}", f"{row[0]:.2f}", *(f"{round(angle, 4) + 0.0:.4f}" for angle in row[1:])])


if __name__ == "__main__":
    for name, side, seed in (("loop-1", 1, 1), ("loop-2", -1, 2)):
        # The jacks stop a little short of the nominal cant, and the track they start from is not quite level.
        measured = [0.25, 149.60, -149.30, -0.40]
        write(f"simulation/{name}.csv", SIMULATION, ramps([side * c for c in (0.0, 150.0, -150.0, 0.0)], 1.0, 1), 1, seed)
        write(f"measurement/{name}.csv", MEASUREMENT, ramps([side * c for c in measured], 0.9, 2), 2, seed)
