"""What engines cost: the reduction of an archive by plain processes, by Dask and by Spark, with as many workers; and the peer under Dask.

    engines.py CAMPAIGN [--workers 2] [--shards 34] [--rounds 3] [--only processes,dask,spark,peer]

CAMPAIGN: runs as Parquet with a table of sections. Start-up is not counted: each engine has made a small job before. Times are
processor times of all processes together, and wall times; the first tell more on a machine that does other work. The peak memory is the
largest of a Python worker.
"""

import argparse
import concurrent.futures
import importlib.util
import os
import pathlib
import sys
import time

import fishplate
from fishplate import _engines

HERE = pathlib.Path(__file__).resolve().parent
TICK = os.sysconf("SC_CLK_TCK")


def tree():
    """The processes below this one, and this one."""
    parents = {}
    for name in os.listdir("/proc"):
        if name.isdigit():
            try:
                fields = pathlib.Path("/proc", name, "stat").read_text().rpartition(")")[2].split()
            except OSError:
                continue
            parents[int(name)] = (int(fields[1]), sum(map(int, fields[11:15])) / TICK)
    mine, grown = {os.getpid()}, True
    while grown:
        more = {process for process, (parent, _) in parents.items() if parent in mine} - mine
        grown, mine = bool(more), mine | more
    return {process: parents[process][1] for process in mine if process in parents}


def processor():
    """Seconds of this process, of those below it, and of those of them that have ended."""
    return sum(tree().values())


def peak():
    """The largest peak memory of a Python process below this one, in MB."""
    found = [0]
    for process in tree():
        try:
            status = pathlib.Path("/proc", str(process), "status").read_text()
        except OSError:
            continue
        lines = dict(line.split(":", 1) for line in status.splitlines() if ":" in line)
        if process != os.getpid() and "python" in lines["Name"] and "VmHWM" in lines:
            found.append(int(lines["VmHWM"].split()[0]))
    return max(found) / 1024


def timed(work, rounds):
    work(True)
    times = []
    for _ in range(rounds):
        begin, before = time.monotonic(), processor()
        work(False)
        times.append((processor() - before, time.monotonic() - begin))
    return min(spent for spent, _ in times), min(wall for _, wall in times)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("campaign")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--shards", type=int, default=34)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--only", default="processes,dask,spark,peer")
    given = parser.parse_args()
    only, rounds, shards = given.only.split(","), given.rounds, given.shards
    small = str(HERE.parent / "examples" / "coach")
    told = {}

    def tell(name, times):
        told[name] = times
        share = f", {100 * (times[0] / told['processes'][0] - 1):+.0f} % of processor time" if "processes" in told else ""
        print(f"{name}: {times[0]:.1f} s of processor time, {times[1]:.1f} s wall, {peak():.0f} MB in a worker{share}", flush=True)

    def job(folder):
        return _engines.Job.of(folder, None, {}, shards=shards, workers=given.workers, plots=0, keep=None)

    if "processes" in only:
        context = __import__("multiprocessing").get_context("spawn")
        with concurrent.futures.ProcessPoolExecutor(given.workers, mp_context=context) as pool:

            def processes(first):
                made = job(small if first else given.campaign)
                for number, values in zip(made.open, pool.map(_engines.part, made.open, [made.work] * shards)):
                    made.made[number] = values
                return made.result(0)

            tell("processes", timed(processes, rounds))
    if {"dask", "peer"} & set(only):
        import distributed

        import fishplate.dask

        options = dict(n_workers=given.workers, threads_per_worker=1, dashboard_address=None)
        if "dask" in only:
            with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:
                of = lambda first: fishplate.dask.certify(client, small if first else given.campaign, shards=shards, plots=0)
                tell("dask", timed(of, rounds))
        if "peer" in only:
            sys.path.insert(0, str(HERE / "peer"))
            spec = importlib.util.spec_from_file_location("archive_dask", HERE / "peer" / "archive_dask.py")
            peer = importlib.util.module_from_spec(spec)
            sys.modules["archive_dask"] = peer
            spec.loader.exec_module(peer)
            os.environ["PYTHONPATH"] = os.pathsep.join([str(HERE / "peer"), os.environ.get("PYTHONPATH", "")])
            with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:
                tell("peer under dask", timed(lambda first: peer.run(client, given.campaign), rounds))
    if "spark" in only:
        from pyspark.sql import SparkSession

        import fishplate.spark

        os.environ["PYSPARK_PYTHON"] = sys.executable
        builder = SparkSession.builder.master(f"local-cluster[{given.workers},1,1024]").config("spark.ui.enabled", "false")
        spark = builder.config("spark.executor.memory", "512m").getOrCreate()
        spark.sparkContext.setLogLevel("OFF")
        of = lambda first: fishplate.spark.certify(spark, small if first else given.campaign, shards=shards, plots=0)
        tell("spark", timed(of, rounds))
        spark.stop()


if __name__ == "__main__":
    main()
