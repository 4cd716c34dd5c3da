"""Campaigns of the examples, and the same ones in memory."""

import csv
import pathlib

import numpy
import pytest

import fishplate

ROOT = pathlib.Path(__file__).resolve().parents[2]
COACH = ROOT / "examples" / "coach"
KINDS = ("measurement", "simulation", "track")


@pytest.fixture(scope="session")
def coach():
    return COACH


@pytest.fixture(scope="session")
def whole():
    """The result on one machine."""
    return fishplate.certify(COACH)


def records(folder, kind, convert):
    return {path.stem: convert(fishplate.read(path)) for path in sorted((folder / kind).glob("*.csv"))}


def in_memory(folder=COACH, convert=lambda table: table, kinds=KINDS):
    """A campaign whose parts are all in memory."""
    text = lambda name: (folder / name).read_text()
    return fishplate.Campaign(
        text("campaign.yaml"),
        vehicle=text("vehicle.yaml"),
        sections=text("sections.csv"),
        **{kind: records(folder, kind, convert) for kind in kinds},
    )


def as_numpy(table):
    frame = table.to_polars()
    return {name: frame[name].to_numpy().copy() for name in frame.columns}


def as_pandas(table):
    return table.to_pandas()


def as_polars(table):
    return table.to_polars()


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def small(count=12, seed=1, rows=1200, **changes):
    """A made-up campaign of straight sections, as dicts of arrays."""
    random = numpy.random.default_rng(seed)
    names = [f"S{n:02}" for n in range(1, count + 1)]
    time = numpy.arange(rows) / 200.0
    channels = [f"{kind}_{wheel}{side} [kN]" for kind in "YQ" for wheel in range(1, 5) for side in "RL"]
    channels += ["ay_I [m/s^2]", "ay_II [m/s^2]", "az_I [m/s^2]", "az_II [m/s^2]"]

    def record():
        made = {"time [s]": time, "distance [m]": 60.0 * time}
        return made | {name: random.normal(50.0 if name.startswith("Q") else 0.0, 2.0, rows) for name in channels}

    table = {
        "section": names,
        "zone [-]": [1] * count,
        "start [m]": [40.0] * count,
        "end [m]": [310.0] * count,
        "radius [m]": [None] * count,
        "direction": ["straight"] * count,
        "cant [mm]": [0.0] * count,
        "cant deficiency [mm]": [0.0] * count,
        "speed [km/h]": [216.0] * count,
    }
    parts = {
        "description": "made up",
        "vehicle": {
            "category": "passenger",
            "running_gear": "bogies",
            "secondary_suspension": True,
            "static_wheel_load": "54.5 kN",
            "admissible_speed": "140 km/h",
        },
        "sections": table,
        "measurement": {name: record() for name in names},
        "simulation": {name: record() for name in names},
    }
    return parts | changes


def long_frame(kind, folder=COACH, seed=1):
    """The records of all sections in one data frame, its rows in no order."""
    import polars

    frames = [table.to_polars().with_columns(polars.lit(section).alias("section")) for section, table in records(folder, kind, lambda table: table).items()]
    return polars.concat(frames, how="diagonal").sample(fraction=1.0, shuffle=True, seed=seed)


def of_frames(convert, folder=COACH, kinds=KINDS):
    """The campaign of long data frames, which `convert` makes those of an engine."""
    text = lambda name: (folder / name).read_text()
    frames = {kind: convert(long_frame(kind, folder)) for kind in kinds}
    return fishplate.Campaign(text("campaign.yaml"), vehicle=text("vehicle.yaml"), sections=text("sections.csv"), **frames)
