"""Records in memory, or in the data frames of an engine, on their way to the workers: cut to sections, as Arrow."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from . import _fishplate
from ._tables import table as _table
from ._tables import wrong

#: The column of a table of many records that says of which section a row is.
SECTION = "section"
#: The columns of a table of pieces: the part of the sections, the path of the record, whether its rows are in order, and these.
PIECES = ("part", "record", "ordered", "rows")
#: The axes by which the rows of a record are put in order, the first that is there.
AXES = ("time", "distance")


def of_engine(data: Any) -> str | None:
    """The engine to which a data frame belongs: its rows need not be in this process."""
    module = type(data).__module__
    for engine, prefix in (("spark", "pyspark."), ("dask", "dask."), ("dask", "dask_expr."), ("ray", "ray.")):
        if module.startswith(prefix):
            return engine
    return None


def columns(data: Any) -> list[str] | None:
    """The names of the columns of a table of any kind; nothing for what is no table."""
    if of_engine(data) == "ray":
        return list(data.schema().names)
    named = getattr(data, "column_names", None)
    if named is None:
        named = getattr(data, "columns", None)
    return None if named is None or isinstance(data, Mapping) else [str(name) for name in named]


def is_long(data: Any) -> bool:
    """Whether a table has the records of many sections."""
    return SECTION in (columns(data) or ())


def by_section(data: Any, sections: list[str]) -> dict[str, Any]:
    """The records of a table of many, by section."""
    whole = _rows(data)
    found = _by_section(whole, set(sections))
    empty = whole.schema.empty_table().drop_columns([SECTION])
    return {section: in_order(found.get(section, empty)) for section in sections}


def arrow(data: Any) -> Any:
    import pyarrow

    return data if isinstance(data, pyarrow.Table) else pyarrow.table(data)


def _rows(data: Any) -> Any:
    """The columns of a table of many records. The index of pandas numbers the rows of all, which is no channel."""
    import pyarrow

    if type(data).__module__.startswith("pandas"):
        return pyarrow.Table.from_pandas(data, preserve_index=False)
    return arrow(_table(data, "records"))


def _by_section(whole: Any, wanted: Any) -> dict[str, Any]:
    import pyarrow.compute as compute

    names = whole.column(SECTION).cast("string")
    rest = whole.drop_columns([SECTION])
    return {name: rest.filter(compute.equal(names, name)) for name in names.unique().to_pylist() if name in wanted}


def in_order(record: Any) -> Any:
    """Engines keep no order of rows."""
    for axis in AXES:
        for name in record.column_names:
            if name.split("[")[0].strip() == axis:
                return record.sort_by(name)
    return record


def packed(record: Any) -> bytes:
    import pyarrow

    sink = pyarrow.BufferOutputStream()
    with pyarrow.ipc.new_stream(sink, record.schema) as stream:
        stream.write_table(record)
    return bytes(sink.getvalue())


def unpacked(content: bytes) -> Any:
    import pyarrow

    return pyarrow.ipc.open_stream(content).read_all()


@dataclass(frozen=True)
class Bare:
    """A campaign without its records. Of each record it has the columns: a position counts that was recorded anywhere."""

    folder: str | None
    texts: dict[str, bytes]
    #: For each record its path, the file it was read from, and the number of its columns among `schemas`.
    records: dict[str, tuple[tuple[str, str, int] | None, int]]
    schemas: list[bytes]

    def with_records(self, given: Mapping[str, tuple[Any, list[bytes]]]) -> Any:
        """The campaign with the records of one part, whose pieces are given by path; whether they are in order: of a file."""
        import pyarrow

        from . import Campaign

        empty = [unpacked(schema) for schema in self.schemas]
        records: dict[str, Any] = {}
        for path, (file, schema) in self.records.items():
            record, pieces = empty[schema], given.get(path)
            if pieces is not None:
                ordered, content = pieces
                record = pyarrow.concat_tables([unpacked(piece) for piece in content])
                record = record if ordered else in_order(record)
            records[path] = record if file is None else _fishplate.read_elsewhere(record, file)
        return Campaign._of(self.folder, self.texts, records)

    def hash(self, seen: Any, pieces: Any) -> None:
        seen.update(repr((self.folder, sorted(self.texts.items()), self.schemas)).encode())
        for piece in pieces.to_pylist() if pieces is not None else []:
            seen.update(repr(tuple(piece.values())).encode())


def places(campaign: Any, count: int) -> dict[str, list[int]]:
    """The parts that need the records of each section: its own, and those of sections that repeat it."""
    names = campaign.sections
    of_part = {at: number for number in range(count) for at in range(*_range(number, count, len(names)))}
    found: dict[str, list[int]] = {name: [of_part[at]] for at, name in enumerate(names)}
    for at, original in enumerate(campaign._inner.originals):
        if original is not None and of_part[at] not in found[names[original]]:
            found[names[original]].append(of_part[at])
    return found


def _range(number: int, count: int, sections: int) -> tuple[int, int]:
    """The sections of a part, as `reduce` counts them."""
    return number * sections // count, (number + 1) * sections // count


def split(campaign: Any, places: Mapping[str, list[int]]) -> tuple[Bare, Any, dict[str, Any]]:
    """A campaign without records; its records in memory as pieces; and those that are data frames of an engine, by kind."""
    folder, texts, records, frames = campaign._given
    known: dict[str, tuple[tuple[str, str, int] | None, int]] = {}
    schemas: list[bytes] = []

    def schema(of: Any) -> int:
        made = packed(of.empty_table())
        if made not in schemas:
            schemas.append(made)
        return schemas.index(made)

    made = []
    for path, record in records.items():
        file = record._file if isinstance(record, _fishplate.Table) else None
        whole = arrow(record)
        known[path] = (file, schema(whole.schema))
        made += [(number, path, whole) for number in places.get(path.rsplit("/", 1)[-1], ())]
    for path, frame in frames.items():
        import pyarrow

        named = pyarrow.schema([(name, pyarrow.float64()) for name in columns(frame) or () if name != SECTION])
        at = schema(named)
        known |= {f"{path}/{section}": (None, at) for section in places}
    rows = [(number, path, True, packed(whole)) for number, path, whole in made]
    return Bare(folder, texts, known, schemas), pieces_table(rows) if rows else None, frames


def pieces_schema() -> Any:
    import pyarrow

    kinds = (pyarrow.int32(), pyarrow.string(), pyarrow.bool_(), pyarrow.large_binary())
    return pyarrow.schema(list(zip(PIECES, kinds)))


def pieces_table(rows: list[tuple[int, str, bool, bytes]]) -> Any:
    import pyarrow

    arrays = [pyarrow.array([row[at] for row in rows], kind.type) for at, kind in enumerate(pieces_schema())]
    return pyarrow.Table.from_arrays(arrays, schema=pieces_schema())


def cut(rows: Any, path: str, places: Mapping[str, list[int]]) -> Any:
    """Rows of a table of many records as pieces: for each part and section the rows that it needs."""
    found = _by_section(_rows(rows), places)
    made = [(number, f"{path}/{section}", False, packed(piece)) for section, piece in found.items() for number in places[section]]
    return pieces_table(made)


def gathered(pieces: Any) -> dict[int, dict[str, tuple[bool, list[bytes]]]]:
    """The pieces of each part by record."""
    parts: dict[int, dict[str, tuple[bool, list[bytes]]]] = {}
    for piece in pieces.to_pylist():
        number, path, ordered, rows = (piece[name] for name in PIECES)
        parts.setdefault(number, {}).setdefault(path, (ordered, []))[1].append(rows)
    return parts
