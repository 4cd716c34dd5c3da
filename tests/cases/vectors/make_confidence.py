#!/usr/bin/env python3
"""Writes confidence.json beside itself: differences of sites and what another program makes of them by bootstrap, jackknife and
closed forms.

    python3 make_confidence.py LIBRARY.JSON DIFFERENCES.CSV SECTIONS.CSV [LIBRARY.JSON DIFFERENCES.CSV SECTIONS.CSV ...]

LIBRARY.JSON holds, of one campaign, the intervals of each quantity (NumPy 2.4.6, SciPy 1.17.1); DIFFERENCES.CSV the differences
they are of, by the program of `tests/cases/peer`; SECTIONS.CSV is the campaign's table, whose column `repeat of` joins sections
to sites.
"""
import csv
import json
import sys
from pathlib import Path

KEPT = ("Y_qst", "Q_qst", "SigmaY_max", "az_rms")
out = []
for library, differences, table in zip(sys.argv[1::3], sys.argv[2::3], sys.argv[3::3]):
    library = json.loads(Path(library).read_text())
    again = {row["section"]: row.get("repeat of") or row["section"] for row in csv.DictReader(open(table))}
    rows = list(csv.DictReader(open(differences)))
    confidence = library["confidence"]
    campaign = {"campaign": library["campaign"], **confidence["bootstrap"], "quantities": []}
    for quantity in confidence["quantities"]:
        if quantity["quantity"] not in KEPT:
            continue
        taken = [row for row in rows if row["quantity"] == quantity["quantity"]]
        order = list(dict.fromkeys(again[row["section"]] for row in taken))
        campaign["quantities"].append(
            {**quantity, "site": [order.index(again[row["section"]]) for row in taken],
             "difference": [float(f'{float(row["difference"]):.15g}') for row in taken]})
    out.append(campaign)
text = json.dumps(out, separators=(",", ":"))
Path(__file__).with_name("confidence.json").write_text(text.replace('{"quantity"', '\n{"quantity"').replace('{"campaign"', '\n{"campaign"') + "\n")
