"""Time of `impact` over an archive of values, on two processors. Standard library.

    impact.py PROGRAM FOLDER [--campaigns 200] [--maker target/release/examples/blind_campaigns] [--set score] [--rounds 3]

PROGRAM is `target/release/fishplate`. FOLDER gets campaigns of a set of `blind_campaigns` and their values under the shipped protocol, unless
they are there. A set with fewer campaigns than are asked for is made again with other seeds. The new protocol changes the limits of several
quantities. Printed: seconds by the clock and of the processors (the least of the rounds), verdicts that change, protocols compiled, sets of rules
looked at.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import time

OLD = "en14363-2016-annex-t"
#: Quantities and the limits of the new protocol.
LIMITS = {
    "Y_qst": "std 4.5 kN", "Q_qst": "std 3.5 kN", "YQ_qst": "std 0.06", "SigmaY_qst": "std 5 kN", "Y_max": "std 8 kN",
    "Q_max": "std 7 kN", "YQ_max": "std 0.09", "SigmaY_max": "std 8 kN", "ay_rms": "std 0.12 m/s^2", "az_rms": "std 0.12 m/s^2",
    "ay_max": "std 0.32 m/s^2", "az_max": "std 0.32 m/s^2",
}


def protocol(folder, rules):
    """A variant of the shipped protocol with so many changed limits."""
    path = folder / f"proposal-{rules}.fp"
    blocks = "".join(f"\nquantity {name}\n  limit  {limit}\n" for name, limit in list(LIMITS.items())[:rules])
    path.write_text(f'protocol proposal-{rules} "Proposal"\n  extends  {OLD}\n{blocks}')
    return path


def archive(program, folder, count, maker, kind):
    """Files of values of so many campaigns."""
    values = folder / "values"
    values.mkdir(parents=True, exist_ok=True)
    seed = 1
    while len(list(values.glob("*.parquet"))) < count:
        made = folder / f"campaigns-{seed}"
        if not made.exists():
            subprocess.run([*maker, kind, "--seed", str(1_000_000 * seed), "--out", made], check=True, stdout=subprocess.DEVNULL)
        for number, description in enumerate(sorted(made.rglob("campaign.yaml"))):
            # Campaigns of several seeds may have the same name.
            text = description.read_text()
            name = text.split("name: ", 1)[1].split("\n", 1)[0]
            if f", seed {seed}" not in name:
                description.write_text(text.replace(f"name: {name}", f"name: {name.strip()}, seed {seed}", 1))
            # The length of sections, which the protocol checks, follows from it.
            vehicle = description.parent / "vehicle.yaml"
            if "admissible_speed" not in vehicle.read_text():
                vehicle.write_text(vehicle.read_text() + "admissible_speed: 140 km/h\n")
            path = values / f"{seed}-{number:03}.parquet"
            if not path.exists():
                command = [program, "reduce", description.parent, "--no-plots", "--protocol", OLD, "--quiet", "--out", path]
                subprocess.run(command, check=True)
        seed += 1
    return sorted(values.glob("*.parquet"))[:count]


def measured(command):
    """Seconds by the clock and of the processors."""
    began = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    if os.waitstatus_to_exitcode(status) != 0:
        sys.exit(f"failed: {command}")
    return time.perf_counter() - began, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--campaigns", type=int, default=200)
    parser.add_argument("--maker", nargs="+", default=["cargo", "run", "--release", "--example", "blind_campaigns", "--"])
    parser.add_argument("--set", default="score")
    parser.add_argument("--rounds", type=int, default=3)
    asked = parser.parse_args()
    program = asked.program.resolve()
    files = archive(program, asked.folder, asked.campaigns, asked.maker, asked.set)
    print(f"{len(files)} campaigns, {sum(file.stat().st_size for file in files) / 1e6:.0f} MB of values")
    for rules in (1, 4, 12):
        out = asked.folder / "out"
        command = [program, "impact", OLD, protocol(asked.folder, rules), "--no-report", "--jobs", "2", "--out", out, "--over", *files]
        rounds = [measured(command) for _ in range(asked.rounds)]
        found = json.loads((out / "impact.json").read_text())
        clock, processors, memory = (min(column) for column in zip(*rounds))
        work = found["work"]
        print(
            f"{rules:2} changed limits: {clock:6.2f} s, {processors:6.2f} s of processors, {memory:4.0f} MB; {len(found['flips'])} verdicts change, "
            f"{work['protocols']} protocols, {work['sets']} sets of rules"
        )


if __name__ == "__main__":
    main()
