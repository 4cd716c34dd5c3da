"""Ray with a worker that is killed in mid-job: the same bytes as on one machine."""

import os
import signal
import threading
import time

import pytest
from conftest import COACH, in_memory, of_frames

import fishplate

ray = pytest.importorskip("ray", reason="Ray is not installed")
import fishplate.ray  # noqa: E402
from fishplate import _engines  # noqa: E402


@pytest.fixture(scope="module", autouse=True)
def cluster():
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, logging_level="error")
    yield
    ray.shutdown()


def test_the_same_bytes(whole):
    found = fishplate.ray.certify(COACH)
    assert found.json() == whole.json() and found.figures == whole.figures


def test_a_campaign_in_memory():
    campaign = in_memory()
    assert fishplate.ray.certify(campaign, shards=3).json() == fishplate.certify(campaign).json()


def test_datasets_of_ray():
    data = pytest.importorskip("ray.data", reason="ray.data is not installed")
    campaign = of_frames(lambda frame: data.from_arrow(frame.to_arrow()))
    found = fishplate.ray.certify(campaign, shards=3)
    assert found.json() == fishplate.certify(in_memory(convert=lambda table: table.to_polars())).json()


def test_a_worker_that_is_killed(whole, tmp_path, monkeypatch):
    """Each part takes a second and tells the process in which it is made; nested, since workers cannot import this file."""
    fast, folder = _engines.of_pieces, str(tmp_path)

    def slow(number, *given):
        import os
        import time

        with open(os.path.join(folder, f"{number}-{os.getpid()}"), "w"):
            time.sleep(1.0)
        return fast(number, *given)

    monkeypatch.setattr(_engines, "of_pieces", slow)
    killed = []

    def kill():
        while not (there := os.listdir(folder)):
            time.sleep(0.1)
        killed.append(there[0].split("-"))
        os.kill(int(killed[0][1]), signal.SIGKILL)

    threading.Thread(target=kill).start()
    found = fishplate.ray.certify(COACH, shards=6)
    assert found.json() == whole.json()
    number, _ = killed[0]
    assert len([name for name in os.listdir(folder) if name.split("-")[0] == number]) == 2, "made again by another process"
