"""`certify` on a Ray cluster: `fishplate.ray.certify(campaign)`, after `ray.init()`."""

from __future__ import annotations

from os import PathLike
from typing import Any

from . import Result, _engines, judge


def certify(
    campaign: Any,
    protocol: str | PathLike[str] | None = None,
    *,
    shards: int | None = None,
    plots: int = 8,
    **parameters: Any,
) -> Result:
    """The same result as `fishplate.certify`, made by the workers of a Ray cluster. They see the campaign under the same path."""
    import ray

    count = _engines.parts(shards, int(ray.cluster_resources().get("CPU", 1)))
    given = (count, _engines.folders(campaign), _engines.asked(protocol), parameters, plots > 0)
    task = ray.remote(max_retries=_engines.RETRIES)(_engines.part)
    return judge(ray.get([task.remote(number, *given) for number in range(count)]), plots=plots)
