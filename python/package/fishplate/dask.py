"""`certify` on a Dask cluster, and simulators whose runs are tasks of it.

    python -m fishplate.dask certify CAMPAIGN --out DIR [--scheduler ADDRESS]     without an address, a cluster of this machine's cores
    python -m fishplate.dask run ADDRESS COMMAND...                               one command on a worker, for `--launch` of the program
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from functools import partial
from importlib import import_module
from os import PathLike
from typing import Any

from . import Result, Task, _engines, _launch, _records, _runs

#: Seconds without any worker after which none is expected to come back. One that is started again takes some seconds.
GONE = 60.0
#: Bytes that the C libraries of a worker, such as that of zstd, keep for their next record before they give back memory.
TRIM = 128 << 20


def certify(
    client: Any,
    campaign: Any,
    protocol: str | PathLike[str] | None = None,
    *,
    shards: int | None = None,
    plots: int = 8,
    keep: str | PathLike[str] | None = None,
    **parameters: Any,
) -> Result:
    """The same result as `fishplate.certify`, made by the workers of a `distributed.Client`.

    campaign
        Folders that the workers see under the same path; or a `Campaign` in memory, or of Dask data frames.
    shards
        Number of parts; four for each worker.
    keep
        A folder that all workers see, for the values of the parts: a job that is started again makes only those that are missing.

    A part whose worker is lost is made again. One that cannot be made is told in a warning, and its sections as missing.
    """
    distributed: Any = import_module("distributed")
    workers = len(client.scheduler_info(n_workers=-1)["workers"])
    job = _engines.Job.of(campaign, protocol, parameters, shards=shards, workers=workers, plots=plots, keep=keep)
    here = _records.gathered(job.pieces) if job.pieces is not None else {}
    there = [cut for path, frame in job.frames.items() for cut in _cut(client, frame, path, job.places)]

    def records(number: int) -> list[Any]:
        return [here.get(number, {}), *(client.submit(_engines.picked, cut, number, pure=False) for cut in there)]

    def submit(number: int) -> Any:
        return client.submit(
            _engines.of_pieces, number, job.work, *records(number), pure=False, retries=_engines.RETRIES, priority=-number
        )

    futures = {submit(number): number for number in job.open}
    try:
        for future in distributed.as_completed(list(futures)):
            job.attempt(futures[future], future.result)
        # A task that ends its workers takes with it those that they had been given besides: Dask gives up all of them. One after the
        # other, each part depends on itself alone. A single one has ended its workers by itself.
        killed = sorted(number for number, error in job.failed.items() if isinstance(error, distributed.KilledWorker))
        for number in killed if len(killed) > 1 else []:
            alone = submit(number)
            futures[alone] = number
            job.attempt(number, partial(_result, client, alone))
        return job.result(plots)
    finally:
        client.cancel(list(futures))


def _result(client: Any, future: Any) -> Any:
    """The result of a task, unless no worker is left that could make it."""
    last = time.monotonic()
    while not future.done():
        time.sleep(0.1)
        if client.scheduler_info(n_workers=-1)["workers"]:
            last = time.monotonic()
        elif time.monotonic() - last > GONE:
            raise RuntimeError("no worker is left")
    return future.result()


def _cut(client: Any, frame: Any, path: str, places: dict[str, list[int]]) -> list[Any]:
    """The pieces of each partition of a data frame, on the workers."""
    made = import_module("dask").delayed(lambda rows: _records.gathered(_records.cut(rows, path, places)), pure=False)
    return list(client.compute([made(rows) for rows in frame.to_delayed()]))


def simulator(
    client: Any, function: Callable[[Task], Any], *, keep: str | PathLike[str] | None = None, identity: str | None = None
) -> Callable[[Task], Any]:
    """A simulator for `diagnose` whose runs are tasks of a Dask cluster; `jobs` of `diagnose` is the number of runs at the same time.

    keep, identity
        A folder for its records, and a text that changes with the function and with whatever it reads: no run is made twice, also not if
        the diagnosis is started again.
    """

    def run(task: _runs.Run) -> Any:
        return client.submit(_runs.called, function, task, pure=False, retries=_engines.RETRIES).result()

    return _runs.simulator(run, function, keep, identity)


def main() -> int:
    return _launch.main("dask", _cluster, _command)


def _cluster(address: str | None, work: Callable[..., Result]) -> Result:
    distributed: Any = import_module("distributed")
    if address is not None:
        with distributed.Client(address) as client:
            return work(certify, client)
    options = dict(n_workers=os.cpu_count(), threads_per_worker=1, dashboard_address=None)
    # Dask lets C libraries give back memory after each 64 kB. The system then clears it anew for the next record.
    import_module("dask").config.set({"distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": TRIM})
    with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:
        return work(certify, client)


def _command(address: str, words: list[str]) -> int:
    with import_module("distributed").Client(address) as client:
        # A task that a lost worker had is given to another one; the command is started there once more.
        done = client.submit(_launch.here, words, os.getcwd(), dict(os.environ), pure=False, retries=_engines.RETRIES)
        return _launch.told(*done.result())


if __name__ == "__main__":
    raise SystemExit(main())
