#!/usr/bin/env python3
"""Numbers of the shipped protocols of metrics, of sections of `examples/coach-good` and `examples/repeats`.

    pip install numpy scipy objective-rating-metrics==1.3
    python3 metrics.py

NumPy and SciPy alone, apart from ISO/TS 18571 (objective-rating-metrics 1.3) and CORA (code below; it has no published package).
The signals pass the 20 Hz low-pass over the whole record and are cut; the simulation is interpolated linearly at the distances of
the measured samples. Writes metrics.json, in SI: protocol > section > signal > quantity (of one of several records `quantity, record`);
of `kraft` also `index`: quantity > the 80 % value of the misfits of repeats, and the share of each record's misfits up to it.
"""
import csv
import json
import os
import warnings

import numpy as np
from objective_rating_metrics.rating import ISO18571
from scipy import signal, stats

here = os.path.dirname(os.path.abspath(__file__))
examples = os.path.join(here, "../../../examples")
WHEELS = [f"{wheelset}{side}" for wheelset in (1, 3) for side in "RL"]
SIGNALS = {
    "Y": ["Y_" + wheel for wheel in WHEELS],
    "Q": ["Q_" + wheel for wheel in WHEELS],
    "YQ": ["YQ_" + wheel for wheel in WHEELS],
    "SigmaY": ["SigmaY_1", "SigmaY_3"],
    "ay": ["ay_I", "ay_II"],
    "az": ["az_I", "az_II"],
}
BANDS = {"05": (0.5, 1), "1": (1, 2), "2": (2, 4), "4": (4, 8), "8": (8, 16)}
WIDER = (np.sqrt(2) - 1) ** (-1 / 8)


def read(path):
    with open(path) as file:
        rows = list(csv.reader(file))
    numbers = np.array(rows[1:], dtype=float)
    factor = {"kN": 1000.0}
    found = {}
    for at, name in enumerate(rows[0]):
        name, unit = name.rstrip("]").split(" [")
        found[name] = numbers[:, at] * factor.get(unit, 1.0)
    found["rate"] = (len(numbers) - 1) / (found["time"][-1] - found["time"][0])
    return found


def filtered(record, sos, name):
    where = name.split("_")[1]
    if name.startswith("YQ"):
        raw = record["Y_" + where] / record["Q_" + where]
    elif name.startswith("SigmaY"):
        raw = record[f"Y_{where}R"] + record[f"Y_{where}L"]
    else:
        raw = record[name]
    return signal.sosfiltfilt(sos, raw)


def low_pass(rate):
    edge = np.tan(np.pi * 20 / rate) * WIDER
    return signal.butter(4, 2 / np.pi * np.arctan(edge), output="sos")


def band_pass(rate, low, high):
    """-3 dB as applied: the same centre, the band wider."""
    low, high = np.tan(np.pi * low / rate), np.tan(np.pi * high / rate)
    half = (high - low) * WIDER / 2
    middle = np.sqrt(half**2 + low * high)
    edges = 2 / np.pi * np.arctan([middle - half, middle + half])
    return signal.butter(4, edges, "bandpass", output="sos")


def quantiles(x, n):
    return np.percentile(x, 100 * (np.arange(n) + 0.5) / n)


def bogojevic(s, m, n):
    s, m = quantiles(s, n), quantiles(m, n)
    f = np.var(s, ddof=1) / np.var(m, ddof=1)
    p = min(1.0, 2 * min(stats.f.cdf(f, n - 1, n - 1), stats.f.sf(f, n - 1, n - 1)))
    mean = 1 - abs(s.mean() - m.mean()) / max(abs(s.mean()), abs(m.mean()))
    return p, mean, p * max(0.0, mean)


def misfit(s, m):
    return np.sum((s - m) ** 2) / min(np.sum(s**2), np.sum(m**2))


def cora(s, m):
    n, best = len(m), None
    for k in range(int(np.floor(0.2 * n)) + 1):
        for a, b in [(s[k:], m[: n - k]), (s[: n - k], m[k:])]:
            cosine = np.dot(a, b) / np.sqrt(np.dot(a, a) * np.dot(b, b))
            if best is None or cosine > best[0] + 1e-12:
                best = (cosine, k, np.dot(a, a), np.dot(b, b))
    cosine, k, of_s, of_m = best
    outer, inner = 0.5 * np.max(np.abs(m)), 0.05 * np.max(np.abs(m))
    corridor = np.mean(np.clip((outer - np.abs(s - m)) / (outer - inner), 0, 1) ** 2)
    progression, size = ((cosine + 1) / 2) ** 10, min(of_s, of_m) / max(of_s, of_m)
    phase = float(np.clip((0.12 - k / (n - 1)) / (0.12 - 0.01), 0, 1))
    total = 0.5 * corridor + 0.5 * (0.5 * progression + 0.25 * size + 0.25 * phase)
    return {"cora": total, "cora_corridor": corridor, "cora_progression": progression, "cora_size": size, "cora_phase": phase}


def iso18571(s, m, rate):
    t = np.arange(len(m)) / rate
    rating = ISO18571(np.column_stack([t, m]), np.column_stack([t, s]), dt=1 / rate)
    of = lambda part: float(getattr(rating, part + "_rating")(ndigits=-1))
    return {"iso18571": of("overall")} | {"iso18571_" + part: of(part) for part in ("corridor", "phase", "magnitude", "slope")}


def metrics(s, m, rate):
    ss, mm, sm = np.sum(s * s), np.sum(m * m), np.sum(s * m)
    magnitude, phase = np.sqrt(ss / mm) - 1, np.arccos(np.clip(sm / np.sqrt(ss * mm), -1, 1)) / np.pi
    r = (ss - mm) / np.sqrt(ss * mm)
    russell = np.sign(r) * np.log10(1 + abs(r))
    mse = np.mean((s - m) ** 2)
    rmse = np.sqrt(mse)
    larger = np.maximum(s * s, m * m)
    found = {
        "sprague_geers": np.hypot(magnitude, phase),
        "sprague_geers_magnitude": magnitude,
        "sprague_geers_phase": phase,
        "russell": np.sqrt(np.pi / 4 * (russell**2 + phase**2)),
        "russell_magnitude": russell,
        "theil": rmse / (np.sqrt(np.mean(s * s)) + np.sqrt(np.mean(m * m))),
        "theil_bias": (s.mean() - m.mean()) ** 2 / mse,
        "theil_variance": (s.std() - m.std()) ** 2 / mse,
        "theil_covariance": 2 * (s.std() * m.std() - np.mean((s - s.mean()) * (m - m.mean()))) / mse,
        "misfit": misfit(s, m),
        "nrmse": rmse / np.sqrt(np.mean(m * m)),
        "nrmse_range": rmse / np.ptp(m),
        "rmse": rmse,
        "correlation": stats.pearsonr(s, m)[0],
        "match": bogojevic(s, m, 50)[2],
        "wifac": 1 - np.sqrt(np.sum(larger * (1 - np.maximum(0, m * s) / larger) ** 2) / np.sum(larger)),
        "area": stats.wasserstein_distance(s, m),
    }
    for name, (low, high) in BANDS.items():
        if len(m) >= 256:
            f, c = signal.coherence(s, m, fs=rate, window="hann", nperseg=256, noverlap=128, detrend="constant")
            inside = (low <= f) & (f < high)
            if inside.any():
                found["coherence_" + name] = c[inside].mean()
    return found | iso18571(s, m, rate) | cora(s, m)


def pair(simulated, measured, sos, name, inside, shift=0.0):
    x = measured["distance"][inside]
    return np.interp(x - shift, simulated["distance"], filtered(simulated, sos, name)), filtered(measured, sos, name)[inside]


def sections(campaign):
    with open(os.path.join(campaign, "sections.csv")) as file:
        return {row["section"]: (float(row["start [m]"]), float(row["end [m]"]), row.get("repeat of")) for row in csv.DictReader(file)}


def numbers():
    campaign = os.path.join(examples, "coach-good")
    for section, (start, end, _) in sections(campaign).items():
        if section not in ("S01", "S06", "S10", "S15"):
            continue
        s, m = (read(os.path.join(campaign, side, section + ".csv")) for side in ("simulation", "measurement"))
        sos = low_pass(m["rate"])
        within = lambda record: (start <= record["distance"]) & (record["distance"] <= end)
        for quantity, names in SIGNALS.items():
            for name in names:
                both = pair(s, m, sos, name, within(m))
                for metric, value in metrics(*both, m["rate"]).items():
                    yield "metrics-side-by-side", f"{quantity}_{metric}", section, name, value
                for band, edges in BANDS.items():
                    of = lambda record: signal.sosfiltfilt(band_pass(record["rate"], *edges), filtered(record, sos, name))[within(record)]
                    value = np.sqrt(np.mean(of(s) ** 2) / np.mean(of(m) ** 2))
                    yield "metrics-side-by-side", f"{quantity}_rms_{band}", section, name, value
                for n in (20, 50, 100):
                    fisher, mean, match = bogojevic(*both, n)
                    yield "bogojevic-lucanin", f"{quantity}_match_{n}", section, name, match
                    if n == 50:
                        yield "bogojevic-lucanin", f"{quantity}_match", section, name, match
                        yield "bogojevic-lucanin", f"{quantity}_fisher", section, name, fisher
                        yield "bogojevic-lucanin", f"{quantity}_mean", section, name, mean


def misfits():
    """Of the models, and of the repeats: there the original stands for the measurement, and both begin where their sections do."""
    campaign = os.path.join(examples, "repeats")
    known = sections(campaign)
    measured = {section: read(os.path.join(campaign, "measurement", section + ".csv")) for section in known}
    for section, (start, end, original) in known.items():
        m = measured[section]
        sos = low_pass(m["rate"])
        inside = (start <= m["distance"]) & (m["distance"] <= end)
        for quantity, names in SIGNALS.items():
            for name in (name for name in names if "3" not in name and "II" not in name):
                for model in ("reference", "soft_guidance"):
                    s = read(os.path.join(campaign, "simulation", model, section + ".csv"))
                    yield quantity, section, name, model, misfit(*pair(s, m, sos, name, inside))
                if original:
                    first, (start_first, end_first, _) = measured[original], known[original]
                    of_first = (start_first <= first["distance"]) & (first["distance"] <= end_first)
                    yield quantity, section, name, None, misfit(*pair(m, first, sos, name, of_first, start_first - start))


def kraft():
    found = list(misfits())
    for quantity, section, name, model, value in found:
        kind = f"{quantity}_repeated" if model is None else f"{quantity}_misfit, {model}"
        yield section, name, kind, value
    for quantity in SIGNALS:
        of = lambda model: np.array([value for known, _, _, of_model, value in found if (known, of_model) == (quantity, model)])
        index = np.percentile(of(None), 80)
        yield "index", quantity, "index", index
        for model in ("reference", "soft_guidance"):
            yield "index", quantity, model, np.mean(of(model) <= index)


if __name__ == "__main__":
    warnings.simplefilter("error")
    rows = [(protocol, section, name, quantity, value) for protocol, quantity, section, name, value in numbers()]
    rows += [("kraft", *row) for row in kraft()]
    found = {}
    for protocol, section, name, quantity, value in rows:
        found.setdefault(protocol, {}).setdefault(section, {}).setdefault(name, {})[quantity] = float(f"{value:.12g}")
    with open(os.path.join(here, "metrics.json"), "w") as file:
        json.dump(found, file, indent=0)
        file.write("\n")
    print(len(rows), "numbers")
