"""Dask with faults: the same bytes as on one machine, whatever happens to a worker or to the driver."""

import os
import shutil
import signal
import subprocess
import sys
import threading
import time

import pytest
from conftest import COACH, in_memory, of_frames

import fishplate

distributed = pytest.importorskip("distributed", reason="Dask is not installed")
import fishplate.dask  # noqa: E402


@pytest.fixture(scope="module")
def client():
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            yield client


@pytest.fixture
def slow(client):
    """Lets the parts of some workers, or of all, take longer. Nested: workers cannot import this file."""

    def patch(seconds):
        import time

        from fishplate import _engines

        fast = getattr(_engines, "fast", _engines.part)

        def part(*given):
            time.sleep(seconds)
            return fast(*given)

        _engines.fast, _engines.part = fast, part

    yield lambda seconds, workers=None: client.run(patch, seconds, workers=workers)
    client.run(patch, 0.0)


def test_the_same_bytes(client, whole):
    found = fishplate.dask.certify(client, COACH)
    assert found.json() == whole.json() and found.figures == whole.figures


def test_a_campaign_in_memory(client):
    campaign = in_memory()
    found = fishplate.dask.certify(client, campaign, shards=5)
    assert found.json() == fishplate.certify(campaign).json() and found.holds is False


def test_data_frames_of_dask(client):
    dataframe = pytest.importorskip("dask.dataframe", reason="dask.dataframe is not installed")
    campaign = of_frames(lambda frame: dataframe.from_pandas(frame.to_pandas(), npartitions=3))
    found = fishplate.dask.certify(client, campaign, shards=4)
    here = fishplate.certify(of_frames(lambda frame: frame))
    assert found.json() == here.json() == fishplate.certify(in_memory(convert=lambda table: table.to_polars())).json()
    with pytest.raises(fishplate.Error, match="data frame of an engine"):
        fishplate.certify(campaign)
    with pytest.raises(fishplate.Error, match="keep"):
        fishplate.dask.certify(client, campaign, keep="nowhere")


def test_a_worker_that_is_killed(client, whole, slow):
    slow(1.0)
    worker = next(iter(client.run(os.getpid).values()))
    threading.Timer(1.5, os.kill, (worker, signal.SIGKILL)).start()
    begin = time.monotonic()
    found = fishplate.dask.certify(client, COACH, shards=8)
    assert time.monotonic() - begin > 1.5, "it ended before the worker was killed"
    assert worker not in client.run(os.getpid).values()
    assert found.json() == whole.json()


DRIVER = """
import sys, distributed, fishplate.dask
fishplate.dask.certify(distributed.Client(sys.argv[1]), sys.argv[2], shards=6, keep=sys.argv[3])
"""


def test_a_driver_that_is_killed_and_started_again(client, whole, slow, tmp_path):
    slow(0.7)
    arguments = [client.scheduler.address, str(COACH), str(tmp_path)]
    driver = subprocess.Popen([sys.executable, "-c", DRIVER, *arguments])
    made = lambda: {path.name: path.stat().st_mtime_ns for path in tmp_path.glob("*/values-*.parquet")}
    while len(before := made()) < 2:
        assert driver.poll() is None, "it ended before it was killed"
        time.sleep(0.05)
    driver.kill()
    driver.wait()
    while client.processing() and any(client.processing().values()):
        time.sleep(0.1)
    before = made()
    assert 2 <= len(before) < 6, before
    slow(0.0)
    found = fishplate.dask.certify(client, COACH, shards=6, keep=tmp_path)
    assert found.json() == whole.json()
    after = made()
    assert len(after) == 6 and before.items() <= after.items(), "what was there was made again"
    # Another rule, other values.
    other = fishplate.dask.certify(client, COACH, shards=6, keep=tmp_path, sections_per_zone=4)
    assert other.json() == fishplate.certify(COACH, sections_per_zone=4).json() and len(list(tmp_path.iterdir())) == 2


def test_a_record_that_cannot_be_read(client, tmp_path):
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


def test_a_record_that_always_ends_its_worker():
    def patch():
        import os
        import time

        from fishplate import _engines

        fast = _engines.part

        def part(number, *given):
            if number == 3:
                time.sleep(0.3)
                os._exit(1)
            if number in (2, 4):
                time.sleep(1)
            return fast(number, *given)

        _engines.part = part

    class Everywhere(distributed.WorkerPlugin):
        """On workers that are started later, too."""

        def setup(self, worker):
            patch()

    # Two threads on one worker: a part beside the third is lost with it each time, and made in the end.
    with (
        distributed.LocalCluster(n_workers=1, threads_per_worker=2, dashboard_address=":0") as cluster,
        distributed.Client(cluster) as client,
    ):
        client.register_plugin(Everywhere(), name="ends")
        with pytest.warns(fishplate.Warning) as told:
            found = fishplate.dask.certify(client, COACH, shards=13)
    (only,) = (str(each.message) for each in told if issubclass(each.category, fishplate.Warning))
    assert only.startswith("part 3 of 13 could not be made: KilledWorker"), only
    missing = fishplate.Campaign(COACH).sections[3]
    assert found.verdict == "not assessable" and f"values of 1 of 13 sections are missing: {missing}" in found.reasons, found.reasons


def test_a_worker_of_another_version_is_refused(client):
    def version(of):
        import fishplate

        before, fishplate.__version__ = fishplate.__version__, of
        return before

    worker = next(iter(client.scheduler_info()["workers"]))
    before = client.run(version, "0.0.9", workers=[worker])[worker]
    try:
        with pytest.raises(fishplate.Error, match=f"a worker has fishplate 0.0.9, the caller {before}"):
            fishplate.dask.certify(client, COACH, shards=8)
    finally:
        client.run(version, before)


def test_a_slow_worker(client, whole, slow):
    client.wait_for_workers(2)
    first, second = client.scheduler_info()["workers"]
    slow(2.0, [first])
    slow(0.01, [second])
    assert fishplate.dask.certify(client, COACH, shards=10).json() == whole.json()


def test_one_command_on_a_cluster_of_this_machine(tmp_path):
    run = [sys.executable, "-m", "fishplate.dask", "certify", str(COACH), "--out", str(tmp_path / "out"), "--shards", "3"]
    done = subprocess.run(run, capture_output=True, text=True, timeout=120)
    assert done.returncode == 1 and "Verdict: not validated" in done.stdout, done.stdout + done.stderr
    assert (tmp_path / "out" / "results.json").read_bytes() == fishplate.certify(COACH).json()


def test_one_command_on_a_worker(client, tmp_path):
    run = [sys.executable, "-m", "fishplate.dask", "run", client.scheduler.address]
    code = f"import os, sys; print(os.getcwd(), os.environ['OF_THE_CALLER'], os.getppid(), file=open({str(tmp_path / 'told')!r}, 'w')); sys.exit(3)"
    environment = os.environ | {"OF_THE_CALLER": "seen"}
    done = subprocess.run([*run, sys.executable, "-c", code], cwd=tmp_path, env=environment, timeout=60)
    folder, seen, parent = (tmp_path / "told").read_text().split()
    assert (done.returncode, folder, seen) == (3, str(tmp_path), "seen")
    assert int(parent) in client.run(os.getpid).values()
