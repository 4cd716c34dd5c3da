"""Fishplate: validation of simulation models of rail vehicles, from data frames to a verdict.

    >>> import fishplate
    >>> result = fishplate.certify("examples/coach")
    >>> result.verdict
    'not validated'

Campaigns are folders, or parts in memory (`Campaign`). Tables come and go as Arrow: polars, pandas and pyarrow share them without a copy.
"""

from __future__ import annotations

import json as _json
import os as _os
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from . import _fishplate, _records
from ._fishplate import TYPESETS, Report, Result, Table, Task, __version__
from ._tables import table as _table
from ._tables import wrong as _wrong
from .errors import Error, Problem, Span, Warning

__all__ = [
    "Campaign",
    "Error",
    "Problem",
    "Report",
    "Result",
    "Span",
    "Table",
    "Task",
    "Warning",
    "certify",
    "check",
    "compare",
    "diagnose",
    "judge",
    "protocols",
    "read",
    "reduce",
    "study",
    "__version__",
]


class Campaign:
    """A campaign: a folder, or parts in memory.

    description
        The folder of a campaign; or what `campaign.yaml` says: its text, a dict of its keys, or only the name.
    vehicle
        What `vehicle.yaml` says: its text, or a dict.
    sections
        The table of sections: a data frame, a dict of arrays, or the text of `sections.csv`.
    measurement, simulation, track
        Dicts from section to record: a data frame, an Arrow table, a dict of arrays, or what `read` returns. Or one data frame with the
        rows of all sections and a column `section`; it may be a data frame of Spark, Dask or Ray, for `certify` of that engine.
        Several simulations: a dict from name to such a dict or data frame. The unit stands in the name of the column, `"Y_1R [kN]"`, or in the metadata of its field under `unit`.

    With a folder, the parts that are given take the place of its files.
    """

    def __init__(
        self,
        description: str | _os.PathLike[str] | Mapping[str, Any],
        *,
        vehicle: str | Mapping[str, Any] | None = None,
        sections: Any = None,
        measurement: Any = None,
        simulation: Any = None,
        track: Any = None,
    ) -> None:
        folder, keys, text = _described(description)
        texts: dict[str, bytes] = {}
        records: dict[str, Any] = {}
        if vehicle is not None:
            keys.setdefault("vehicle", "vehicle.yaml")
            texts["vehicle.yaml"] = _yaml(vehicle, "vehicle")
        if sections is not None:
            keys.setdefault("sections", "sections.csv")
            given = sections.encode() if isinstance(sections, str) else _fishplate.csv(_table(sections, "sections"))
            texts["sections.csv"] = given
        named: list[tuple[str, Any]] = []
        for kind, of_sections in (("measurement", measurement), ("simulation", simulation), ("track", track)):
            if of_sections is None:
                continue
            nested = isinstance(of_sections, Mapping) and bool(of_sections) and all(_is_records(one) for one in of_sections.values())
            keys.setdefault(kind, {str(name): f"{kind}/{name}" for name in of_sections} if nested else kind)
            named += [(f"{kind}/{name}", one) for name, one in of_sections.items()] if nested else [(kind, of_sections)]
        if folder is None:
            texts["campaign.yaml"] = text if text is not None else _yaml(keys, "campaign")
        frames: dict[str, Any] = {}
        for path, all_records in named:
            if not isinstance(all_records, Mapping):
                if not _records.is_long(all_records):
                    raise _wrong("not-records", f"`{path}` is neither a dict of records nor a data frame with a column `section`")
                if _records.of_engine(all_records):
                    frames[path] = all_records
                    continue
                all_records = _records.by_section(all_records, _fishplate.Campaign.of(folder, texts, {}).sections)
            for section, record in all_records.items():
                records[f"{path}/{section}"] = _table(record, f"{path}/{section}")
        self._given = (folder, texts, records, frames)
        self._inner = _fishplate.Campaign.of(folder, texts, records)

    @classmethod
    def _of(cls, folder: str | None, texts: dict[str, bytes], records: dict[str, Any]) -> Campaign:
        """From parts by their paths."""
        made = cls.__new__(cls)
        made._given = (folder, texts, records, {})
        made._inner = _fishplate.Campaign.of(folder, texts, records)
        return made

    @property
    def name(self) -> str:
        return self._inner.name

    @property
    def sections(self) -> list[str]:
        """The names of the sections."""
        return self._inner.sections

    def __repr__(self) -> str:
        return repr(self._inner)


def _described(description: Any) -> tuple[str | None, dict[str, Any], bytes | None]:
    """The folder, or the keys, or the text."""
    if isinstance(description, Mapping):
        return None, dict(description), None
    if isinstance(description, str) and "\n" in description:
        return None, {}, description.encode()
    path = _os.fspath(description)
    if isinstance(description, str) and not _os.path.exists(path) and not {"/", "\\"} & set(path):
        return None, {"name": description}, None
    return path, {}, None


def _is_records(one: Any) -> bool:
    """Whether a value has the records of many sections: a dict of records, where a record has arrays; or a table with their names."""
    if not isinstance(one, Mapping):
        return _records.is_long(one)
    return isinstance(one, Mapping) and bool(one) and all(isinstance(record, (Mapping, Table)) or _speaks(record) for record in one.values())


def _speaks(record: Any) -> bool:
    return hasattr(record, "columns") or hasattr(record, "column_names")


def _yaml(value: str | Mapping[str, Any], what: str) -> bytes:
    if isinstance(value, str):
        return value.encode()
    try:
        # JSON is YAML.
        return (_json.dumps(value, ensure_ascii=False, allow_nan=False, indent=2, default=_scalar) + "\n").encode()
    except (TypeError, ValueError) as error:
        raise _wrong("not-writable", f"the {what} cannot be written as YAML: {error}") from None


def _scalar(value: Any) -> Any:
    item = getattr(value, "item", None)  # numbers of numpy
    if item is not None:
        return item()
    return str(value)


def _campaigns(given: Any) -> list[_fishplate.Campaign]:
    one = isinstance(given, (str, _os.PathLike, Campaign, Mapping))
    opened = [each if isinstance(each, Campaign) else Campaign(_existing(each)) for each in ([given] if one else given)]
    if not opened:
        raise _wrong("no-campaign", "no campaign is given")
    for each in opened:
        if each._given[3]:
            says = f"the records of {each.name!r} are in a data frame of an engine"
            raise _wrong("not-here", says, "use `certify` of that engine, such as `fishplate.spark.certify`")
    return [each._inner for each in opened]


def _existing(given: Any) -> Any:
    # A name without records would be a campaign in memory without any: a path was meant.
    return _os.path.join(".", given) if isinstance(given, str) and "\n" not in given and not _os.path.isabs(given) else given


def _asked(protocol: str | _os.PathLike[str] | None) -> dict[str, str | None] | None:
    return None if protocol is None else _named(protocol)


def _named(protocol: str | _os.PathLike[str]) -> dict[str, str | None]:
    text = _os.fspath(protocol)
    return {"name": None, "text": text} if "\n" in text else {"name": text, "text": None}


def _set(parameters: Mapping[str, Any]) -> list[str]:
    return [f"{name}={value}" for name, value in parameters.items()]


def protocols() -> list[str]:
    """The names of the shipped protocols."""
    return _fishplate.shipped()


def check(protocol: str | _os.PathLike[str]) -> list[Problem]:
    """Every problem of a protocol: a text, a path, or the name of a shipped one. An empty list: it is fine."""
    return _fishplate.check_protocol(_asked(protocol))


def read(path: str | _os.PathLike[str]) -> Table:
    """A record file as it is. A campaign that uses the table as a record names the file and its hash in its results."""
    return _fishplate.read_record(_os.fspath(path))


def certify(
    campaign: Any,
    protocol: str | _os.PathLike[str] | None = None,
    *,
    plots: int = 8,
    jobs: int | None = None,
    **parameters: Any,
) -> Result:
    """Evaluates a protocol on a campaign, or on several as one.

    The protocol is a name, a path or a text; without one it is that of the campaign, else EN 14363 Annex T. Other keywords set its
    parameters: `sections_per_zone=5`, `lowpass_frequency="15 Hz"`.
    """
    return _fishplate.certify(_campaigns(campaign), _asked(protocol), _set(parameters), plots, jobs)


def reduce(
    campaign: Any,
    protocol: str | _os.PathLike[str] | None = None,
    *,
    shard: tuple[int, int] = (0, 1),
    plots: bool = True,
    jobs: int | None = None,
    **parameters: Any,
) -> bytes:
    """The values of a part of the sections: part `shard[0]`, counted from 0, of `shard[1]`. The bytes are those of a Parquet file."""
    return _fishplate.reduce(_campaigns(campaign), _asked(protocol), _set(parameters), shard, plots, jobs)


def judge(parts: Iterable[bytes | str | _os.PathLike[str]], *, plots: int = 8) -> Result:
    """The result of all parts, in any order: bytes that `reduce` returned, or files of them. The same as `certify` of the whole."""
    given = []
    for number, part in enumerate(parts):
        if isinstance(part, bytes):
            given.append((f"part {number + 1}", part))
        else:
            with open(part, "rb") as file:
                given.append((_os.fspath(part), file.read()))
    if not given:
        raise _wrong("no-values", "no part is given")
    return _fishplate.judge(given, plots)


def study(
    campaign: Any,
    kind: str = "sections",
    protocol: str | _os.PathLike[str] | None = None,
    *,
    offsets: Iterable[float] = (-40, -20, -10, -5, -1, 1, 5, 10, 20, 40),
    farthest: float = 25.0,
    correct: bool = False,
    vary: Mapping[str, Iterable[Any]] | None = None,
    take: int | None = None,
    reduce: int | None = None,
    enumerate: float | None = None,
    width: float = 0.01,
    draws: int | None = None,
    seed: int = 1,
    jobs: int | None = None,
    **parameters: Any,
) -> Report:
    """How the verdict depends on the `sections`, on the synchronisation (`sync`), or on `parameters` and rules of the protocol (`vary`).

    `margin`: the smallest changes that flip it; with uncertainties in campaign.yaml, from `draws`, the probability that it is right.
    """
    kinds = ("sections", "sync", "parameters", "margin")
    if kind not in kinds:
        raise _wrong("kind", f"`{kind}` is no kind of study", f"known here: {', '.join(kinds)}")
    if draws is not None and draws < 0:
        raise _wrong("range", "`draws` must not be negative")
    if not 0 < width < 1 or not farthest > 0:
        raise _wrong("range", "`width` must be between 0 and 1, and `farthest` above 0")
    studied = {
        "kind": kind,
        "offsets": [float(offset) for offset in offsets],
        "farthest": float(farthest),
        "correct": correct,
        "vary": [(name, [str(value) for value in values]) for name, values in (vary or {}).items()],
        "take": take,
        "reduce": reduce,
        "most": enumerate,
        "width": width,
        "draws": draws,
        "seed": seed,
    }
    return _fishplate.study(_campaigns(campaign), _asked(protocol), _set(parameters), studied, jobs)


def compare(
    campaigns: Any,
    protocols: Iterable[str | _os.PathLike[str]],
    *,
    sizes: Iterable[float] | None = None,
    jobs: int | None = None,
    **parameters: Any,
) -> Report:
    """Protocols side by side over campaigns: verdicts, agreement, sensitivity to disturbances of the given sizes, differences."""
    given = None if sizes is None else [float(size) for size in sizes]
    if given and not all(0 < size <= 1 for size in given):
        raise _wrong("sizes", "each size must be above 0 and at most 1")
    asked = [_named(protocol) for protocol in protocols]
    if not asked:
        raise _wrong("no-protocol", "no protocol is given")
    sets = [(name, str(value)) for name, value in parameters.items()]
    return _fishplate.compare(_campaigns(campaigns), asked, sets, given, jobs)


def diagnose(
    campaign: Any,
    protocol: str | _os.PathLike[str] | None = None,
    catalogue: str | _os.PathLike[str] = "bogie-vehicle",
    simulator: Callable[[Task], Any] | None = None,
    *,
    simulator_name: str | None = None,
    seed: int = 1,
    jobs: int | None = None,
    **parameters: Any,
) -> Report:
    """Locates the differences of simulation and measurement, and identifies the effects of a catalogue that cause them.

    `simulator` is a function from a `Task` to a record: a data frame or a dict of arrays with `time [s]` and, if the axis is a distance,
    `distance [m]`. It is called from several threads, one after the other where it holds the interpreter. `simulator_name` is the name
    under which the catalogue lists its parameters; without one, the name of the function. Without a function, the reference vehicle
    model simulates.
    """
    one = _campaigns(campaign)
    if len(one) != 1:
        raise _wrong("several-campaigns", "a diagnosis takes one campaign")
    name = simulator_name or getattr(simulator, "__name__", "simulator")
    simulates = {"function": simulator, "convert": lambda made: _table(made, f"the record of {name}"), "name": name}
    return _fishplate.diagnose(one[0], _asked(protocol), _os.fspath(catalogue), simulates, _set(parameters), seed, jobs)

