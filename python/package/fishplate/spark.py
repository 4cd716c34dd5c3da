"""`certify` on a Spark cluster: `fishplate.spark.certify(spark, campaign)`, and simulators whose runs are jobs of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from os import PathLike
from typing import Any

from . import Result, Task, _engines, _records, _runs

#: The columns of what executors return: the number of a part, its values, or a pickled error.
VALUES = "part int, values binary, error binary"
#: Those of a table of pieces.
PIECES = "part int, record string, ordered boolean, rows binary"


def certify(
    spark: Any,
    campaign: Any,
    protocol: str | PathLike[str] | None = None,
    *,
    shards: int | None = None,
    plots: int = 8,
    keep: str | PathLike[str] | None = None,
    **parameters: Any,
) -> Result:
    """The same result as `fishplate.certify`, made by the executors of a Spark session through `mapInArrow`.

    The executors have the wheel, pyarrow and pandas. The campaign is folders that they see under the same path; or a `Campaign` in memory,
    or of Spark data frames. All else is as of `fishplate.dask.certify`; `shards` is four for each core.
    """
    workers = spark.sparkContext.defaultParallelism
    job = _engines.Job.of(campaign, protocol, parameters, shards=shards, workers=workers, plots=plots, keep=keep)
    work, numbers = job.work, job.open

    def of_numbers(batches: Iterator[Any]) -> Iterator[Any]:
        for batch in batches:
            yield from _values(_engines.row(numbers[at], work) for at in batch.column(0).to_pylist())

    def of_pieces(table: Any) -> Any:
        import pyarrow

        made = _records.gathered(table).items()
        return pyarrow.Table.from_batches(list(_values(_engines.row(number, work, records) for number, records in made)))

    if job.pieces is not None or job.frames:
        made = _pieces(spark, job).groupBy("part").applyInArrow(of_pieces, VALUES)
    else:
        made = spark.range(0, len(numbers), 1, max(1, len(numbers))).mapInArrow(of_numbers, VALUES)
    if numbers:
        try:
            _engines.rows(_rows(made), job)
        except Exception:
            # Spark ends the whole job where the executor of one task is lost again and again; what was kept until then counts.
            if not job.kept():
                raise
    return job.result(plots)


def _rows(made: Any) -> Iterator[tuple[int, bytes | None, bytes | None]]:
    """What the executors have made. From Spark 4 on it comes as Arrow, which costs less than rows of Python."""
    if hasattr(made, "toArrow"):
        table = made.toArrow()
        yield from zip(*(table.column(name).to_pylist() for name in ("part", "values", "error")), strict=True)
    else:
        yield from ((row["part"], row["values"], row["error"]) for row in made.collect())


def _values(made: Iterator[tuple[int, bytes | None, bytes | None]]) -> Iterator[Any]:
    import pyarrow

    kinds = (("part", pyarrow.int32()), ("values", pyarrow.binary()), ("error", pyarrow.binary()))
    for row in made:
        yield pyarrow.RecordBatch.from_arrays([pyarrow.array([cell], kind) for cell, (_, kind) in zip(row, kinds)], schema=pyarrow.schema(kinds))


def _pieces(spark: Any, job: _engines.Job) -> Any:
    """All records, cut to the parts that need them."""
    places = job.places
    found = [spark.createDataFrame(job.pieces)] if job.pieces is not None else []
    for path, frame in job.frames.items():

        def cut(batches: Iterator[Any], path: str = path) -> Iterator[Any]:
            import pyarrow

            for batch in batches:
                for piece in _records.cut(pyarrow.Table.from_batches([batch]), path, places).to_batches():
                    yield pyarrow.RecordBatch.from_arrays([*piece.columns[:3], piece.column(3).cast("binary")], names=piece.schema.names)

        found.append(frame.mapInArrow(cut, PIECES))
    whole = found[0]
    for more in found[1:]:
        whole = whole.unionByName(more)
    return whole


def simulator(
    spark: Any, function: Callable[[Task], Any], *, keep: str | PathLike[str] | None = None, identity: str | None = None
) -> Callable[[Task], Any]:
    """A simulator for `diagnose` whose runs are jobs of one task each on a Spark cluster; see `fishplate.dask.simulator`."""

    def run(asked: _runs.Run) -> Any:
        return spark.sparkContext.parallelize([asked], 1).map(lambda asked: _runs.called(function, asked)).collect()[0]

    return _runs.simulator(run, function, keep, identity)
