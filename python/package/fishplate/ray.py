"""`certify` on a Ray cluster, after `ray.init()`, and simulators whose runs are tasks of it.

    python -m fishplate.ray certify CAMPAIGN --out DIR [--scheduler ADDRESS]      without an address, a cluster of this machine's cores
    python -m fishplate.ray run ADDRESS COMMAND...                                one command on a worker, for `--launch` of the program
"""

from __future__ import annotations

import os
from collections.abc import Callable
from importlib import import_module
from os import PathLike
from typing import Any

from . import Result, Task, _engines, _launch, _records, _runs


def certify(
    campaign: Any,
    protocol: str | PathLike[str] | None = None,
    *,
    shards: int | None = None,
    plots: int = 8,
    keep: str | PathLike[str] | None = None,
    **parameters: Any,
) -> Result:
    """The same result as `fishplate.certify`, made by the workers of a Ray cluster. All else is as of `fishplate.dask.certify`."""
    ray: Any = import_module("ray")
    workers = int(ray.cluster_resources().get("CPU", 1))
    job = _engines.Job.of(campaign, protocol, parameters, shards=shards, workers=workers, plots=plots, keep=keep)
    task, pick, cut = (ray.remote(max_retries=_engines.RETRIES)(work) for work in (_engines.of_pieces, _engines.picked, _cut))
    here = _records.gathered(job.pieces) if job.pieces is not None else {}
    there = [cut.remote(rows, path, job.places) for path, frame in job.frames.items() for rows in frame.to_arrow_refs()]
    made = {
        task.remote(number, job.work, here.get(number, {}), *(pick.remote(some, number) for some in there)): number for number in job.open
    }
    waiting = list(made)
    while waiting:
        (done, *_), waiting = ray.wait(waiting, num_returns=1)
        job.attempt(made[done], lambda done=done: _got(done))
    return job.result(plots)


def _got(task: Any) -> Any:
    ray: Any = import_module("ray")
    try:
        return ray.get(task)
    except ray.exceptions.RayTaskError as error:
        raise error.cause from None


def _cut(rows: Any, path: str, places: dict[str, list[int]]) -> Any:
    """The pieces of a block of a dataset, on a worker."""
    return _records.gathered(_records.cut(rows, path, places))


def simulator(
    function: Callable[[Task], Any], *, keep: str | PathLike[str] | None = None, identity: str | None = None
) -> Callable[[Task], Any]:
    """A simulator for `diagnose` whose runs are tasks of a Ray cluster; see `fishplate.dask.simulator`."""
    ray: Any = import_module("ray")
    task = ray.remote(max_retries=_engines.RETRIES)(_runs.called)

    def run(asked: _runs.Run) -> Any:
        return _got(task.remote(function, asked))

    return _runs.simulator(run, function, keep, identity)


def main() -> int:
    return _launch.main("ray", _cluster, _command)


def _cluster(address: str | None, work: Callable[..., Result]) -> Result:
    ray: Any = import_module("ray")
    ray.init(address=address, include_dashboard=False, log_to_driver=False)
    try:
        return work(certify)
    finally:
        ray.shutdown()


def _command(address: str, words: list[str]) -> int:
    ray: Any = import_module("ray")
    ray.init(address=address, log_to_driver=False)
    try:
        task = ray.remote(max_retries=_engines.RETRIES)(_launch.here)
        return _launch.told(*_got(task.remote(words, os.getcwd(), dict(os.environ))))
    finally:
        ray.shutdown()


if __name__ == "__main__":
    raise SystemExit(main())
