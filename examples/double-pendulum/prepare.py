"""Cuts records of the double pendulum into sections. Call: prepare.py FOLDER, which has the upstream records as A0_sysid/trajectory_NN.csv.

Every record is resampled linearly to 250 Hz, nothing is filtered.
"""

import csv
import pathlib
import sys

import numpy as np

source, here = pathlib.Path(sys.argv[1]), pathlib.Path(__file__).parent
RECORDS = ["A0_sysid/trajectory_00", "A0_sysid/trajectory_01", "A0_sysid/trajectory_12"]
STEP, MARGIN, LENGTH = 0.004, 0.4, 1.8


def written(path, names, columns):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(names)
        writer.writerows([f"{row[0]:.3f}"] + [f"{value:.5f}" for value in row[1:]] for row in zip(*columns))


rows = []
for letter, record in zip("ABC", RECORDS):
    with open(source / f"{record}.csv") as file:
        names = [name.strip() for name in next(file).split(",")]
        data = dict(zip(names, np.loadtxt(file, delimiter=",").T))
    time = np.arange(0, int(data["time"][-1] / STEP) + 1) * STEP
    column = lambda name: np.interp(time, data["time"], data[name])
    position = [column(f"pos_meas{n}") for n in (1, 2)]
    torque = [column(f"tau_meas{n}") for n in (1, 2)]
    for part in range(5):
        start, name = MARGIN + part * LENGTH, f"{letter}{part + 1}"
        inside = slice(int(round((start - MARGIN) / STEP)), int(round((start + LENGTH + MARGIN) / STEP)) + 1)
        written(here / f"measurement/{name}.csv", ["time [s]", "tau_1 [N m]", "tau_2 [N m]"], [x[inside] for x in [time, *torque]])
        written(here / f"kinematics/{name}.csv", ["time [s]", "position_1 [rad]", "position_2 [rad]"], [x[inside] for x in [time, *position]])
        rows.append([name, letter, f"{start:.2f}", f"{start + LENGTH - STEP:.3f}"])
with open(here / "sections.csv", "w", newline="") as file:
    writer = csv.writer(file, lineterminator="\n")
    writer.writerows([["section", "record", "start [s]", "end [s]"], *rows])
