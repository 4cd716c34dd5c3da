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
    if job.frames:
        _engines.rows(_of_frames(job), job)
        return job.result(plots)
    task = ray.remote(max_retries=_engines.RETRIES)(_engines.part)
    pieces = _records.gathered(job.pieces) if job.pieces is not None else {}
    made = {task.remote(number, job.work, pieces.get(number, {})): number for number in job.open}
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


def _of_frames(job: _engines.Job) -> Any:
    """The parts of a campaign whose records are datasets of Ray."""
    places, work = job.places, job.work
    pieces = [import_module("ray.data").from_arrow(job.pieces)] if job.pieces is not None else []
    for path, frame in job.frames.items():
        pieces.append(frame.map_batches(lambda rows, path=path: _records.cut(rows, path, places), batch_format="pyarrow"))
    whole = pieces[0].union(*pieces[1:]) if pieces[1:] else pieces[0]
    made = whole.groupby("part").map_groups(lambda rows: _values(rows, work), batch_format="pyarrow")
    for row in made.iter_rows():
        yield row["part"], row["values"], row["error"]


def _values(rows: Any, work: _engines.Work) -> Any:
    import pyarrow

    made = [_engines.row(number, work, records) for number, records in _records.gathered(rows).items()]
    kinds = {"part": pyarrow.int32(), "values": pyarrow.large_binary(), "error": pyarrow.large_binary()}
    return pyarrow.table([pyarrow.array([row[at] for row in made], kind) for at, kind in enumerate(kinds.values())], names=list(kinds))


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
