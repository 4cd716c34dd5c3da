#!/usr/bin/env python3
"""Writes assessment.json beside itself: samples of an assessment and what another program makes of them by regression.

    python3 make_assessment.py LIBRARY.JSON SECTIONS.CSV [LIBRARY.JSON SECTIONS.CSV ...]

LIBRARY.JSON holds, of one campaign, the values of each section and the estimates of each zone (NumPy 2.4.6, SciPy 1.17.1);
SECTIONS.CSV is the campaign's table. Kept are a few quantities: of both signs, in curves only, with two values a section.
"""
import csv
import json
import sys
from pathlib import Path

KEPT = {"SigmaY_max": ["1"], "SigmaY_instability": ["3"], "az_rms": ["I"], "B_qst": ["1"]}
out = []
for library, table in zip(sys.argv[1::2], sys.argv[2::2]):
    library = json.loads(Path(library).read_text())
    rows = {row["section"]: row for row in csv.DictReader(open(table))}
    names = list(rows)

    def point(name):
        row = rows[name]
        curvature = 1 / float(row["radius [m]"]) if row["radius [m]"] else 0.0
        return [float(row["speed [km/h]"]), float(row["cant deficiency [mm]"]), curvature]

    campaign = {"campaign": library["campaign"], "points": [point(name) for name in names], "samples": []}
    for side in ("measured", "simulated"):
        of_side = library["assessment"][side]
        for estimate in of_side["estimates"]:
            quantity, zone, group = (estimate[key] for key in ("quantity", "zone", "group"))
            if group not in KEPT.get(quantity, []):
                continue
            values = [row for row in of_side["values"]["rows"] if row[2] == quantity and row[3] == group]
            sample = {"of": f"{side} {quantity} {zone} {group}", "class": estimate["klass"]}
            for method, zones in (("two_dimensional", [zone]), ("multiple_zone", [zone]), ("multiple_zones_2_4", [2, 3, 4])):
                if method not in estimate:
                    continue
                taken = [row for row in values if row[1] in zones]
                keep = ("target", "coefficients", "s_e", "dof", "leverage", "t", "fit", "value", "reason")
                sample[method] = {"section": [names.index(row[0]) for row in taken], "y": [row[4] for row in taken]}
                sample[method] |= {key: estimate[method][key] for key in keep if key in estimate[method]}
            campaign["samples"].append(sample)
    out.append(campaign)
text = json.dumps(out, separators=(",", ":"))
Path(__file__).with_name("assessment.json").write_text(text.replace('{"of"', '\n{"of"').replace('{"campaign"', '\n{"campaign"') + "\n")
