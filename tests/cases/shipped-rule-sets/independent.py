"""Independent numbers of shipped rule sets (NumPy, SciPy): `python independent.py FOLDER` writes the
campaign of tests/evaluation/rule_sets.rs to FOLDER, and expected.csv beside this file.

Windows: [a, a + W) from every sample a with a + W <= end; what a window gives stands at a.
"""

import math
import pathlib
import sys

import numpy as np
from scipy.signal import bilinear, butter, lfilter, lfilter_zi, sosfiltfilt
from scipy.stats import t as student

RATE, ROWS, STEP = 400, 4801, 0.1  # samples/s, samples, m between samples
SECTIONS = 3
# Expanded uncertainty of the measurement and of the simulation, standard ones of numerics and input.
U = {"Y": (0.9, 1.1, 0.2, 0.4), "Q": (1.5, 1.2, 0.3, 0.5), "ay": (0.05, 0.04, 0.01, 0.02)}
PARTS = "measured", "simulated", "numerical", "input"
UNCERTAINTY = "uncertainty:\n" + "".join(
    f"  {c}_{part}: {u} {'m/s^2' if c == 'ay' else 'kN'}\n" for c, us in U.items() for part, u in zip(PARTS, us))
Q0, FT, GN = 60e3, 0.3048, 9.80665
WHEELS = [f"{w}{s}" for w in "1234" for s in "RL"]


def triangle(i, quarter, size):
    r = i % (4 * quarter)
    v = r if r <= quarter else 2 * quarter - r if r <= 3 * quarter else r - 4 * quarter
    return size * v // quarter


# Name, unit, mean, then quarter period in samples and size of each wave.
def channels():
    for w in WHEELS:
        yield f"Y_{w}", "N", 9000, ((97, 16000), (31, 7000), (7, 2000))
    for w in WHEELS:
        yield f"Q_{w}", "N", 60000, ((113, 18000), (23, 12000), (5, 3000))
    for w in WHEELS:
        yield f"Q_level_{w}", "N", 61000, ((211, 500),)
    for name, mean, big in ("ay", 300, 900), ("az", 0, 1300), ("ayb", 0, 2100):
        for g in "I", "II":
            yield f"{name}_{g}", "mm/s^2", mean, ((129, big), (41, big // 2), (11, big // 3))


def record(section, side):
    columns = {}
    for at, (name, unit, mean, waves) in enumerate(channels()):
        values = []
        for i in range(ROWS):
            # A rise of its own tells one period from the next.
            v = mean + waves[0][1] * i * i // (2 * ROWS * ROWS)
            for k, (quarter, size) in enumerate(waves):
                shift = 37 * at * (k + 1) + 1000 * section + 3 * side
                v += triangle(i + shift, quarter + at % 5 + 2 * section, size + size * side // 16)
            # A blow of 20 ms, which a rule on short peaks leaves out.
            if name == "az_I" and 2000 <= i < 2008:
                v += 6000
            values.append(v)
        columns[name, unit] = values
    return columns


def write(folder):
    for side, kind in enumerate(("measurement", "simulation")):
        (folder / kind).mkdir(parents=True, exist_ok=True)
        for section in range(SECTIONS):
            columns = record(section, side)
            head = ["time [s]", "distance [m]"] + [f"{n} [{u}]" for n, u in columns]
            rows = zip(*columns.values())
            lines = [f"{i / RATE:.4f},{i / 10:.1f}," + ",".join(map(str, row)) for i, row in enumerate(rows)]
            (folder / kind / f"S{section + 1}.csv").write_text("\n".join([",".join(head)] + lines) + "\n")
    (folder / "campaign.yaml").write_text(
        "name: Triangles\nvehicle: vehicle.yaml\nsections: sections.csv\nmeasurement: measurement\nsimulation: simulation\n")
    (folder / "vehicle.yaml").write_text(
        "name: Coach\ncategory: passenger\nstatic_wheel_load: 60\nflange_angle: 68 deg\n" + UNCERTAINTY)
    table = "section,start [m],end [m],radius [m],direction,speed [km/h]\n"
    for section in range(SECTIONS):
        table += f"S{section + 1},100,400,500,right,144\n"
    (folder / "sections.csv").write_text(table)


def low(x, f, rate=RATE, order=4):
    """Both passes together are at -3 dB at the cut-off."""
    c = (math.sqrt(2) - 1) ** (1 / (2 * order))
    design = rate / math.pi * math.atan(math.tan(math.pi * f / rate) / c)
    return sosfiltfilt(butter(order, design, fs=rate, output="sos"), x)


def band(x, a, b, rate=RATE, order=4):
    c = (math.sqrt(2) - 1) ** (1 / (2 * order))
    a, b = (math.tan(math.pi * f / rate) for f in (a, b))
    width, centre = (b - a) / c, a * b
    a = (math.sqrt(width * width + 4 * centre) - width) / 2
    design = [rate / math.pi * math.atan(w) for w in (a, a + width)]
    return sosfiltfilt(butter(order, design, "bandpass", fs=rate, output="sos"), x)


def windows(x, at, width, value):
    end, last = at[-1], len(at)
    stops = np.searchsorted(at, at + width - 1e-6)
    return np.array([value(x[a:b], at[a:b]) for a, b in enumerate(stops)
                     if at[a] + width <= end + 1e-9 * width and b <= last])


def smallest(x, at, width):
    return windows(x, at, width, lambda v, _: v.min())


def largest(x, at, width):
    return windows(x, at, width, lambda v, _: v.max())


def about_trend(v, t):
    line = np.polyfit(t - t.mean(), v, 1)
    return math.sqrt(np.mean((v - np.polyval(line, t - t.mean())) ** 2))


def cfr(c, x, t):
    five, out = 5 * FT, {}
    truck = {"I": "12", "II": "34"}
    for w in WHEELS:
        out["single_wheel", w] = smallest(abs(low(c["Y_" + w], 25)) / low(c["Q_" + w], 25), x, five).max()
        out["wheel_load", w] = largest(low(c["Q_" + w], 25) / Q0, x, five).min()
    for w in "1234":
        net = low(c[f"Y_{w}R"] + c[f"Y_{w}L"], 25)
        out["net_axle", w] = smallest(abs(net) / (2 * Q0), x, five).max()
    for g, (a, b) in truck.items():
        for s in "RL":
            lateral = low(c[f"Y_{a}{s}"] + c[f"Y_{b}{s}"], 25)
            vertical = low(c[f"Q_{a}{s}"] + c[f"Q_{b}{s}"], 25)
            out[f"truck_side_{g}", s] = smallest(abs(lateral) / vertical, x, five).max()
            out[f"side_load_{g}", s] = largest(vertical / (2 * Q0), x, five).min()
    return out


def body(c, x, t):
    out = {}
    for g in "I", "II":
        for name, channel in ("lateral", "ay"), ("vertical", "az"):
            v = low(c[f"{channel}_{g}"], 10)
            out[f"body_{name}_rms", g] = windows(v, t, 4.0, about_trend).max()
            at = t
            for value, width in (np.min, 0.05), (np.max, 0.1), (np.min, 0.05):
                v = windows(v, at, width, lambda part, _: value(part))
                at = at[:len(v)]
            out[f"body_{name}_peak", g] = windows(v, at, 1.0, lambda part, _: np.ptp(part)).max()
        out["truck_lateral", g] = windows(band(c[f"ayb_{g}"], 0.5, 10), t, 2.0, about_trend).max()
    return out


def stationary(c, x, t):
    return {("load", w): c["Q_" + w].mean() / c["Q_level_" + w].mean() for w in WHEELS}


def transfer(x, numerator, denominator, rate=RATE):
    """Bilinear, one pass from the steady state of the first sample; highest power of s first."""
    b, a = bilinear(numerator, denominator, rate)
    return lfilter(b, a, x, zi=lfilter_zi(b, a) * x[0])[0]


def warped(f, rate=RATE):
    return 2 * rate * math.tan(math.pi * f / rate)


def pair(w, quality):
    return [1 / w**2, 1 / (quality * w), 1]


def sperling(x, gain, rate=RATE):
    p, z = warped(0.7236876838804673, rate), warped(5.52955694427682, rate)
    x = transfer(x, [gain / p, 0], [1 / p, 1], rate)
    return transfer(x, [1 / z, 1], pair(warped(6.127742397935874, rate), 0.9006768282515845), rate)


def sickness(x, rate=RATE):
    def at(f, quality):
        return pair(warped(f, rate), quality)
    x = transfer(x, [1 / warped(0.08, rate) ** 2, 0, 0], at(0.08, 0.70711), rate)
    x = transfer(transfer(x, [1], at(0.63, 0.70711), rate), [1], at(0.25, 0.86), rate)
    return transfer(x, [k * 0.0625**2 / 0.1**2 for k in at(0.0625, 0.8)], at(0.1, 0.8), rate)


def cut(v):
    return v[1000:4001]  # 100 m to 400 m, both ends included


def means_of_2m(v):
    """Windows of 20 samples every 5 samples, inside the section."""
    v = cut(v)
    return np.array([v[a:a + 20].mean() for a in range(0, len(v) - 20, 5)])


def gbt5599(c, x, t):
    out = {}
    for g in "I", "II":
        for name, channel, gain in ("lateral", "ay", 0.73730811351602), ("vertical", "az", 0.5882458219096603):
            v = cut(sperling(c[f"{channel}_{g}"], gain))
            out[f"ride_{name}", g] = 4.42 * math.sqrt(np.mean(v * v)) ** 0.3
    for w in WHEELS:
        lateral, vertical = low(c["Y_" + w], 40), low(c["Q_" + w], 40)
        out["derailment", w] = means_of_2m(abs(lateral) / vertical).max()
        out["unloading", w] = means_of_2m(1 - vertical / Q0).max()
    for w in "1234":
        out["axle_lateral", w] = abs(means_of_2m(low(c[f"Y_{w}R"] + c[f"Y_{w}L"], 40))).max() / 1e3
    return out


def dose(x):
    a = sickness(x)
    return math.sqrt(np.trapezoid(a * a, dx=1 / RATE))


def msdv(c, x, t, s):
    out = {}
    for g in "I", "II":
        measured, simulated = dose(c["az_" + g]), dose(s["az_" + g])
        out["dose_measured", g], out["dose_simulated", g] = measured, simulated
        out["dose_difference", g] = (simulated - measured) / measured
    return out


def aar(c, x, t):
    out = {}
    lv = {w: abs(low(c["Y_" + w], 15)) / low(c["Q_" + w], 15) for w in WHEELS}
    for w in WHEELS:
        out["wheel", w] = smallest(lv[w], t, 0.05).max()
        out["load", w] = largest(low(c["Q_" + w], 15) / Q0, t, 0.05).min()
    for w in "1234":
        out["axle", w] = smallest(lv[w + "R"] + lv[w + "L"], t, 0.05).max()
    for g, (a, b) in {"I": "12", "II": "34"}.items():
        for s in "RL":
            lateral = low(c[f"Y_{a}{s}"] + c[f"Y_{b}{s}"], 15)
            vertical = low(c[f"Q_{a}{s}"] + c[f"Q_{b}{s}"], 15)
            out[f"truck_side_{g}", s] = smallest(abs(lateral) / vertical, t, 0.05).max()
    return out


def reduced(c, s, name, position, value):
    scale = 1 if name == "ay" else 1e3
    return [value(cut(low(side[f"{name}_{position}"], 20))) / scale for side in (c, s)]


def positions():
    return [("Y", w) for w in WHEELS] + [("Q", w) for w in WHEELS] + [("ay", "I"), ("ay", "II")]


def rms(v):
    return math.sqrt(np.mean(v * v))


def en_score(c, x, t, s):
    out = {}
    for name, at in positions():
        measured, simulated = reduced(c, s, name, at, rms)
        out[name + "_En", at] = abs(simulated - measured) / math.hypot(*U[name][:2])
        out[name + "_error", at] = simulated - measured
    return out


def tost(c, x, t, s):
    out = {}
    for name, at in positions():
        measured, simulated = reduced(c, s, name, at, rms if name == "ay" else np.median)
        out[name + "_equivalence", at] = simulated - measured
    return out


def bounds(found):
    """Both 95 % ends of the mean; sections are the independent units, whose sums scatter."""
    for name in "Y", "Q", "ay":
        units = [[v for (q, _), v in one.items() if q == name + "_equivalence"] for one in found]
        mean, n, groups = np.mean(units), np.size(units), len(units)
        sums = [sum(np.array(unit) - mean) for unit in units]
        error = math.sqrt(groups / (groups - 1) * np.sum(np.square(sums))) / n
        half = student.ppf(0.95, groups - 1) * error
        yield name, mean + half, mean - half


ASSESSED = {
    "cfr-213-333": lambda *a: {k: v for k, v in {**cfr(*a), **body(*a)}.items() if not k[0].startswith("side_load")},
    "cfr-238-appendix-c": cfr,
    "cfr-238-appendix-c-stationary": stationary,
    "gbt5599": gbt5599,
    "aar-m1001-chapter-11": aar,
}
COMPARED = {"iso2631-msdv": msdv, "en-score": en_score, "tost-equivalence": tost}


def main():
    folder = pathlib.Path(sys.argv[1])
    write(folder)
    rows = ["protocol,section,quantity,position,value"]
    equivalence = []
    for section in range(SECTIONS):
        measured, simulated = ({n: np.array(v, float) / (1000 if "mm" in u else 1)
                                for (n, u), v in record(section, side).items()} for side in (0, 1))
        i = np.arange(ROWS)
        found = {p: f(measured, i / 10, i / RATE) for p, f in ASSESSED.items()}
        found |= {p: f(measured, i / 10, i / RATE, simulated) for p, f in COMPARED.items()}
        equivalence.append(found["tost-equivalence"])
        for protocol, numbers in found.items():
            for (quantity, position), value in numbers.items():
                rows.append(f"{protocol},S{section + 1},{quantity},{position},{float(value)!r}")
    for name, upper, lower in bounds(equivalence):
        print(name, upper, lower)
    pathlib.Path(__file__).with_name("expected.csv").write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
