#!/usr/bin/env python3
"""Writes filters.json, statistics.json and percentiles.json beside itself: the numbers of SciPy and NumPy for signals made in integers.

    python3 make.py        (NumPy 2.4.6, SciPy 1.17.1)
"""
import json
import math
from pathlib import Path

import numpy as np
from scipy import signal, stats

HERE = Path(__file__).parent


def record(n, offset):
    """Reproducible anywhere to the last bit: integers over a power of two."""
    k = np.arange(n, dtype=np.int64)
    return ((k * k * 7919 + k * 104729) % 65536) / 65536 - 0.5 + offset


def design(kind, order, hz, fs, both):
    """scipy.signal.butter, its pre-warped edges moved so that both passes together are at -3 dB at hz."""
    w = np.tan(np.pi * np.asarray(hz, float) / fs)
    if both:
        widen = (math.sqrt(2) - 1) ** (-1 / (2 * order))
        if kind == "lowpass":
            w = w * widen
        elif kind == "highpass":
            w = w / widen
        else:
            band, centre = (w[1] - w[0]) * (widen if kind == "bandpass" else 1 / widen), w[0] * w[1]
            low = (-band + math.sqrt(band * band + 4 * centre)) / 2
            w = np.array([low, low + band])
    hz = fs / np.pi * np.arctan(w)
    return signal.butter(order, hz[0] if kind in ("lowpass", "highpass") else hz, kind, fs=fs, output="sos")


def filters():
    cases = []
    for kind, hz, orders, rates in [
        ("lowpass", [20.0], [1, 2, 3, 4, 5, 8], [200.0, 500.0, 1000.0]),
        ("lowpass", [95.0], [3, 4], [200.0]),
        ("highpass", [0.5], [1, 2, 3, 4], [200.0, 1000.0]),
        ("highpass", [40.0], [4, 7], [200.0]),
        ("bandpass", [0.4, 10.0], [1, 2, 3, 4], [200.0, 400.0, 1000.0]),
        ("bandpass", [4.0, 6.0], [3, 5], [200.0, 600.0]),
        ("bandpass", [1.0, 90.0], [1, 3, 4], [200.0]),
        ("bandstop", [45.0, 55.0], [1, 2, 3, 4], [200.0, 1000.0]),
        ("bandstop", [2.0, 60.0], [1, 3, 4], [200.0]),
    ]:
        for fs in rates:
            for order in orders:
                for phase, both in [("zero", True), ("zero", False), ("causal", False), ("rest", False)]:
                    n, offset = 700, 60.0 if kind == "lowpass" else 0.75
                    x = record(n, offset)
                    sos = design(kind, order, hz, fs, both)
                    if phase == "zero":
                        y = signal.sosfiltfilt(sos, x)
                    elif phase == "causal":
                        y = signal.sosfilt(sos, x, zi=signal.sosfilt_zi(sos) * x[0])[0]
                    else:
                        y = signal.sosfilt(sos, x)
                    at = [0.1, hz[0] / 2, hz[0], hz[-1], (hz[-1] + fs / 2) / 2]
                    gain = np.abs(signal.sosfreqz(sos, at, fs=fs)[1]) ** (2 if phase == "zero" else 1)
                    cases.append(dict(kind=kind, hz=hz, order=order, sampling_rate=fs, phase=phase, as_applied=both, samples=n,
                                      offset=offset, scale=float(np.max(np.abs(y))), every=69, values=y[::69].tolist() + [y[-1]],
                                      frequencies=at, gain=gain.tolist(), slowest_pole=max_radius(sos)))
    return cases


def max_radius(sos):
    return float(np.max([np.abs(np.roots(s[3:])) for s in sos]))


def statistics():
    out = []
    for n in (2, 3, 6, 25, 67, 1001, 100001):
        x = record(n, 3.0)
        mean, std = x.mean(), x.std(ddof=1)
        t = stats.t.ppf(0.975, n - 1) * std / math.sqrt(n)
        chi = stats.chi2.ppf([0.975, 0.025], n - 1)
        out.append(dict(n=n, mean=mean, std=std, mean_interval=[mean - t, mean + t], std_interval=(std * np.sqrt((n - 1) / chi)).tolist()))
    x, y = record(50, 1.0), record(90, -2.0)[40:]
    line = stats.linregress(x, y)
    f = [dict(F=r, d1=a, d2=b, p=min(1.0, 2 * min(stats.f.cdf(r, a, b), stats.f.sf(r, a, b))))
         for r, a, b in [(1.001, 1e6, 1e6), (0.995, 2e6, 3e5), (1.01, 999999, 999999), (1.0, 5e5, 5e5), (3.0, 1, 1), (0.2, 2, 900),
                         (1.3, 45, 38), (1.3, 38, 41), (1.3, 1e5, 41)]]
    return dict(intervals=out, regression=dict(slope=line.slope, intercept=line.intercept, correlation=line.rvalue), f=f)


def percentiles():
    out = []
    for n in (1, 2, 3, 10, 137, 818):
        x = record(n, 0.0)
        percents = [0, 0.15, 1, 12.5, 25, 50, 60, 75, 99, 99.85, 100]
        for method in ("inverted_cdf averaged_inverted_cdf closest_observation interpolated_inverted_cdf hazen weibull linear "
                       "median_unbiased normal_unbiased lower higher midpoint nearest").split():
            out.append(dict(n=n, method=method, percents=percents, values=np.percentile(x, percents, method=method).tolist()))
    return out


for name, content in (("filters", filters()), ("statistics", statistics()), ("percentiles", percentiles())):
    (HERE / f"{name}.json").write_text(json.dumps(content, separators=(",", ":")) + "\n")
