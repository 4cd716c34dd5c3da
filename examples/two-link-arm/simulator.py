"""A two-link arm as a function: torques of both joints from their measured angles (inverse dynamics of rigid links).

Friction and inertias that effects.yaml adds are zero in vehicle.yaml. Plain Python: NumPy is not needed.
"""

from math import cos, exp, sin, tanh

# The parameters that `simulate` reads: names in vehicle.yaml, which effects.yaml changes.
PARAMETERS = [
    "upper_length",
    "upper_centre",
    "upper_mass",
    "upper_inertia",
    "lower_centre",
    "lower_mass",
    "lower_inertia",
    "viscous_torque_1",
    "viscous_torque_2",
    "coulomb_torque_1",
    "coulomb_torque_2",
    "mass_torque_1",
    "mass_torque_2",
    "stiffness_torque_1",
    "stiffness_torque_2",
]
GRAVITY = 9.81
# Half width of the fit that gives speed and acceleration, and standard deviation of its weights, in s.
HALF, WEIGHT = 0.06, 0.025
# Speed in rad/s below which Coulomb friction is regularised.
TURNS = 0.05

motions = {}


def derivatives(angle, step):
    """Angle, speed and acceleration: a cubic fitted around every sample by weighted least squares."""
    half = round(HALF / step)
    offsets = range(-half, half + 1)
    weights = [exp(-0.5 * (n * step / WEIGHT) ** 2) for n in offsets]
    s0, s2, s4, s6 = (sum(w * n**k for w, n in zip(weights, offsets)) for k in (0, 2, 4, 6))
    first = [w * (s6 * n - s4 * n**3) / (s2 * s6 - s4**2) / step for w, n in zip(weights, offsets)]
    second = [2 * w * (s0 * n**2 - s2) / (s0 * s4 - s2**2) / step**2 for w, n in zip(weights, offsets)]
    # Beyond its ends the record is continued by point reflection.
    before = [2 * angle[0] - angle[n] for n in range(half, 0, -1)]
    after = [2 * angle[-1] - angle[-1 - n] for n in range(1, half + 1)]
    padded = before + angle + after
    pieces = [padded[n : n + 2 * half + 1] for n in range(len(angle))]
    fitted = lambda row: [sum(r * x for r, x in zip(row, piece)) for piece in pieces]
    return angle, fitted(first), fitted(second)


def motion(inputs):
    """Derivatives of both angles. They are the same for all parameters: computed once for a section."""
    name = inputs["section"]["section"]
    if name not in motions:
        time = [float(t) for t in inputs["time"]]
        step = (time[-1] - time[0]) / (len(time) - 1)
        motions[name] = [derivatives([float(q) for q in inputs[f"position_{n}"]], step) for n in (1, 2)]
    return motions[name]


def simulate(p, inputs):
    """The measured torques as far as rigid links explain them, in N m."""
    moment = p["lower_mass"] * p["lower_centre"]
    first_moment = p["upper_mass"] * p["upper_centre"] + p["lower_mass"] * p["upper_length"]
    inertia = p["upper_inertia"] + p["lower_mass"] * p["upper_length"] ** 2
    added = lambda n, q, v, a: (
        p[f"viscous_torque_{n}"] * v + p[f"coulomb_torque_{n}"] * tanh(v / TURNS)
        + p[f"mass_torque_{n}"] * a + p[f"stiffness_torque_{n}"] * q
    )
    shoulder, elbow = [], []
    for q1, v1, a1, q2, v2, a2 in zip(*(column for joint in motion(inputs) for column in joint)):
        c, s = p["upper_length"] * moment * cos(q2), p["upper_length"] * moment * sin(q2)
        hangs = GRAVITY * moment * sin(q1 + q2)
        lower = (p["lower_inertia"] + c) * a1 + p["lower_inertia"] * a2 + s * v1**2 + hangs
        upper = (inertia + c) * a1 + c * a2 - s * (v1 + v2) ** 2
        shoulder.append(lower + upper + GRAVITY * first_moment * sin(q1) + added(1, q1, v1, a1))
        elbow.append(lower + added(2, q2, v2, a2))
    return {"torque_1": shoulder, "torque_2": elbow}
