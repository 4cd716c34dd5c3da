"""A diagnosis with a Python function as simulator."""

import json
import subprocess
import threading

import double_pendulum
import pytest
from conftest import ROOT

import fishplate

FOLDER = double_pendulum.FOLDER


@pytest.fixture(scope="module")
def found():
    threads = set()

    def counted(task):
        threads.add(threading.get_ident())
        return double_pendulum.two_link(task)

    report = fishplate.diagnose(
        FOLDER, FOLDER / "double-pendulum.fp", FOLDER / "effects.yaml", counted, simulator_name="two-link"
    )
    assert threading.get_ident() not in threads
    return report


def test_the_function_gives_what_the_program_gives(found, tmp_path):
    """As `docs/double-pendulum.md`, whose simulator is a program with six decimals: sizes agree to a thousandth."""
    diagnosis = json.loads(found.json())
    assert found.verdict == diagnosis["verdict"] == "unexplained"
    named = {effect["name"]: effect["parameters"] for effect in diagnosis["causes"][0]["effects"]}
    assert set(named) == {"elbow_friction", "motor_inertia", "shoulder_friction"}
    assert named["elbow_friction"]["elbow.coulomb"]["value"] == pytest.approx(0.1138, abs=2e-4)
    assert named["motor_inertia"]["motor.inertia"]["value"] == pytest.approx(9.386e-5, rel=1e-2)
    assert diagnosis["shrink"]["fraction_removed"] == pytest.approx(0.698, abs=0.01)


def test_the_report(found, tmp_path):
    found.write(tmp_path, pdf=False)
    assert {path.name for path in tmp_path.glob("*.*") if not path.name.startswith(".")} == {"diagnosis.json", "report.html"}
    assert "unexplained" in found._repr_html_() and found.figures


def failing(message):
    def simulator(task):
        raise RuntimeError(message)

    return simulator


@pytest.mark.parametrize(
    ("simulator", "says"),
    [
        (failing("no licence"), "no licence"),
        (lambda task: None, "no table"),
        (lambda task: {"time [s]": [0.0, 1.0]}, "tau_1"),
        (lambda task: double_pendulum.two_link(task) | {"tau_1 [kN]": [0.0]}, "values"),
    ],
)
def test_a_failing_simulator_is_told(simulator, says):
    with pytest.raises(fishplate.Error) as caught:
        fishplate.diagnose(
            FOLDER, FOLDER / "double-pendulum.fp", FOLDER / "effects.yaml", simulator, simulator_name="two-link"
        )
    assert says in str(caught.value), caught.value
