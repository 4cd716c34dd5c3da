"""Errors carry their place and print as on the terminal; bad input never ends the process."""

import subprocess

import numpy
import pandas
import polars
import pyarrow
import pytest
from conftest import COACH, ROOT, small
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import fishplate

SLIP = 'protocol slip "A slip"\n  extends  en14363-2016-annex-t\n\nquantity ay_max\n  limit  std 0.4 kN\n'


def test_problems_of_a_protocol_have_their_place(tmp_path):
    (problem,) = fishplate.check(SLIP)
    assert (problem.code, problem.line, problem.column, problem.span.text) == ("unit-mismatch", 5, 14, "0.4 kN")
    assert problem.help == "write the limit in m/s^2" and problem.also[0].file.endswith("annex-t.fp")
    path = tmp_path / "slip.fp"
    path.write_text(SLIP)
    program = ROOT / "target" / "release" / "fishplate"
    if program.exists():
        told = subprocess.run([program, "check", path], capture_output=True, text=True).stderr
        assert str(fishplate.check(path)[0]) in told


def test_an_error_prints_as_on_the_terminal(coach):
    with pytest.raises(fishplate.Error) as caught:
        fishplate.certify(coach, SLIP)
    error = caught.value
    assert (error.code, error.line, error.column) == ("unit-mismatch", 5, 14)
    assert "^^^^^^ a force" in str(error) and "help: write the limit in m/s^2" in str(error)
    with pytest.raises(fishplate.Error) as caught:
        fishplate.certify(coach, "en14363-2016-anex-t")
    assert caught.value.help == "did you mean `en14363-2016-annex-t`?"
    with pytest.raises(fishplate.Error) as caught:
        fishplate.certify(coach, section_per_zone=3)
    assert "sections_per_zone" in str(caught.value)
    with pytest.raises(fishplate.Error) as caught:
        fishplate.certify(coach.parent / "coahc")
    assert caught.value.code == "folder-missing"


def reason(**changes):
    """Why the first section of a campaign is not used."""
    parts = small()
    for kind, change in changes.items():
        change(parts[kind]["S01"])
    result = fishplate.certify(fishplate.Campaign(**parts))
    row = result.sections.to_polars().row(0, named=True)
    assert not row["used"]
    return row["reason"]


def test_a_faulty_record_is_the_reason_of_its_section():
    def value(at, what):
        def change(record):
            record["Y_1R [kN]"] = record["Y_1R [kN]"].copy()
            record["Y_1R [kN]"][at] = what

        return change

    def column(made, name="Y_1R [kN]"):
        return lambda record: record.update({name: made})

    def renamed(record):
        record["Y_1R"] = record.pop("Y_1R [kN]")

    def in_metres(record):
        record["ay_I [m]"] = record.pop("ay_I [m/s^2]")

    assert "`NaN` is not a finite number" in reason(measurement=value(16, numpy.nan))
    assert "row 17" in reason(measurement=value(16, numpy.nan)) or ":17" in reason(measurement=value(16, numpy.nan))
    assert "not a finite number" in reason(simulation=value(0, numpy.inf))
    assert "holds text" in reason(measurement=column(["a"] * 1200))
    assert "has no unit" in reason(measurement=renamed)
    assert "is in m, which is a length" in reason(measurement=in_metres)


@pytest.mark.parametrize(
    ("record", "code"),
    [
        ({"time [s]": numpy.arange(3.0), "Y [kN]": numpy.arange(4.0)}, "unequal-lengths"),
        ({"time [s]": numpy.zeros((3, 2))}, "not-a-column"),
        ({"time [s]": numpy.array([1j, 2j])}, "not-a-number"),
        ({}, "file-empty"),
        ("not a table", "not-a-table"),
        (3, "not-a-table"),
        (None, "not-a-table"),
        ({"time [s]": [1.0, 2.0], "time [ms]": [1.0, 2.0]}, "duplicate-column"),
    ],
)
def test_what_is_no_record_is_told(record, code):
    parts = small()
    parts["measurement"]["S01"] = record
    with pytest.raises(fishplate.Error) as caught:
        fishplate.Campaign(**parts)
    assert caught.value.code == code, caught.value


def test_units_in_the_metadata_of_a_field():
    parts = small()
    expected = fishplate.certify(fishplate.Campaign(**parts)).summary.to_polars()

    def with_metadata(record):
        names = [name.removesuffix("]").split(" [") for name in record]
        fields = [pyarrow.field(name, pyarrow.float64(), metadata={"unit": unit}) for name, unit in names]
        return pyarrow.table(list(map(pyarrow.array, record.values())), schema=pyarrow.schema(fields))

    parts["measurement"] = {name: with_metadata(record) for name, record in parts["measurement"].items()}
    assert fishplate.certify(fishplate.Campaign(**parts)).summary.to_polars().equals(expected)
    parts["measurement"]["S01"] = pyarrow.table(
        [pyarrow.array([1.0])], schema=pyarrow.schema([pyarrow.field("Y_1R [kN]", pyarrow.float64(), metadata={"unit": "N"})])
    )
    with pytest.raises(fishplate.Error) as caught:
        fishplate.Campaign(**parts)
    assert caught.value.code == "unit-conflict"


def test_campaigns_that_are_wrong():
    cases = [
        ({"description": {"vehicle": "x.yaml"}}, "key-missing"),
        ({"vehicle": {"x": float("nan")}}, "not-writable"),
        ({"sections": {"section": ["S01", "S01"], "start [m]": [0, 1]}}, "duplicate-name"),
        ({"sections": polars.DataFrame({"section": ["../S01"]})}, "path-outside"),
        ({"sections": ""}, "file-empty"),
        ({"description": "name: x\nmeasurement: [measurement"}, None),
    ]
    for changes, code in cases:
        with pytest.raises(fishplate.Error) as caught:
            fishplate.Campaign(**small(**changes))
        assert code is None or caught.value.code == code, caught.value
    missing = small()
    del missing["measurement"]["S03"]
    told = fishplate.certify(fishplate.Campaign(**missing)).sections.to_polars()
    assert "measurement/S03" in told.row(2, named=True)["reason"]


def test_no_file_is_found_by_accident(tmp_path, monkeypatch):
    """A campaign in memory reads nothing from the working folder."""
    monkeypatch.chdir(COACH)
    parts = small()
    del parts["measurement"]["S03"]
    told = fishplate.certify(fishplate.Campaign(**parts)).sections.to_polars()
    assert not told.row(2, named=True)["used"]


def test_lists_of_numbers_and_jobs(coach):
    parts = small()
    parts["measurement"]["S01"] = {name: list(values) for name, values in parts["measurement"]["S01"].items()}
    assert fishplate.certify(fishplate.Campaign(**parts), jobs=1).verdict
    for jobs in (0, 10_000):
        with pytest.raises(fishplate.Error):
            fishplate.certify(coach, jobs=jobs)


KINDS = ["float64", "float32", "float16", "int64", "uint8", "bool", "complex128", "datetime64[s]", "U3", "object"]


@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_any_table_is_a_result_or_an_error(data):
    """Whatever is given in place of a record: a result, or `fishplate.Error`; never a panic, which would be another exception."""
    parts = small(count=4, rows=400)
    kind = data.draw(st.sampled_from(["measurement", "simulation"]))
    record = parts[kind]["S01"]
    column = data.draw(st.sampled_from(list(record)))
    rows = data.draw(st.sampled_from([0, 1, 2, 399, 400, 401]))
    numbers = st.sampled_from([0.0, -0.0, numpy.nan, numpy.inf, -numpy.inf, 1e308, -1e308, 5e-324, 1.0])
    made = numpy.full(rows, data.draw(numbers))
    dtype = data.draw(st.sampled_from(KINDS))
    with numpy.errstate(all="ignore"):
        try:
            made = made.astype(dtype)
        except (ValueError, TypeError, OverflowError):
            made = numpy.array([None] * rows, dtype=object)
    name = data.draw(st.sampled_from([column, column.split(" [")[0], "", " ", "x [", "[kN]", "a\0b [kN]", "Y_1R [µN]", "time [s]"]))
    del record[column]
    record[name] = made
    if data.draw(st.booleans()):
        record.update({other: values[:rows] for other, values in record.items() if len(values) > rows})
    form = data.draw(st.sampled_from([dict, pandas.DataFrame, polars.DataFrame, pyarrow.table]))
    try:
        parts[kind]["S01"] = form(record)
    except Exception:
        return  # the other library refuses it
    try:
        result = fishplate.certify(fishplate.Campaign(**parts))
        result.json(), result._repr_html_(), result.summary.to_polars()
    except fishplate.Error as error:
        assert str(error) and error.code != "internal", error


@settings(max_examples=60, deadline=None)
@given(st.text(max_size=200))
def test_any_text_is_checked(text):
    fishplate.check(text + "\n")
    try:
        fishplate.Campaign(text + "\n")
    except fishplate.Error as error:
        assert error.problems and error.code != "internal"


def test_objects_that_only_seem_to_speak_arrow():
    class Wrong:
        def __arrow_c_stream__(self, requested_schema=None):
            return self.given

    for given in (None, 3, object(), RuntimeError("no")):
        wrong = Wrong()
        wrong.given = given
        parts = small()
        parts["measurement"]["S01"] = wrong
        with pytest.raises((fishplate.Error, ValueError, TypeError)):
            fishplate.Campaign(**parts)
