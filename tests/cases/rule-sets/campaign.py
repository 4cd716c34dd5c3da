"""The campaign of tests/evaluation/rule_sets/campaign.rs: records of whole numbers, so that both programs
make the same ones."""

import pathlib
import sys

import numpy as np

sys.path.append(str(pathlib.Path(__file__).parents[1] / "shipped-rule-sets"))
import independent as filters  # noqa: E402

RATE, ROWS = 200, 2501  # samples/s, samples
FIRST = 200  # the first measured sample of a section
LATE = 30  # mm between a measured sample and the simulated one
WHEELS = [f"{w}{s}" for w in "1234" for s in "RL"]
GEARS = "I", "II"

# Name, last measured sample, zone, radius in m, direction, speed in km/h, conicity in 1/1000, country, line, site.
SECTIONS = [
    ("S01", 2300, 1, None, "straight", 144, 40, "IT", "main", "A"),
    ("S02", 2300, 1, None, "straight", 180, 120, "IT", "main", ""),
    ("S03", 2300, 1, None, "straight", 144, 300, "FR", "main", ""),
    ("S04", 2300, 2, 1000, "right", 108, 80, "FR", "main", ""),
    ("S05", 2300, 2, 1200, "left", 144, 250, "FR", "branch", ""),
    ("S06", 2300, 2, 900, "right", 108, 240, "NO", "branch", ""),
    ("S07", 2300, 3, 500, "left", 72, 100, "NO", "branch", ""),
    ("S08", 2000, 3, 400, "right", 108, 60, "NO", "branch", ""),
    ("S09", 2300, 3, 600, "left", 72, 310, "IT", "branch", ""),
    ("S10", 2300, 4, 300, "right", 54, 90, "IT", "branch", ""),
    ("S11", 2300, 4, 350, "left", 72, 150, "FR", "main", ""),
    ("S12", 1400, 4, 300, "right", 54, 20, "FR", "main", ""),
    ("S13", 2300, 1, None, "straight", 144, 70, "IT", "main", "A"),
]
OVER_TIME = 4  # sections of the campaign that is cut by the time

Q0 = 60.0  # kN
VEHICLE = """name: Coach
category: passenger
running_gear: bogies
secondary_suspension: true
static_wheel_load: 60
admissible_speed: 140 km/h
uncertainty:
  numerical: 0.3 kN
  input: 0.04
  measured: 0.6 kN
  Y: 0.9 kN
  Y_simulated: 1.1 kN
  Q: 1.5 kN
  Q_simulated: 1.2 kN
  ay: 0.05 m/s^2
  ay_simulated: 0.04 m/s^2
"""


def channels():
    """Name, unit, mean, then quarter period in samples and size of each wave."""
    for w in WHEELS:
        yield f"Y_{w}", "N", 9000, ((97, 16000), (31, 7000), (7, 2000))
    for w in WHEELS:
        yield f"Q_{w}", "N", 60000, ((113, 18000), (23, 12000), (5, 3000))
    for name, mean, big in ("ay", 300, 900), ("az", 0, 1300), ("ayb", 0, 2100):
        for g in GEARS:
            yield f"{name}_{g}", "mm/s^2", mean, ((129, big), (41, big // 2), (11, big // 3))
    for g in GEARS:
        yield f"roll_{g}", "mrad", 4, ((173, 40), (37, 12), (11, 3))


def step(number):
    """mm from sample to sample: 54 km/h are 15 m/s, 75 mm in 1/200 s."""
    return SECTIONS[number][5] * 75 // 54


def record(number, side):
    """Columns of whole numbers; `side` is 0 for the measurement and 1 for the simulation."""
    turn = -1 if SECTIONS[number][4] == "left" else 1
    columns = {}
    for at, (name, unit, mean, waves) in enumerate(channels()):
        mean = mean if name.startswith("Q") else mean * turn
        # What the simulation is off by, from -1/5 to 1/5 of the largest wave.
        mean += side * (waves[0][1] * ((5 * number + 3 * at) % 9 - 4) // 20)
        values = []
        for i in range(ROWS):
            # A rise of its own tells one period from the next.
            v = mean + waves[0][1] * i * i // (2 * ROWS * ROWS)
            for k, (quarter, size) in enumerate(waves):
                shift = 37 * at * (k + 1) + 1000 * number + 4 * side * (number % 3)
                size += size * side * (number % 4) // 32
                v += filters.triangle(i + shift, quarter + at % 5 + 2 * (number % 5), size)
            values.append(v)
        columns[name, unit] = values
    return columns


class Record:
    """A record in kN, m/s^2 and rad, with the section that is cut from it."""

    def __init__(self, number, side, over_time=False):
        units = {"N": 1e3, "mm/s^2": 1e3, "mrad": 1e3}
        self.c = {n: np.array(v, float) / units[u] for (n, u), v in record(number, side).items()}
        i = np.arange(ROWS)
        self.number, self.name = number, SECTIONS[number][0]
        self.t = i / RATE
        self.x = (i * step(number) + side * LATE) / 1000
        self.axis = self.t if over_time else self.x
        measured = i / RATE if over_time else i * step(number) / 1000
        self.start, self.end = measured[FIRST], measured[SECTIONS[number][1]]
        self.inside = (self.axis >= self.start) & (self.axis <= self.end)

    def cut(self, values):
        return values[self.inside]


def write(folder, over_time):
    numbers = range(OVER_TIME if over_time else len(SECTIONS))
    for side, kind in enumerate(("measurement", "simulation")):
        (folder / kind).mkdir(parents=True, exist_ok=True)
        for number in numbers:
            columns = record(number, side)
            head = ["time [s]", "distance [m]"] + [f"{n} [{u}]" for n, u in columns]
            lines = [",".join(head)]
            for i, row in enumerate(zip(*columns.values())):
                mm = i * step(number) + side * LATE
                lines.append(f"{i / RATE:.3f},{mm / 1000:.3f}," + ",".join(map(str, row)))
            (folder / kind / f"{SECTIONS[number][0]}.csv").write_text("\n".join(lines) + "\n")
    (folder / "campaign.yaml").write_text(
        "name: Triangles\nvehicle: vehicle.yaml\nsections: sections.csv\nmeasurement: measurement\nsimulation: simulation\n")
    (folder / "vehicle.yaml").write_text(VEHICLE)
    unit = "s" if over_time else "m"
    table = [f"section,start [{unit}],end [{unit}],zone [-],radius [m],direction,cant [mm],cant deficiency [mm],speed [km/h],"
             "conicity [-],country,line,site"]
    for number in numbers:
        name, last, zone, radius, direction, speed, conicity, country, line, site = SECTIONS[number]
        cells = [f"{i / RATE if over_time else i * step(number) / 1000:.3f}" for i in (FIRST, last)]
        table.append(f"{name},{','.join(cells)},{zone},{radius or ''},{direction},{0 if zone == 1 else 90},{0 if zone == 1 else 80},{speed},"
                     f"0.{conicity:03},{country},{line},{site}")
    (folder / "sections.csv").write_text("\n".join(table) + "\n")


if __name__ == "__main__":
    root = pathlib.Path(sys.argv[1])
    write(root / "distance", False)
    write(root / "time", True)
