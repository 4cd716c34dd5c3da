"""Spark with two executors, one of which is killed in mid-job: the same bytes as on one machine."""

import pathlib
import shutil
import subprocess
import sys

import pytest
from conftest import COACH

#: Parts take a second, so that an executor can be killed meanwhile: in each process that starts with this on its path.
SLOW = """
import time
try:
    from fishplate import _engines
    fast = _engines.part
    def part(*given):
        time.sleep(1.0)
        return fast(*given)
    _engines.part = part
except ImportError:
    pass
"""

SCRIPT = """
import os, signal, subprocess, sys, threading, time
sys.path.insert(0, sys.argv[2])
from pyspark.sql import SparkSession
from conftest import COACH, in_memory, of_frames
import fishplate, fishplate.spark

begin = time.monotonic()
os.environ["PYSPARK_PYTHON"] = sys.executable
spark = (SparkSession.builder.master("local-cluster[2,1,1024]").config("spark.ui.enabled", "false")
         .config("spark.executor.memory", "512m").config("spark.task.maxFailures", "8")
         .config("spark.executorEnv.PYTHONPATH", sys.argv[1]).getOrCreate())
spark.sparkContext.setLogLevel("OFF")
spark.range(0, 4, 1, 4).count()
print("started", round(time.monotonic() - begin, 1), flush=True)

def kill():
    listed = subprocess.run(["ps", "-eww", "-o", "pid,ppid,args"], capture_output=True, text=True).stdout.splitlines()
    rows = [line.split(None, 2) for line in listed[1:]]
    mine, grown = {str(os.getpid())}, True
    while grown:
        more = {pid for pid, parent, _ in rows if parent in mine} - mine
        grown, mine = bool(more), mine | more
    executors = [pid for pid, _, args in rows if pid in mine and "java" in args.split()[0] and "CoarseGrainedExecutorBackend" in args]
    assert len(executors) >= 2, executors
    print("killed", flush=True)
    os.kill(int(executors[0]), signal.SIGKILL)

threading.Timer(3.0, kill).start()
begin = time.monotonic()
found = fishplate.spark.certify(spark, COACH, shards=10)
assert time.monotonic() - begin > 3.0, "it ended before an executor was killed"
assert found.json() == fishplate.certify(COACH).json()
print("the same bytes", round(time.monotonic() - begin, 1), flush=True)

begin = time.monotonic()
campaign = of_frames(lambda frame: spark.createDataFrame(frame.to_arrow()).repartition(3))
found = fishplate.spark.certify(spark, campaign, shards=2)
assert found.json() == fishplate.certify(in_memory(convert=lambda table: table.to_polars())).json()
print("the same bytes of data frames", round(time.monotonic() - begin, 1), flush=True)
spark.stop()
"""


def test_an_executor_that_is_killed_and_data_frames(tmp_path):
    pytest.importorskip("pyspark", reason="Spark is not installed")
    if not shutil.which("java"):
        pytest.skip("Java is not installed")
    (tmp_path / "sitecustomize.py").write_text(SLOW)
    arguments = [str(tmp_path), str(pathlib.Path(__file__).parent)]
    done = subprocess.run([sys.executable, "-c", SCRIPT, *arguments], capture_output=True, text=True, timeout=300)
    print(done.stdout)
    for told in ("killed", "the same bytes ", "the same bytes of data frames"):
        assert told in done.stdout, done.stdout + done.stderr[:4000] + done.stderr[-2000:]
