"""What the launchers of engines share. The work item is `reduce` of one part of the sections; `judge` puts the parts together."""

from __future__ import annotations

import hashlib
import os
import pickle
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from . import Campaign, Result, __version__, _records, judge
from ._tables import wrong
from .errors import Error, Warning

#: How often a part is tried again where a worker was lost.
RETRIES = 3


@dataclass(frozen=True)
class Work:
    """What each worker is told, whatever its part."""

    #: Number of parts.
    count: int
    #: Folders that all workers see; or a campaign without its records, which come with each part.
    campaign: list[str] | _records.Bare
    protocol: str | None
    parameters: dict[str, Any]
    plots: bool
    #: Where the values of each part are kept, in a folder that all workers see.
    keep: str | None
    version: str = __version__

    def file(self, number: int) -> str | None:
        return None if self.keep is None else os.path.join(self.keep, f"values-{number}-of-{self.count}.parquet")


def part(number: int, work: Work, records: Any = None) -> bytes:
    """The values of one part of the sections. One thread: the engine runs one such task on each core."""
    import fishplate

    if fishplate.__version__ != work.version:
        raise wrong(
            "values-version",
            f"a worker has fishplate {fishplate.__version__}, the caller {work.version}",
            "install the same version on all workers",
        )
    file = work.file(number)
    if file is not None and os.path.exists(file):
        with open(file, "rb") as kept:
            return kept.read()
    given = work.campaign if isinstance(work.campaign, list) else [work.campaign.with_records(records)]
    made = fishplate.reduce(given, work.protocol, shard=(number, work.count), plots=work.plots, jobs=1, **work.parameters)
    if file is not None:
        _keep(file, made)
    return made


def picked(cut: Mapping[int, Any], number: int) -> Any:
    """The pieces of a part among those of a block of rows."""
    return cut.get(number, {})


def of_pieces(number: int, work: Work, *pieces: Mapping[str, tuple[bool, list[bytes]]]) -> bytes:
    """As `part`, of pieces of records that were cut by several tasks."""
    found: dict[str, tuple[bool, list[bytes]]] = {}
    for some in pieces:
        for path, (ordered, rows) in some.items():
            found.setdefault(path, (ordered, []))[1].extend(rows)
    return part(number, work, found)


def _keep(file: str, content: bytes) -> None:
    """A file is there whole or not at all, also if two workers make it."""
    unfinished = f"{file}.{os.getpid()}-{os.urandom(4).hex()}"
    with open(unfinished, "wb") as out:
        out.write(content)
    os.replace(unfinished, file)


@dataclass
class Job:
    """A campaign in parts, and what has come back of them."""

    work: Work
    #: Records in the memory of the caller, cut to parts; records that an engine has.
    pieces: Any = None
    frames: dict[str, Any] = field(default_factory=dict)
    places: dict[str, list[int]] = field(default_factory=dict)
    made: dict[int, bytes] = field(default_factory=dict)
    failed: dict[int, BaseException] = field(default_factory=dict)

    @classmethod
    def of(
        cls,
        campaign: Any,
        protocol: str | os.PathLike[str] | None,
        parameters: Mapping[str, Any],
        *,
        shards: int | None,
        workers: int,
        plots: int,
        keep: str | os.PathLike[str] | None,
    ) -> Job:
        # A few parts for each worker, so that a slow one does not keep the others waiting.
        count = max(1, 4 * workers) if shards is None else shards
        if count < 1:
            raise wrong("shards", f"shards = {shards} is no number of parts")
        pieces: Any = None
        frames: dict[str, Any] = {}
        places: dict[str, list[int]] = {}
        given: list[str] | _records.Bare
        if isinstance(campaign, Campaign):
            places = _records.places(campaign, count)
            given, pieces, frames = _records.split(campaign, places)
        else:
            given = _folders(campaign)
        work = Work(count, given, _asked(protocol), dict(parameters), plots > 0, None)
        if keep is not None:
            if frames:
                raise wrong("not-kept", "`keep` needs records in files or in the memory of the caller", "write the records to a folder")
            work = Work(count, given, work.protocol, work.parameters, work.plots, _folder(keep, work, pieces))
        job = cls(work, pieces, frames, places)
        for number in range(count):
            file = work.file(number)
            if file is not None and os.path.exists(file):
                job.made[number] = part(number, work)
        return job

    @property
    def open(self) -> list[int]:
        """The parts that are still to be made."""
        return [number for number in range(self.work.count) if number not in self.made]

    def attempt(self, number: int, make: Any) -> None:
        """Takes what a part came to. A fault of the campaign as a whole ends the job; a part that is lost does not."""
        try:
            self.made[number] = make()
            self.failed.pop(number, None)
        except Error:
            raise
        except Exception as error:
            self.failed[number] = error

    def kept(self) -> bool:
        """After an engine has given up: whether parts were kept. The others are lost."""
        for number in self.open:
            file = self.work.file(number)
            if file is not None and os.path.exists(file):
                self.made[number] = part(number, self.work)
            else:
                self.failed[number] = RuntimeError("the engine gave up")
        return bool(self.made)

    def result(self, plots: int) -> Result:
        """The result of the parts that were made; the others are told."""
        for number in self.open if self.pieces is not None or self.frames else []:
            # No record came for this part: each of its sections says so.
            if number not in self.failed:
                self.made[number] = part(number, self.work, {})
        if not self.made:
            raise next(iter(self.failed.values()))
        for number, error in sorted(self.failed.items()):
            says = f"part {number} of {self.work.count} could not be made: {type(error).__name__}: {error}"
            warnings.warn(Warning(says), stacklevel=3)
        return judge([self.made[number] for number in sorted(self.made)], plots=plots)


def rows(made: Iterator[tuple[int, bytes | None, bytes | None]], job: Job) -> None:
    """Takes parts from an engine that returns a table: number, values, pickled error."""
    for number, values, error in made:

        def value(values: bytes | None = values, error: bytes | None = error) -> bytes:
            if error is not None:
                raise pickle.loads(error)
            return bytes(values or b"")

        job.attempt(number, value)


def row(number: int, work: Work, records: Any = None) -> tuple[int, bytes | None, bytes | None]:
    """A part as a row of such a table: an error of one part does not end the job of the others."""
    try:
        return number, part(number, work, records), None
    except Exception as error:
        try:
            return number, None, pickle.dumps(error)
        except Exception:
            return number, None, pickle.dumps(RuntimeError(f"{type(error).__name__}: {error}"))


def _folders(campaign: Any) -> list[str]:
    """The folders of the campaigns, as every worker sees them."""
    given = [campaign] if isinstance(campaign, (str, os.PathLike)) else list(campaign)
    if not all(isinstance(one, (str, os.PathLike)) for one in given):
        raise wrong("not-shared", "an engine takes campaign folders, or one campaign in memory", "write the records to a folder")
    return [os.path.abspath(one) for one in given]


def _asked(protocol: str | os.PathLike[str] | None) -> str | None:
    """A protocol as every worker gets it: an absolute path, or what was given."""
    if protocol is None:
        return None
    name = os.fspath(protocol)
    return os.path.abspath(name) if "\n" not in name and os.path.exists(name) else name


def _folder(keep: str | os.PathLike[str], work: Work, pieces: Any) -> str:
    """The folder for the values of this work: another one for other rules or records, so that no old values are taken.

    A file of records counts as the same while its size and its time of change are the same.
    """
    seen = hashlib.sha256(repr((work.version, work.count, work.protocol, sorted(work.parameters.items()), work.plots)).encode())
    if work.protocol is not None and os.path.isfile(work.protocol):
        with open(work.protocol, "rb") as file:
            seen.update(file.read())
    if isinstance(work.campaign, list):
        for top in work.campaign:
            for folder, folders, names in os.walk(top):
                folders.sort()
                for name in sorted(names):
                    path = os.path.join(folder, name)
                    state = os.stat(path)
                    seen.update(repr((path, state.st_size, state.st_mtime_ns)).encode())
    else:
        work.campaign.hash(seen, pieces)
    folder = os.path.join(os.path.abspath(keep), seen.hexdigest()[:16])
    os.makedirs(folder, exist_ok=True)
    return folder
