"""A campaign in memory gives what the same campaign gives from files."""

import json
import subprocess
import threading
import time

import pandas
import polars
import pyarrow
import pytest
from conftest import COACH, ROOT, as_numpy, as_pandas, as_polars, in_memory, small

import fishplate


@pytest.fixture(scope="module")
def from_files(coach):
    return fishplate.certify(coach)


def test_tables_that_were_read_give_the_same_bytes(from_files):
    assert fishplate.certify(in_memory()).json() == from_files.json()


@pytest.mark.parametrize("convert", [as_numpy, as_pandas, as_polars, lambda table: table.to_pyarrow()])
def test_arrays_give_the_same_numbers(from_files, convert):
    """All bytes but the entries of the record files: arrays have the hash of their numbers, not that of a file."""

    def without_records(result):
        results = json.loads(result.json())
        files = results["campaign"]["files"]
        results["campaign"]["files"] = [file for file in files if file["record"] is None]
        return len(files), json.dumps(results)

    assert without_records(fishplate.certify(in_memory(convert=convert))) == without_records(from_files)


def test_how_arrays_lie_in_memory_does_not_matter():
    def halves(table):
        whole = table.to_pyarrow()
        at = whole.num_rows // 3
        return pyarrow.concat_tables([whole.slice(0, at), whole.slice(at)])

    one = fishplate.certify(in_memory(convert=halves)).json()
    assert one == fishplate.certify(in_memory(convert=as_polars)).json()
    assert one == fishplate.certify(in_memory(convert=as_numpy)).json()


def test_parts_of_a_folder_are_replaced(from_files, coach):
    kept = fishplate.Campaign(coach, sections=(coach / "sections.csv").read_text())
    assert fishplate.certify(kept).json() == from_files.json()
    fewer = polars.read_csv(coach / "sections.csv").head(12)
    assert fishplate.Campaign(coach, sections=fewer).sections == fewer["section"].to_list()


def test_the_files_of_the_command(from_files, tmp_path, coach):
    program = ROOT / "target" / "release" / "fishplate"
    if not program.exists():
        pytest.skip("the program is not built")
    command = [program, "certify", coach, "--out", tmp_path / "command", "--only", "html", "--quiet"]
    assert subprocess.run(command).returncode == 1
    from_files.write(tmp_path / "python", pdf=False)
    files = {path.relative_to(tmp_path / "command") for path in (tmp_path / "command").rglob("*") if path.is_file()}
    assert len(files) > 5
    for file in files:
        assert (tmp_path / "command" / file).read_bytes() == (tmp_path / "python" / file).read_bytes(), file


def test_a_report_as_pdf_needs_the_typesetter(from_files, tmp_path, coach):
    """The wheel has no typesetter unless it was asked for (`--features typeset`)."""
    if not fishplate.TYPESETS:
        with pytest.raises(fishplate.Error, match="without the typesetter"):
            from_files.write(tmp_path / "asked", pdf=True)
        assert not (tmp_path / "asked").exists()
        from_files.write(tmp_path / "default")
        assert not (tmp_path / "default" / "report.pdf").exists()
        return
    from_files.write(tmp_path / "default")
    pdf = (tmp_path / "default" / "report.pdf").read_bytes()
    assert pdf.startswith(b"%PDF-") and len(pdf) > 100_000
    program = ROOT / "target" / "release" / "fishplate"
    if not program.exists():
        pytest.skip("the program is not built")
    command = [program, "certify", coach, "--out", tmp_path / "command", "--quiet"]
    assert subprocess.run(command).returncode == 1
    assert (tmp_path / "command" / "report.pdf").read_bytes() == pdf


def test_the_result(from_files):
    assert (from_files.verdict, from_files.holds) == ("not validated", False)
    results = json.loads(from_files.json())
    assert from_files.provisional == [value["name"] for value in results["provisional"]] != []
    assert from_files.reasons == ["YQ_qst: mean 0.0609 exceeds the limit 0.0467 by 30 %"]
    summary = from_files.summary.to_polars()
    row = summary.filter((polars.col("quantity") == "YQ_qst") & ~polars.col("holds"))
    assert row["value"].round(4).to_list() == [0.0609]
    assert len(from_files.values) == len(pandas.DataFrame(from_files.values.to_pandas()))
    assert from_files.sections.to_polars()["used"].all()
    assert dict(from_files.tables())["summary"].num_rows == summary.height
    assert "<svg" in from_files.figures["overview"]
    with pytest.raises(TypeError, match="holds"):
        bool(from_files)


def test_arrow_shares_its_buffers(from_files):
    address = lambda table: table.column("difference").chunk(0).buffers()[1].address
    values = from_files.values
    assert address(values.to_pyarrow()) == address(pyarrow.table(values))


def test_a_protocol_as_a_text_and_parameters(coach):
    variant = 'protocol mine "Stricter"\n  extends  en14363-2016-annex-t\n\nquantity Y_max\n  limit  std 8 kN\n'
    assert fishplate.check(variant) == []
    result = fishplate.certify(coach, variant, plots=0)
    limits = result.summary.to_polars().filter(polars.col("quantity") == "Y_max")["limit"]
    assert limits.max() == 8.0
    fewer = fishplate.certify(coach, sections_per_zone=5)
    assert fewer.verdict == "not assessable" and "at least 5 required" in fewer.reasons[0]


def test_the_interpreter_is_free_meanwhile(coach):
    ticks, ended = [], threading.Event()

    def tick():
        while not ended.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.002)

    other = threading.Thread(target=tick)
    other.start()
    begin = time.perf_counter()
    fishplate.study(coach, "sync", offsets=[-1, 1])
    taken = time.perf_counter() - begin
    ended.set()
    other.join()
    during = [at for at in ticks if begin <= at <= begin + taken]
    # A thread that waits for the interpreter ticks once at each end.
    assert len(during) > 5 and taken > 0.02


def test_ctrl_c_ends_the_waiting(coach):
    code = (
        "import os, signal, threading, fishplate\n"
        "threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()\n"
        "try:\n"
        f"    while True: fishplate.study({str(coach)!r}, 'sync')\n"
        "except KeyboardInterrupt:\n"
        "    print('interrupted', flush=True)\n"
        "    os._exit(0)\n"
    )
    import sys

    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.stdout == "interrupted\n", done.stderr


def test_a_made_up_campaign():
    result = fishplate.certify(fishplate.Campaign(**small()))
    assert result.verdict == "not assessable" and "zone 2 has 0 usable sections" in result.reasons[0]
    assert result.sections.to_polars()["used"].all()
    several = small()
    several["simulation"] = {"a": several["simulation"], "b": small(seed=2)["simulation"]}
    assert set(fishplate.certify(fishplate.Campaign(**several)).values.to_polars()["record"]) == {"a", "b"}


def test_study_and_compare(coach, tmp_path):
    study = fishplate.study(coach)
    assert json.loads(study.json())["combinations"] > 0 and study.facts and study.tables()
    study.write(tmp_path / "study", pdf=False)
    assert (tmp_path / "study" / "report.html").stat().st_size > 10_000
    margin = json.loads(fishplate.study(ROOT / "examples" / "coach-good", "margin", draws=0).json())
    assert {"change", "of", "low", "high"} <= margin["margin"][0].keys() and margin["probability_right"] is None
    both = fishplate.compare(coach, ["en14363-2016-annex-t", "en14363-2016-annex-t-confidence"], sizes=[])
    verdicts = json.loads(both.json())["verdicts"]
    assert [verdict["verdict"] for verdict in verdicts][0] == "not validated"
    for shown in (study, both):
        assert shown.title and "<table>" in shown._repr_html_()
