"""`certify` on a Spark cluster: `fishplate.spark.certify(spark, campaign)`."""

from __future__ import annotations

from collections.abc import Iterator
from os import PathLike
from typing import Any

from . import Result, _engines, judge


def certify(
    spark: Any,
    campaign: Any,
    protocol: str | PathLike[str] | None = None,
    *,
    shards: int | None = None,
    plots: int = 8,
    **parameters: Any,
) -> Result:
    """The same result as `fishplate.certify`, made by the executors of a Spark session through `mapInArrow`.

    The executors have the wheel, and see the campaign under the same path. Spark makes a part again whose executor is lost.
    """
    count = _engines.parts(shards, spark.sparkContext.defaultParallelism)
    given = (count, _engines.folders(campaign), _engines.asked(protocol), parameters, plots > 0)

    def reduced(batches: Iterator[Any]) -> Iterator[Any]:
        import pyarrow

        for batch in batches:
            numbers = batch.column(0).to_pylist()
            values = [_engines.part(number, *given) for number in numbers]
            yield pyarrow.RecordBatch.from_arrays([pyarrow.array(values, pyarrow.binary())], names=["values"])

    rows = spark.range(0, count, 1, count).mapInArrow(reduced, "values binary").collect()
    return judge([bytes(row["values"]) for row in rows], plots=plots)
