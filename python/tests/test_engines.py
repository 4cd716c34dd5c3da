"""Parts in any order and number, and engines that lose a worker in mid-job: the same bytes as on one machine."""

import os
import random
import shutil
import signal
import subprocess
import sys
import threading
import time

import pytest
from conftest import COACH

import fishplate
from fishplate import _engines


@pytest.fixture(scope="module")
def whole():
    return fishplate.certify(COACH)


@pytest.mark.parametrize("shards", [1, 2, 5, 13, 40])
def test_parts_in_any_order(whole, shards, tmp_path):
    parts = [fishplate.reduce(COACH, shard=(number, shards)) for number in range(shards)]
    random.Random(shards).shuffle(parts)
    path = tmp_path / "values.parquet"
    path.write_bytes(parts[0])
    found = fishplate.judge([path, *parts[1:]])
    assert found.json() == whole.json() and found.figures == whole.figures


def test_parts_that_are_wrong():
    part = fishplate.reduce(COACH, shard=(0, 2))
    for wrong in ([], [b""], [part[:-1]], [part[:200] + bytes([part[200] ^ 1]) + part[201:]], [b"PAR1" * 100]):
        with pytest.raises(fishplate.Error) as caught:
            fishplate.judge(wrong)
        assert caught.value.code != "internal", caught.value
    other = fishplate.reduce(COACH, shard=(1, 2), sections_per_zone=4)
    with pytest.raises(fishplate.Error):
        fishplate.judge([part, other])
    with pytest.raises(fishplate.Error, match="shard"):
        fishplate.reduce(COACH, shard=(2, 2))
    missing = fishplate.judge([part])
    assert missing.verdict == "not assessable" and any("missing" in reason for reason in missing.reasons), missing.reasons


def slowly(seconds):
    """A part that takes longer, so that a worker can be lost meanwhile. Nested: workers cannot import this file."""
    fast = _engines.part

    def slow(*given):
        import time

        time.sleep(seconds)
        return fast(*given)

    return slow


@pytest.fixture(scope="module")
def client():
    distributed = pytest.importorskip("distributed", reason="Dask is not installed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            yield client


def test_dask(client, whole):
    import fishplate.dask

    found = fishplate.dask.certify(client, COACH)
    assert found.json() == whole.json() and found.figures == whole.figures


def test_dask_with_a_worker_that_is_killed(client, whole, monkeypatch):
    import fishplate.dask

    monkeypatch.setattr(_engines, "part", slowly(1.0))
    worker = next(iter(client.run(os.getpid).values()))
    threading.Timer(1.5, os.kill, (worker, signal.SIGKILL)).start()
    begin = time.monotonic()
    found = fishplate.dask.certify(client, COACH, shards=8)
    assert time.monotonic() - begin > 1.5, "it ended before the worker was killed"
    assert worker not in client.run(os.getpid).values()
    assert found.json() == whole.json()


def test_dask_names_a_record_that_always_fails(client, tmp_path):
    import fishplate.dask

    folder = tmp_path / "coach"
    shutil.copytree(COACH, folder)
    (folder / "measurement" / "S02.csv").write_text("time [s]\n")
    found = fishplate.dask.certify(client, folder)
    told = found.sections.to_polars().row(1, named=True)
    assert not told["used"] and "measurement/S02.csv" in told["reason"]
    assert found.json() == fishplate.certify(folder).json()
    (folder / "sections.csv").unlink()
    with pytest.raises(fishplate.Error, match="sections.csv"):
        fishplate.dask.certify(client, folder)


def test_engines_take_folders():
    campaign = fishplate.Campaign(COACH)
    with pytest.raises(fishplate.Error, match="folders"):
        _engines.folders([campaign])


SPARK = """
import os, signal, subprocess, sys, threading, time
from pyspark.sql import SparkSession
import fishplate, fishplate.spark
from fishplate import _engines

fast = _engines.part

def slow(*given):
    import time
    time.sleep(1.0)
    return fast(*given)

_engines.part = slow
os.environ["PYSPARK_PYTHON"] = sys.executable
spark = (SparkSession.builder.master("local-cluster[2,1,1024]").config("spark.ui.enabled", "false")
         .config("spark.executor.memory", "512m").config("spark.task.maxFailures", "8").getOrCreate())

def kill():
    children = subprocess.run(["ps", "-eww", "-o", "pid,ppid,args"], capture_output=True, text=True).stdout.splitlines()
    rows = [line.split(None, 2) for line in children[1:]]
    mine, grown = {str(os.getpid())}, True
    while grown:
        more = {pid for pid, parent, _ in rows if parent in mine} - mine
        grown, mine = bool(more), mine | more
    executors = [pid for pid, _, args in rows if pid in mine and "CoarseGrainedExecutorBackend" in args]
    print("executors", len(executors), flush=True)
    os.kill(int(executors[0]), signal.SIGKILL)

warm = spark.range(0, 4, 1, 4).count()
threading.Timer(4.0, kill).start()
begin = time.monotonic()
found = fishplate.spark.certify(spark, sys.argv[1], shards=12)
print("seconds", round(time.monotonic() - begin, 1), flush=True)
assert time.monotonic() - begin > 4.0
assert found.json() == fishplate.certify(sys.argv[1]).json()
print("same bytes", flush=True)
spark.stop()
"""


def test_spark_with_an_executor_that_is_killed():
    if "FISHPLATE_SPARK" not in os.environ:
        pytest.skip("it takes minutes: set FISHPLATE_SPARK=1")
    pytest.importorskip("pyspark", reason="Spark is not installed")
    if not shutil.which("java"):
        pytest.skip("Java is not installed")
    done = subprocess.run([sys.executable, "-c", SPARK, str(COACH)], capture_output=True, text=True, timeout=600)
    assert "executors 2" in done.stdout and "same bytes" in done.stdout, done.stdout + done.stderr[-4000:]
