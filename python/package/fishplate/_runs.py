"""Runs of a simulator as tasks of an engine."""

from __future__ import annotations

import functools
import hashlib
import os
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

from . import Task, _records
from ._tables import table as _table
from ._tables import wrong


@dataclass(frozen=True)
class Run:
    """A `Task` that can be sent to another process; the same attributes."""

    section: str
    start: float
    end: float
    speed: float | None
    columns: dict[str, str]
    settings: dict[str, float]
    shift: float

    @classmethod
    def of(cls, task: Task) -> Run:
        return cls(task.section, task.start, task.end, task.speed, dict(task.columns), dict(task.settings), task.shift)


def called(function: Callable[[Any], Any], run: Run) -> Any:
    """On a worker."""
    return function(run)


def simulator(
    run: Callable[[Run], Any], function: Callable[[Task], Any], keep: str | os.PathLike[str] | None, identity: str | None
) -> Callable[[Task], Any]:
    """A function from a task to a record, which hands the run to an engine, or takes its record from a folder."""
    if (keep is None) != (identity is None):
        raise wrong("identity", "`keep` and `identity` belong together", "the identity is a text that changes with the function")

    @functools.wraps(function)
    def simulated(task: Task) -> Any:
        asked = Run.of(task)
        if keep is None:
            return run(asked)
        key = hashlib.sha256(repr((identity, sorted(asdict(asked).items()))).encode()).hexdigest()
        file = os.path.join(os.fspath(keep), key[:2], f"{key}.arrow")
        if os.path.exists(file):
            with open(file, "rb") as kept:
                return _records.unpacked(kept.read())
        record = _records.arrow(_table(run(asked), "record"))
        os.makedirs(os.path.dirname(file), exist_ok=True)
        _keep(file, _records.packed(record))
        return record

    return simulated


def _keep(file: str, content: bytes) -> None:
    from ._engines import _keep as keep

    keep(file, content)
