"""Times `certify` on data frames that are in memory, against an evaluation script of the same job, in one process.

    peer_frames.py SCRIPT CAMPAIGN [ROUNDS]     SCRIPT is a module with run(folder, jobs=N) that reads with polars.read_csv

Neither reads a file of records: the script is given the same frames in place of its texts. The best of the rounds counts.
"""

import importlib.util
import io
import pathlib
import sys
import time

import polars

import fishplate

script, folder = sys.argv[1], pathlib.Path(sys.argv[2])
rounds = int(sys.argv[3]) if len(sys.argv) > 3 else 7
kinds = ("measurement", "simulation")

tables = {(kind, path.stem): fishplate.read(path) for kind in kinds for path in sorted((folder / kind).glob("*.csv"))}
frames = {of: polars.DataFrame(table) for of, table in tables.items()}

def campaign():
    return fishplate.Campaign(
        (folder / "campaign.yaml").read_text(),
        vehicle=(folder / "vehicle.yaml").read_text(),
        sections=(folder / "sections.csv").read_text(),
        **{kind: {section: frame for (of, section), frame in frames.items() if of == kind} for kind in kinds},
    )


spec = importlib.util.spec_from_file_location("peer", script)
peer = importlib.util.module_from_spec(spec)
sys.modules["peer"] = peer
spec.loader.exec_module(peer)


def frame(path):
    path = pathlib.Path(path)
    return frames.get((path.parent.name, path.stem))


class InMemory:
    def __getattr__(self, name):
        return getattr(polars, name)

    def read_csv(self, path, **options):
        found = frame(path)
        return polars.read_csv(path, **options) if found is None else found


def header(path, *words, **options):
    found = frame(path)
    return open(path, *words, **options) if found is None else io.StringIO(",".join(found.columns) + "\n")


peer.pl, peer.open = InMemory(), header


def seconds(work):
    start, processor = time.perf_counter(), time.process_time()
    work()
    return time.perf_counter() - start, time.process_time() - processor


for jobs in (1, 2):
    ours, theirs = [], []
    for _ in range(rounds):
        # The hash of a record is computed once: each round has a campaign of its own.
        again = campaign()
        ours.append(seconds(lambda: fishplate.certify(again, plots=0, jobs=jobs).json()))
        theirs.append(seconds(lambda: peer.run(folder, jobs=jobs)))
    (wall, processor), (peer_wall, peer_processor) = (tuple(map(min, zip(*times))) for times in (ours, theirs))
    print(
        f"jobs {jobs}: fishplate {wall:.3f} s ({processor:.3f} s of processor time), peer {peer_wall:.3f} s ({peer_processor:.3f} s),"
        f" peer/fishplate {peer_wall / wall:.1f} ({peer_processor / processor:.1f})"
    )
