"""Writes the records from which `fishplate new` made this campaign. Call: prepare.py FOLDER OUT

FOLDER has the upstream records 20230629-143339.csv and 20230629-154220.csv. Each is resampled linearly to 250 Hz,
nothing is filtered. The simulated records are those of simulator.py with the parameters of vehicle.yaml.
"""

import csv
import pathlib
import re
import sys

import simulator

source, out, here = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), pathlib.Path(__file__).parent
RECORDS = ["20230629-143339", "20230629-154220"]
STEP = 0.004


def resampled(times, values, count):
    at, new = 0, []
    for n in range(count):
        while at + 2 < len(times) and times[at + 1] < n * STEP:
            at += 1
        share = (n * STEP - times[at]) / (times[at + 1] - times[at])
        new.append(values[at] + share * (values[at + 1] - values[at]))
    return new


def written(path, names, columns):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(names)
        writer.writerows([f"{row[0]:.3f}"] + [f"{value:.5f}" for value in row[1:]] for row in zip(*columns))


text = (here / "vehicle.yaml").read_text()
parameters = {name: float(re.search(rf"^{name}: *([-\d.e]+)", text, re.MULTILINE)[1]) for name in simulator.PARAMETERS}
out.mkdir(parents=True, exist_ok=True)
for number, record in enumerate(RECORDS, 1):
    with open(source / f"{record}.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    times = [float(row["time"]) for row in rows]
    time = [n * STEP for n in range(int(times[-1] / STEP) + 1)]
    column = lambda name: resampled(times, [float(row[name]) for row in rows], len(time))
    inputs = {"time": time, "section": {"section": record}}
    inputs |= {f"position_{n}": column(f"pos_meas{n}") for n in (1, 2)}
    torques = simulator.simulate(parameters, inputs)
    names = ["time [s]", "torque_1 [N m]", "torque_2 [N m]"]
    written(out / f"simulated{number}.csv", names, [time, torques["torque_1"], torques["torque_2"]])
    measured = [column(f"tau_meas{n}") for n in (1, 2)]
    names += ["position_1 [rad]", "position_2 [rad]"]
    written(out / f"measured{number}.csv", names, [time, *measured, inputs["position_1"], inputs["position_2"]])
