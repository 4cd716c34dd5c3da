"""Cost of an archive against its length: `sections`, `reduce` and `judge` on one thread, with time, memory and bytes read. Standard library.

    archive_cost.py PROGRAM FOLDER [--lengths 5,20,50,100,200,500] [--maker target/release/examples/archive] [--plot docs/images/archive-cost.svg]

PROGRAM is `target/release/fishplate`. For each length an archive is made in FOLDER/LENGTH, unless it is there: by the program `--maker`, or
without it by `cargo run --example archive`. The vehicles of the archive are evaluated one after the other. Their times and bytes are added;
the memory is the largest. Needs Linux: /proc tells the bytes.
"""

import argparse
import json
import math
import os
import pathlib
import subprocess
import sys

STEPS = ("sections", "reduce", "judge")
#: The line of `campaign.yaml` that names the table of sections.
NAMED = "sections: sections.csv\n"


def measured(command):
    """Processor seconds, peak memory in MB and bytes read of a command, the cache of the system included."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT)
    told = dict(line.split(": ") for line in pathlib.Path(f"/proc/{process.pid}/io").read_text().splitlines())
    _, status, used = os.wait4(process.pid, 0)
    if os.waitstatus_to_exitcode(status) > 1:
        sys.exit(f"failed: {command}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024, int(told["rchar"])


def archive(folder, km, maker):
    """The campaigns of an archive of so many km, one for each vehicle."""
    made = folder / str(km)
    if not made.exists():
        runs = max(2, min(40, 2 * math.floor(km / 5)))
        subprocess.run([*maker, "--km", str(km), "--runs", str(runs), "--out", str(made)], check=True)
    return sorted(path.parent for path in made.glob("*/campaign.yaml"))


def of_vehicle(program, folder, campaign):
    """Each step of one campaign."""
    described, table = campaign / "campaign.yaml", campaign / "sections.csv"
    text = described.read_text().replace(NAMED, "")
    described.write_text(text)
    table.unlink(missing_ok=True)
    found = {"sections": measured([program, "sections", campaign, "--out", table, "-j", "1"])}
    described.write_text(NAMED + text)
    values, out = folder / "values.parquet", folder / "out"
    found["reduce"] = measured([program, "reduce", campaign, "--no-plots", "-j", "1", "--out", values])
    found["judge"] = measured([program, "judge", values, "--only", "results", "--out", out])
    return found, len(table.read_text().splitlines()) - 1, values.stat().st_size


def of_length(program, folder, km, maker):
    campaigns = archive(folder, km, maker)
    found = [of_vehicle(program, folder, campaign) for campaign in campaigns]
    size = sum(path.stat().st_size for campaign in campaigns for path in (campaign / "runs").iterdir())
    rows = {}
    for step in STEPS:
        seconds, memory, read = zip(*(steps[step] for steps, _, _ in found))
        rows[step] = dict(seconds=round(sum(seconds), 3), memory=round(max(memory), 1), bytes=sum(read))
    number = sum(count for _, count, _ in found)
    return dict(km=km, files=size, number=number, values=sum(size for _, _, size in found), **rows)


def svg(rows):
    """Processor time over length, both logarithmic, and a line of constant cost for each km."""
    width, height, left, bottom, top = 640, 400, 70, 50, 20
    lengths = [row["km"] for row in rows]
    seconds = [row[step]["seconds"] for row in rows for step in STEPS]
    x0, x1 = math.log10(min(lengths)) - 0.1, math.log10(max(lengths)) + 0.45
    y0, y1 = math.floor(math.log10(max(min(seconds), 0.01))), math.ceil(math.log10(max(seconds)))
    x = lambda km: left + (math.log10(km) - x0) / (x1 - x0) * (width - left - 20)
    y = lambda s: height - bottom - (math.log10(max(s, 0.01)) - y0) / (y1 - y0) * (height - bottom - top)
    colours = dict(zip(STEPS, ("#1b6ca8", "#c2410c", "#4d7c0f")))
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="13">']
    out.append(f'<rect width="{width}" height="{height}" fill="#ffffff"/>')
    for power in range(y0, y1 + 1):
        at = y(10.0**power)
        out.append(f'<line x1="{left}" y1="{at:.1f}" x2="{width - 20}" y2="{at:.1f}" stroke="#dddddd"/>')
        out.append(f'<text x="{left - 8}" y="{at + 4:.1f}" text-anchor="end">{10.0**power:g}</text>')
    for km in lengths:
        out.append(f'<line x1="{x(km):.1f}" y1="{top}" x2="{x(km):.1f}" y2="{height - bottom}" stroke="#eeeeee"/>')
        out.append(f'<text x="{x(km):.1f}" y="{height - bottom + 18}" text-anchor="middle">{km:g}</text>')
    for step in STEPS:
        points = [(x(row["km"]), y(row[step]["seconds"])) for row in rows]
        out.append(f'<polyline fill="none" stroke="{colours[step]}" stroke-width="2" points="{" ".join(f"{a:.1f},{b:.1f}" for a, b in points)}"/>')
        out += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="3.5" fill="{colours[step]}"/>' for a, b in points]
        last = points[-1]
        out.append(f'<text x="{last[0] + 8:.1f}" y="{last[1] + 4:.1f}" fill="{colours[step]}">{step}</text>')
    first = rows[0]["reduce"]["seconds"] / rows[0]["km"]
    ends = [(x(km), y(first * km)) for km in (lengths[0], lengths[-1])]
    out.append(f'<line x1="{ends[0][0]:.1f}" y1="{ends[0][1]:.1f}" x2="{ends[1][0]:.1f}" y2="{ends[1][1]:.1f}" stroke="#888888" stroke-dasharray="5 4"/>')
    out.append(f'<text x="{(left + width) / 2}" y="{height - 10}" text-anchor="middle">length of the runs [km]</text>')
    out.append(f'<text x="16" y="{height / 2}" text-anchor="middle" transform="rotate(-90 16 {height / 2})">processor time of one thread [s]</text>')
    return "\n".join([*out, "</svg>", ""])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--lengths", default="5,20,50,100,200,500")
    parser.add_argument("--maker")
    parser.add_argument("--plot", type=pathlib.Path)
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    maker = ["cargo", "run", "--release", "--example", "archive", "--"] if given.maker is None else [given.maker]
    rows = []
    for km in given.lengths.split(","):
        rows.append(of_length(given.program, given.folder, int(km), maker))
        print(json.dumps(rows[-1]), flush=True)
    if given.plot:
        given.plot.write_text(svg(rows))


if __name__ == "__main__":
    main()
