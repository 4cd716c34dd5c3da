"""Simulators whose runs are tasks of an engine: the same diagnosis, each run made once, and more workers take less time."""

import os
import pathlib
import time

import double_pendulum
import pytest

import fishplate

FOLDER = double_pendulum.FOLDER
HERE = str(pathlib.Path(__file__).parent)
#: Duration of a run [s]: long beside what a task costs, a few milliseconds.
SECONDS = 0.05


def diagnosed(simulator, jobs):
    return fishplate.diagnose(FOLDER, FOLDER / "double-pendulum.fp", FOLDER / "effects.yaml", simulator, simulator_name="two-link", jobs=jobs)


def sleeping(seconds, log=None):
    """The double pendulum, which takes a while. Nested: workers cannot import this file."""
    here = HERE

    def simulate(task):
        import os
        import sys
        import time

        time.sleep(seconds)
        sys.path.insert(0, here)
        from double_pendulum import two_link

        if log is not None:
            with open(os.path.join(log, os.urandom(8).hex()), "w"):
                pass
        return two_link(task)

    return simulate


def test_more_workers_take_less_time():
    if "FISHPLATE_SLOW" not in os.environ:
        pytest.skip("it takes minutes: set FISHPLATE_SLOW=1")
    distributed = pytest.importorskip("distributed", reason="Dask is not installed")
    import fishplate.dask

    here = diagnosed(double_pendulum.two_link, 2).json()
    walls = {}
    for workers in (2, 8):
        # They sleep: threads are enough.
        with distributed.LocalCluster(n_workers=1, threads_per_worker=workers, processes=False, dashboard_address=None) as cluster:
            with distributed.Client(cluster) as client:
                begin = time.monotonic()
                assert diagnosed(fishplate.dask.simulator(client, sleeping(SECONDS)), workers).json() == here
                walls[workers] = time.monotonic() - begin
    print(walls)
    assert walls[8] < 0.6 * walls[2], walls


def test_no_run_is_made_twice(tmp_path):
    distributed = pytest.importorskip("distributed", reason="Dask is not installed")
    import fishplate.dask

    made = lambda: len(list((tmp_path / "log").iterdir()))
    (tmp_path / "log").mkdir()
    with distributed.LocalCluster(n_workers=1, threads_per_worker=8, processes=False, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            twin = lambda identity: fishplate.dask.simulator(client, sleeping(0.0, tmp_path / "log"), keep=tmp_path / "runs", identity=identity)
            first = diagnosed(twin("a"), 8).json()
            once = made()
            assert once > 50 and diagnosed(twin("a"), 8).json() == first and made() == once
            # Some records are lost.
            kept = sorted((tmp_path / "runs").glob("*/*.arrow"))
            assert len(kept) == once
            [path.unlink() for path in kept[:3]]
            assert diagnosed(twin("a"), 8).json() == first and made() == once + 3
    with pytest.raises(fishplate.Error, match="identity"):
        fishplate.dask.simulator(None, sleeping(0.0), keep=tmp_path)


def test_a_run_that_fails_is_told():
    distributed = pytest.importorskip("distributed", reason="Dask is not installed")
    import fishplate.dask

    def simulate(task):
        raise RuntimeError("no licence")

    with distributed.LocalCluster(n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client, pytest.raises(fishplate.Error, match="no licence"):
            diagnosed(fishplate.dask.simulator(client, simulate), 2)
