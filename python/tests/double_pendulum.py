"""The double pendulum of `examples/double-pendulum` as a Python function: from measured positions to torques.

The same model as `examples/double_pendulum_simulator.rs`.
"""

import functools
import pathlib

import numpy
from numpy import cos, sin, tanh

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "examples" / "double-pendulum"
#: Half width of the fit and standard deviation of its weights [s]; speed below which Coulomb friction is regularised [rad/s].
HALF, WEIGHT, TURNS = 0.06, 0.025, 0.05


def parameters():
    lines = (line.split("#")[0].split(":") for line in (FOLDER / "vehicle.yaml").read_text().splitlines())
    return {line[0].strip(): float(line[1]) for line in lines if len(line) == 2}


def fit(offsets, step):
    """Value, first and second derivative at 0 of a cubic fitted to samples at these offsets, as weights of the samples."""
    x = offsets * step / HALF
    powers = numpy.vander(x, 4, increasing=True)
    weights = numpy.exp(-0.5 * (offsets * step / WEIGHT) ** 2)
    rows = numpy.linalg.solve((powers.T * weights) @ powers, powers.T * weights)
    return rows[:3] * numpy.array([[1.0], [1.0 / HALF], [2.0 / HALF**2]])


def derivatives(values, step):
    half = round(HALF / step)
    count = len(values)
    inside = fit(numpy.arange(-half, half + 1), step)
    windows = numpy.lib.stride_tricks.sliding_window_view(values, 2 * half + 1)
    found = numpy.empty((3, count))
    found[:, half : count - half] = inside @ windows.T
    for at in [*range(half), *range(count - half, count)]:
        first, last = max(0, at - half), min(count - 1, at + half)
        found[:, at] = fit(numpy.arange(first, last + 1) - at, step) @ values[first : last + 1]
    return found


@functools.cache
def motion(section):
    time, upper, lower = numpy.loadtxt(FOLDER / "kinematics" / f"{section}.csv", delimiter=",", skiprows=1, unpack=True)
    step = (time[-1] - time[0]) / (len(time) - 1)
    return time, derivatives(upper, step), derivatives(lower, step)


def two_link(task):
    """The torques of a section with the parameters of the task."""
    p = parameters() | task.settings
    time, (q1, v1, a1), (q2, v2, a2) = motion(task.section)
    moment = p["lower_mass"] * p["lower_centre"] + p["payload_mass"] * p["lower_length"]
    inertia = p["lower_inertia"] + p["payload_mass"] * p["lower_length"] ** 2
    gear, rotor, length = p["gear_ratio"], p["motor_inertia"], p["upper_length"]
    hung = p["lower_mass"] + p["payload_mass"]
    c, s = length * moment * cos(q2), length * moment * sin(q2)
    m11 = p["upper_inertia"] + inertia + length**2 * hung + 2 * c + (gear**2 + 1) * rotor
    m12 = inertia + c - gear * rotor
    m22 = inertia + gear**2 * rotor
    lower = p["gravity"] * moment * sin(q1 + q2 + p["mount_tilt"])
    upper = p["gravity"] * (p["upper_mass"] * p["upper_centre"] + hung * length) * sin(q1 + p["mount_tilt"])
    shoulder = p["shoulder_viscous"] * v1 + p["shoulder_coulomb"] * tanh(v1 / TURNS)
    elbow = p["elbow_viscous"] * v2 + p["elbow_coulomb"] * tanh(v2 / TURNS)
    return {
        "time [s]": time,
        "tau_1 [N m]": m11 * a1 + m12 * a2 - s * (2 * v1 * v2 + v2**2) + upper + lower + shoulder,
        "tau_2 [N m]": m12 * a1 + m22 * a2 + s * v1**2 + lower + elbow,
    }
