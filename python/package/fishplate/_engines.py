"""What the launchers of engines share. The work item is `reduce` of one part of the sections; `judge` puts the parts together."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

from ._tables import wrong

#: How often a part is tried again where a worker was lost.
RETRIES = 3


def parts(shards: int | None, workers: int) -> int:
    """The number of parts: a few for each worker, so that a slow one does not keep the others waiting."""
    if shards is None:
        return max(1, 4 * workers)
    if shards < 1:
        raise wrong("shards", f"shards = {shards} is no number of parts")
    return shards


def folders(campaign: Any) -> list[str]:
    """The folders of the campaigns, as every worker sees them."""
    given = [campaign] if isinstance(campaign, (str, os.PathLike)) else list(campaign)
    if not all(isinstance(one, (str, os.PathLike)) for one in given):
        raise wrong("not-shared", "an engine takes campaign folders, which all its workers see", "write the records to a folder")
    return [os.path.abspath(one) for one in given]


def asked(protocol: str | os.PathLike[str] | None) -> str | None:
    """A protocol as every worker gets it: the text of a file, which need not be there for the workers."""
    if protocol is None:
        return None
    name = os.fspath(protocol)
    return os.path.abspath(name) if "\n" not in name and os.path.exists(name) else name


def part(
    number: int, shards: int, campaigns: list[str], protocol: str | None, parameters: Mapping[str, Any], plots: bool
) -> bytes:
    """The values of one part of the sections. One thread: the engine runs one such task on each core."""
    import fishplate

    return fishplate.reduce(campaigns, protocol, shard=(number, shards), plots=plots, jobs=1, **parameters)
