"""The reduction of an archive of runs as an experienced analyst would write it: polars reads, scipy filters, numpy evaluates, Dask spreads.

    run(client, folder)     folder: a campaign of runs as Parquet with a table of sections, as `cargo run --example archive` makes it

One task for each run: its columns are read once, each filter runs once over the whole run, and each section is cut out of it. The
quantities are the twelve of EN 14363 Annex T as in `tests/cases/peer/reference_dynotrain.py`, whose functions are used.
"""

import importlib.util
import pathlib
import sys

import numpy as np
import polars as pl

HERE = pathlib.Path(__file__).resolve()


def reference():
    path = HERE.parents[2] / "tests" / "cases" / "peer" / "reference_dynotrain.py"
    spec = importlib.util.spec_from_file_location("reference_dynotrain", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules["reference_dynotrain"] = module
    spec.loader.exec_module(module)
    return module


def of_run(path, sections):
    """{(section, quantity, signal): (low, high)} of one record of a run; sections: (name, start, end)"""
    ref = reference()
    c, need = ref.CONFIG, ref.signal_names(ref.CONFIG)
    wheels = [name[2:] for name in need["Y"]]
    names = {ref.UNIT.sub("", name).strip(): name for name in pl.read_parquet_schema(path)}
    wanted = ["time", "distance", *need["Y"], *need["Q"], *need["ay"], *need["az"]]
    table = pl.read_parquet(path, columns=[names[name] for name in wanted])
    column = {name: table[names[name]].to_numpy() for name in wanted}
    time, distance = column["time"], column["distance"]
    rate = round((time.size - 1) / (time[-1] - time[0]))
    low, band = ref.filters(c, rate)
    Y = np.stack([column[f"Y_{wheel}"] for wheel in wheels])
    Q = np.stack([column[f"Q_{wheel}"] for wheel in wheels])
    SY = np.stack([column[f"Y_{axle}R"] + column[f"Y_{axle}L"] for axle in c["wheelsets"]])
    YQ = Y / Q
    filtered = ref.apply(c, low, np.concatenate([Y, Q, YQ, SY]))
    count = len(wheels)
    parts = dict(Y=filtered[:count], Q=filtered[count : 2 * count], YQ=filtered[2 * count : 3 * count], SY=filtered[3 * count :])
    accelerations = ref.apply(c, band, np.stack([column[name] for name in need["ay"] + need["az"]]))
    parts |= dict(ay=accelerations[: len(need["ay"])], az=accelerations[len(need["ay"]) :])
    found = {}
    for section, start, end in sections:
        first, last = np.searchsorted(distance, start), np.searchsorted(distance, end, side="right")
        # Two metres more for the windows.
        near = slice(first, min(last + rate, distance.size))
        raw = dict(YQ=YQ[:, near], SY=SY[:, near])
        slid = {kind: ref.sliding_mean(c, distance[near], of, start, end) for kind, of in raw.items()}
        for quantity, kind, how, _, _ in ref.QUANTITIES:
            x = slid[kind] if how == "slide_max" else parts[kind][:, first:last]
            if how == "median":
                lows = highs = np.median(x, axis=1)
            elif how == "rms":
                lows = highs = np.sqrt(np.mean(x * x, axis=1))
            else:
                lows, highs = np.percentile(x, [c["p_low"], c["p_high"]], axis=1)
            for name, lower, upper in zip(need[kind], lows, highs):
                found[section, quantity, name] = (lower, upper)
    return found


def run(client, folder):
    """The values of both sides of all sections."""
    import yaml

    folder = pathlib.Path(folder)
    described = yaml.safe_load((folder / "campaign.yaml").read_text())
    table = pl.read_csv(folder / "sections.csv", infer_schema_length=None)
    columns = {name.split(" [")[0]: name for name in table.columns}
    rows = table.select(columns["section"], columns["run"], columns["start"], columns["end"]).rows()
    tasks = []
    for name, files in described["runs"].items():
        sections = [(section, start, end) for section, run, start, end in rows if run == name]
        for side in ("simulation", "measurement"):
            if sections:
                tasks.append(client.submit(of_run, str(folder / files[side]), sections, pure=False))
    return client.gather(tasks)
