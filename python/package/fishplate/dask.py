"""`certify` on a Dask cluster: `fishplate.dask.certify(client, campaign)`."""

from __future__ import annotations

from os import PathLike
from typing import Any

from . import Result, _engines, judge


def certify(
    client: Any,
    campaign: Any,
    protocol: str | PathLike[str] | None = None,
    *,
    shards: int | None = None,
    plots: int = 8,
    **parameters: Any,
) -> Result:
    """The same result as `fishplate.certify`, made by the workers of a `distributed.Client`.

    The workers see the campaign under the same path. A part whose worker is lost is made again.
    """
    count = _engines.parts(shards, len(client.scheduler_info()["workers"]))
    given = (count, _engines.folders(campaign), _engines.asked(protocol), parameters, plots > 0)
    futures = [
        client.submit(_engines.part, number, *given, pure=False, retries=_engines.RETRIES, key=f"fishplate-{number}-{id(given)}")
        for number in range(count)
    ]
    try:
        return judge(client.gather(futures), plots=plots)
    finally:
        client.cancel(futures)
