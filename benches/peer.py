"""Times an evaluation script of the same job from inside Python: start-up and imports do not count.

    peer.py SCRIPT          SCRIPT is a module with run(folder, jobs=N)

Reads one request a line, `JOBS FOLDER`; answers with the seconds that run() took by the clock and of the processors, and the
peak memory of the process in MB.

A script that reads `S01.csv` with polars reads `S01.parquet` instead where only that is there: the header from the schema,
the columns with `polars.read_parquet`. A first line `parquet` says whether this is possible.
"""
import builtins
import importlib.util
import io
import os
import resource
import sys
import time

spec = importlib.util.spec_from_file_location("peer", sys.argv[1])
peer = importlib.util.module_from_spec(spec)
sys.modules["peer"] = peer
spec.loader.exec_module(peer)


def columnar(path):
    """the Parquet file that stands in place of a text"""
    path = str(path)
    other = path[: -len(".csv")] + ".parquet"
    return other if path.endswith(".csv") and not os.path.exists(path) and os.path.exists(other) else None


class Polars:
    """polars, with read_csv for both formats"""

    def __init__(self, polars):
        self.polars = polars

    def __getattr__(self, name):
        return getattr(self.polars, name)

    def read_csv(self, path, **options):
        other = columnar(path)
        return self.polars.read_parquet(other) if other else self.polars.read_csv(path, **options)


if hasattr(peer, "pl"):
    polars = peer.pl
    peer.pl = Polars(polars)

    def open_header(path, *words, **options):
        other = columnar(path)
        return io.StringIO(",".join(polars.read_parquet_schema(other)) + "\n") if other else builtins.open(path, *words, **options)

    peer.open = open_header

print("parquet" if hasattr(peer, "pl") else "text", flush=True)
for line in sys.stdin:
    jobs, folder = line.rstrip("\n").split(" ", 1)
    start, used = time.perf_counter(), time.process_time()
    peer.run(folder, jobs=int(jobs))
    seconds, processors = time.perf_counter() - start, time.process_time() - used
    print(seconds, processors, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, flush=True)
