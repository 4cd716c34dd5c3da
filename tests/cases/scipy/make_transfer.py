#!/usr/bin/env python3
"""Writes transfer.json beside itself: transfer functions by poles and zeros, made digital by SciPy. SciPy 1.17.1.

    python3 make_transfer.py

Each function is gain x zeros/poles, forward and backward gain x |zeros/poles|^2, a polynomial being [frequency] or [frequency, quality] (no quality: no damping). The record is
that of make.py, 200 samples about 1.5.
"""
import json
from pathlib import Path

import numpy as np
from scipy import signal


def polynomial(roots, kind):
    """Highest power first, 1 at s = 0."""
    w = 2 * np.pi * roots[0]
    if kind == "one":
        return np.array([1 / w, 1.0])
    damping = 1 / (roots[1] * w) if len(roots) > 1 else 0.0
    return np.array([1 / w**2, damping, 1.0])


def record(samples, offset):
    return np.array([((k * k * 7919 + k * 104729) % 65536) / 65536 - 0.5 + offset for k in range(samples)])


cases = [
    # poles, zeros, gain
    (("one", [5.0]), None, 1.0),
    (("one", [20.0]), ("one", [2.0]), 3.0),
    (("one", [0.5]), ("one", [0.0]), 1.0),
    (("two", [100.0, 0.70710678118654752]), None, 1.0),
    (("two", [0.4, 0.70710678118654752]), ("two", [0.0]), 1.0),
    (("two", [12.5, 0.63]), ("one", [12.5]), 1.0),
    (("two", [3.35, 0.91]), ("two", [2.37, 0.91]), 0.5005),
    (("two", [10.0, 0.3]), ("two", [30.0]), 2.0),
    (("two", [8.0, 1.5]), ("one", [0.0]), 1.0),
]
out = []
for (pole_kind, poles), zeros, gain in cases:
    for rate in (400.0, 1000.0):
        for warping in ("pre-warped", "plain"):
            def moved(f):
                return rate / np.pi * np.tan(np.pi * f / rate) if warping == "pre-warped" else f

            a = polynomial([moved(poles[0]), *poles[1:]], pole_kind)
            b = np.array([gain])
            if zeros:
                kind, roots = zeros
                if roots[0] == 0.0:
                    n = 1 if kind == "one" else 2
                    b = gain * np.array([1.0] + [0.0] * n) / (2 * np.pi * moved(poles[0])) ** n
                else:
                    b = gain * polynomial([moved(roots[0]), *roots[1:]], kind)
            bz, az = signal.bilinear(b, a, fs=rate)
            bz, az = (np.pad(x, (0, 3 - len(x))) for x in (np.atleast_1d(bz), np.atleast_1d(az)))
            sos = np.concatenate([bz, az])[None, :]
            x = record(200, 1.5)
            zi = signal.sosfilt_zi(sos)
            out.append({
                "poles": poles, "pole_kind": pole_kind, "zeros": zeros[1] if zeros else None, "zero_kind": zeros[0] if zeros else None,
                "gain": gain, "rate": rate, "warping": warping, "sos": sos[0].tolist(),
                "causal": signal.sosfilt(sos, x, zi=zi * x[0])[0][::23].tolist(),
                "causal-from-rest": signal.sosfilt(sos, x)[::23].tolist(),
                "zero-phase": (gain * signal.sosfiltfilt(sos / [[gain, gain, gain, 1, 1, 1]], x)[::23]).tolist(),
            })
Path(__file__).with_name("transfer.json").write_text(json.dumps(out).replace('{"poles"', '\n{"poles"') + "\n")
