"""What engines cost: the reduction of an archive by plain processes, by Dask, Spark and Ray, with as many workers; and the peer under Dask.

    engines.py CAMPAIGN... [--workers 2] [--shards 8] [--rounds 2] [--repeat 1] [--only processes,dask,spark,ray,peer]

CAMPAIGN: runs as Parquet with a table of sections, such as `archive_cost.py` leaves; several are evaluated as one. Start-up is not
counted: each engine has made a small job before. `--repeat` evaluates the campaigns so many times, one after the other, and tells the sum:
a long job of a short archive. Times are processor times of all processes together, and wall times, the least of all
rounds; processor times tell more on a machine that does other work. The peak memory is the largest of a Python worker. The time of `judge`,
which the caller needs by itself after all parts, is part of each time but the peer's, and is told. Beside the peer, the same is also timed
by the protocol without its plausibility rules, which the peer does not have: this is the same work.
"""

import argparse
import concurrent.futures
import importlib.util
import os
import pathlib
import sys
import tempfile
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
        if process != os.getpid() and ("python" in lines["Name"] or "ray::" in lines["Name"]) and "VmHWM" in lines:
            found.append(int(lines["VmHWM"].split()[0]))
    return max(found) / 1024


def bare_protocol(campaign, folder):
    """The protocol of a campaign without its plausibility rules: the peer has none."""
    lines = pathlib.Path(campaign, "campaign.yaml").read_text().splitlines()
    name = next(line.split(":", 1)[1].strip() for line in lines if line.startswith("protocol:"))
    path = pathlib.Path(folder, "bare.fp")
    path.write_text(f'protocol bare "Without plausibility rules"\n  extends  {name}\n\nremove\n  plausibility  every\n')
    return str(path)


def timed(work, rounds, repeat):
    work(True)
    times = []
    for _ in range(rounds):
        begin, before = time.monotonic(), processor()
        for _ in range(repeat):
            work(False)
        times.append((processor() - before, time.monotonic() - begin))
    return min(spent for spent, _ in times), min(wall for _, wall in times)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("campaigns", nargs="+")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--shards", type=int, default=8)
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--only", default="processes,dask,spark,ray,peer")
    given = parser.parse_args()
    only, rounds, shards = given.only.split(","), given.rounds, given.shards
    small = [str(HERE.parent / "examples" / "coach")]
    # Times with `judge`, and processor times without.
    told, parts = {}, {}

    def tell(name, times):
        told[name] = times
        plain = told["processes"] if "processes" in told else times
        more = ", ".join(f"{100 * (mine / other - 1):+.0f} % {what}" for mine, other, what in zip(times, plain, ("of processor time", "wall")))
        share = "" if plain is times else f", {more}"
        print(f"{name}: {times[0]:.1f} s of processor time, {times[1]:.1f} s wall, {peak():.0f} MB in a worker{share}", flush=True)

    def job(folder, protocol=None):
        return _engines.Job.of(folder, protocol, {}, shards=shards, workers=given.workers, plots=0, keep=None)

    if "processes" in only:
        context = __import__("multiprocessing").get_context("spawn")
        with concurrent.futures.ProcessPoolExecutor(given.workers, mp_context=context) as pool:

            def processes(first, protocol=None):
                made = job(small if first else given.campaigns, None if first else protocol)
                made.made = dict(enumerate(pool.map(_engines.part, range(shards), [made.work] * shards)))
                begin = time.process_time()
                made.result(0)
                judging.append(time.process_time() - begin)

            def told_with_judge(name, work):
                judging.clear()
                times = timed(work, rounds, given.repeat)
                tell(name, times)
                judge = min(judging[1:]) * given.repeat
                parts[name] = times[0] - judge
                print(f"    of it `judge`, by the caller: {judge:.1f} s of processor time", flush=True)

            judging = []
            told_with_judge("processes", processes)
            if "peer" in only:
                with tempfile.TemporaryDirectory() as scratch:
                    bare = bare_protocol(given.campaigns[0], scratch)
                    told_with_judge("the same without plausibility rules", lambda first: processes(first, bare))
    if {"dask", "peer"} & set(only):
        import dask
        import distributed

        import fishplate.dask

        # As `python -m fishplate.dask` sets it.
        dask.config.set({"distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": fishplate.dask.TRIM})
        options = dict(n_workers=given.workers, threads_per_worker=1, dashboard_address=None)
        if "dask" in only:
            with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:
                of = lambda first: fishplate.dask.certify(client, small if first else given.campaigns, shards=shards, plots=0)
                tell("dask", timed(of, rounds, given.repeat))
        if "peer" in only:
            sys.path.insert(0, str(HERE / "peer"))
            spec = importlib.util.spec_from_file_location("archive_dask", HERE / "peer" / "archive_dask.py")
            peer = importlib.util.module_from_spec(spec)
            sys.modules["archive_dask"] = peer
            spec.loader.exec_module(peer)
            os.environ["PYTHONPATH"] = os.pathsep.join([str(HERE / "peer"), os.environ.get("PYTHONPATH", "")])
            with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:
                tell("peer under dask", timed(lambda first: [peer.run(client, folder) for folder in given.campaigns], rounds, given.repeat))
            for name, spent in parts.items():
                print(f"    {told['peer under dask'][0] / spent:.1f} times the processor time of {name}, `judge` left out", flush=True)
    if "spark" in only:
        from pyspark.sql import SparkSession

        import fishplate.spark

        os.environ["PYSPARK_PYTHON"] = sys.executable
        builder = SparkSession.builder.master(f"local-cluster[{given.workers},1,1024]").config("spark.ui.enabled", "false")
        spark = builder.config("spark.executor.memory", "512m").getOrCreate()
        spark.sparkContext.setLogLevel("OFF")
        of = lambda first: fishplate.spark.certify(spark, small if first else given.campaigns, shards=shards, plots=0)
        tell("spark", timed(of, rounds, given.repeat))
        spark.stop()
    if "ray" in only:
        import ray

        import fishplate.ray

        ray.init(num_cpus=given.workers, include_dashboard=False, log_to_driver=False, logging_level="error")
        tell("ray", timed(lambda first: fishplate.ray.certify(small if first else given.campaigns, shards=shards, plots=0), rounds, given.repeat))
        ray.shutdown()


if __name__ == "__main__":
    main()
