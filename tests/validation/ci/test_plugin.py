"""The plug-in in a project of somebody else's: a folder of its own, pytest in a process of its own."""

import json
import os
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from importlib.metadata import entry_points
from pathlib import Path

import junitparser
import pytest
from typer.testing import CliRunner

from tests.validation.subjects import URDF
from validation.__main__ import app

ROOT = Path(__file__).parents[3]
# An engine that answers wrongly in one entry, planted as a user's conftest can.
WRONG_ENGINE = """
from validation.adapters.pinocchio import tree

original = tree.ChartedEngine.mass_matrix

def wrong(self, states):
    M = original(self, states).copy()
    M[3, 0, 0] *= 1.0 + 1e-9
    return M

tree.ChartedEngine.mass_matrix = wrong
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    (tmp_path / "arm.urdf").write_text(URDF)
    (tmp_path / "test_own.py").write_text("def test_own():\n    pass\n")
    return tmp_path


def pytest_in(project: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    loaded = any(point.name == "symofros" for point in entry_points(group="pytest11"))
    plugin = [] if loaded else ["-p", "symofros.pytest_plugin"]
    paths = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH", "")]))
    return subprocess.run(
        [sys.executable, "-m", "pytest", *plugin, "-p", "no:cacheprovider", *arguments],
        cwd=project,
        env=os.environ | {"PYTHONPATH": paths},
        capture_output=True,
        text=True,
        timeout=300,
    )


def cases(junit: Path) -> dict[str, ElementTree.Element]:
    return {case.get("name", ""): case for case in ElementTree.parse(junit).getroot().iter("testcase")}


SMOKE = ("--symofros-model", "arm.urdf", "--symofros-tier", "smoke")


@pytest.mark.slow
def test_a_robot_of_another_project_is_checked_beside_its_own_tests(project: Path) -> None:
    done = pytest_in(project, *SMOKE, "--symofros-engine", "pinocchio", "--junitxml", "junit.xml")
    assert done.returncode == 0, done.stdout + done.stderr
    found = cases(project / "junit.xml")
    assert set(found) == {"test_own", "arm[pinocchio]", "arm[confirmed]"}
    errors = {item.get("name"): float(item.get("value", "")) for item in found["arm[pinocchio]"].iter("property")}
    assert errors["mass_matrix"] < 1e-13 and len(errors) > 10
    (suite,) = junitparser.JUnitXml.fromfile(str(project / "junit.xml"))
    assert (suite.tests, suite.failures, suite.errors, suite.skipped) == (3, 0, 0, 0)
    assert {case.name for case in suite} == set(found) and suite.time > 0.0


def test_a_wrong_entry_of_an_engine_is_named(project: Path) -> None:
    (project / "conftest.py").write_text(WRONG_ENGINE)
    done = pytest_in(project, *SMOKE, "--symofros-engine", "pinocchio", "-m", "symofros_smoke", "-k", "not confirmed")
    assert done.returncode == 1, done.stdout + done.stderr
    assert "arm, by pinocchio: mass_matrix: error" in done.stdout and "1 failed" in done.stdout
    assert "state 3 of" in done.stdout and "Traceback" not in done.stdout


@pytest.mark.slow
def test_a_model_that_no_engine_confirms_fails(project: Path) -> None:
    done = pytest_in(project, *SMOKE, "--symofros-engine", "interpreted", "-k", "arm")
    assert done.returncode == 1 and "no independent engine confirms this model" in done.stdout


@pytest.mark.slow
def test_a_stored_run_is_a_test_of_its_own(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(project)
    command = ["check", "arm.urdf", "--states", "20", "--engine", "mujoco", "--report", "stored"]
    assert CliRunner().invoke(app, command).exit_code == 0
    asked = (*SMOKE, "--symofros-engine", "mujoco", "--symofros-baseline", "stored/check.json", "-k", "baseline")
    assert pytest_in(project, *asked).returncode == 0
    data = json.loads((project / "stored/check.json").read_text())
    for row in data["comparisons"]:
        if row["quantity"] == "bias":
            row["error"] = 1e-25
            row["quantity"] = "bias_of_before"
    (project / "stored/check.json").write_text(json.dumps(data))
    done = pytest_in(project, *asked)
    assert done.returncode == 1 and "arm, bias_of_before by mujoco: not compared" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("--symofros-engine", "havok"), "no engine 'havok'; there are pinocchio"),
        pytest.param(("--symofros-model", "nobody"), "neither a file nor a model", marks=pytest.mark.slow),
        pytest.param((*SMOKE, "--symofros-baseline", "test_own.py"), "can't be read as JSON", marks=pytest.mark.slow),
    ],
)
def test_options_with_invalid_values_are_refused(project: Path, arguments: tuple[str, ...], complaint: str) -> None:
    done = pytest_in(project, *arguments)
    assert done.returncode == 4 and complaint in done.stderr and "Traceback" not in done.stderr


def test_without_options_the_plug_in_loads_nothing() -> None:
    code = "import sys; before = {*sys.modules}; import symofros.pytest_plugin; print(*({*sys.modules} - before))"
    done = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True, text=True
    )
    loaded = {name for name in done.stdout.split() if name.partition(".")[0] in ("numpy", "symofros", "validation")}
    light = {
        f"symofros.{name}" for name in ("commands", "commands.reading_options", "errors", "harness", "pytest_plugin")
    }
    assert loaded == {"symofros"} | light, done.stdout + done.stderr
