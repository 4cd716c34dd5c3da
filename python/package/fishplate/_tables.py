"""Tables of any kind as something that speaks Arrow."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ._fishplate import from_arrays
from .errors import Error, Problem


def wrong(code: str, message: str, help: str | None = None) -> Error:
    text = f"error[{code}]: {message}" + (f"\n  |\n  = help: {help}" if help else "")
    return Error([Problem("error", code, message, None, [], help, text)])


def table(data: Any, name: str) -> Any:
    """A data frame, an Arrow table, a structured array, or a dict of names and arrays."""
    if hasattr(data, "__arrow_c_stream__") or hasattr(data, "__arrow_c_array__"):
        # Names pass to another library as C strings: polars ends the process where one has a zero byte.
        columns: Any = getattr(data, "column_names", None)
        columns = getattr(data, "columns", ()) if columns is None else columns
        for column in columns:
            if isinstance(column, str):
                _checked(column, name)
        return data
    if isinstance(data, Mapping):
        return from_arrays([_checked(str(key), name) for key in data], [_array(value, str(key), name) for key, value in data.items()])
    fields = getattr(getattr(data, "dtype", None), "names", None)
    if fields:
        return from_arrays([_checked(field, name) for field in fields], [_array(data[field], field, name) for field in fields])
    # Data frames of libraries that do not speak Arrow yet.
    if hasattr(data, "columns") and hasattr(data, "to_dict"):
        return table({column: data[column].to_numpy() for column in data.columns}, name)
    raise wrong(
        "not-a-table",
        f"`{name}` is {type(data).__name__}, which is no table",
        "give a data frame, an Arrow table, or a dict of names and arrays",
    )


def _checked(column: str, name: str) -> str:
    if "\0" in column:
        raise wrong("name-invalid", f"`{name}`: the name of the column {column!r} contains a zero byte")
    return column


def _array(values: Any, column: str, name: str) -> Any:
    if hasattr(values, "__arrow_c_array__") or hasattr(values, "__arrow_c_stream__"):
        chunks = getattr(values, "combine_chunks", None)  # pyarrow.ChunkedArray
        if chunks is not None:
            return chunks()
        if hasattr(values, "__arrow_c_array__"):
            return values
        values = values.to_numpy()
    try:
        import numpy
    except ImportError:
        return list(values)
    try:
        array = numpy.asarray(values)
    except ValueError as error:
        raise wrong("not-a-number", f"`{name}`: the column `{column}` is no array: {error}") from None
    if array.ndim != 1:
        raise wrong("not-a-column", f"`{name}`: the column `{column}` has {array.ndim} dimensions instead of one")
    if array.dtype.kind in "fiu":
        return numpy.ascontiguousarray(array, dtype="float64")
    if array.dtype.kind == "b":
        return [str(bool(value)).lower() for value in array]
    if array.dtype.kind == "c":
        raise wrong("not-a-number", f"`{name}`: the column `{column}` holds complex numbers", "give the real part")
    if array.dtype.kind == "O" and len(array) and all(_number(value) for value in array):
        return numpy.ascontiguousarray(array, dtype="float64")
    return [None if value is None or value != value else str(value) for value in array]


def _number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)
