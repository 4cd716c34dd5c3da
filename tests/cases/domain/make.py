"""Expected numbers of tests/evaluation/domain.rs, with SciPy 1.17.1 and NumPy 2.4.6: python3 make.py > expected.json

Points inside: no facet of scipy.spatial.ConvexHull is exceeded by more than 1e-9. The nearest point: the nearest of the nearest points of
all facets, each a triangle (or an edge in two dimensions), in closed form. Coordinates are divided by their range over the sections.
"""
import csv
import json
import pathlib

import numpy as np
from scipy.spatial import ConvexHull

ROOT = pathlib.Path(__file__).resolve().parents[3]
CAMPAIGN = ROOT / "examples" / "coach-good"


def rows(name):
    with open(CAMPAIGN / name, newline="") as file:
        return list(csv.DictReader(file))


def values(row):
    straight = row["direction"] == "straight"
    return [float(row["speed [km/h]"]), float(row["cant deficiency [mm]"]), 0.0 if straight else 1000.0 / float(row["radius [m]"])]


def nearest_of_simplex(corners, wanted):
    """The nearest point of a triangle or an edge: of its plane if that lies inside, else of its sides."""
    if len(corners) == 1:
        return corners[0]
    edges = (corners[1:] - corners[0]).T
    weights = np.linalg.lstsq(edges, wanted - corners[0], rcond=None)[0]
    if np.all(weights >= 0) and weights.sum() <= 1:
        return corners[0] + edges @ weights
    sides = [nearest_of_simplex(np.delete(corners, at, axis=0), wanted) for at in range(len(corners))]
    return min(sides, key=lambda side: np.linalg.norm(side - wanted))


def domain(of):
    sections, points = rows("sections.csv"), rows("application.csv")
    all_values = np.array([[values(row)[at] for at in of] for row in sections])
    low, high = all_values.min(axis=0), all_values.max(axis=0)
    scaled = (all_values - low) / (high - low)
    hull = ConvexHull(scaled)
    found = []
    for row in points:
        wanted = (np.array([values(row)[at] for at in of]) - low) / (high - low)
        inside = bool(np.max(hull.equations[:, :-1] @ wanted + hull.equations[:, -1]) <= 1e-9)
        nearest = wanted if inside else min(
            (nearest_of_simplex(scaled[facet], wanted) for facet in hull.simplices), key=lambda at: np.linalg.norm(at - wanted))
        by_section = np.linalg.norm(scaled - wanted, axis=1)
        found.append({
            "point": row["point"],
            "inside": inside,
            "distance": float(np.linalg.norm(nearest - wanted)),
            "nearest": (low + nearest * (high - low)).tolist(),
            "nearest_section": sections[int(by_section.argmin())]["section"],
            "section_distance": float(by_section.min()),
        })
    return {"corners": sorted(sections[at]["section"] for at in hull.vertices), "points": found}


print(json.dumps({"three": domain([0, 1, 2]), "two": domain([0, 1])}, indent=1))
