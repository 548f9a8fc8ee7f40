"""FMUs by FMPy: legal by its validator, moved by its simulator and its CVODE; what they declare."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

import symofros as sf
from reference_models import MODELS as REFERENCE
from symofros.exports.fmi.fmu_variables import Variable, _distinct
from tests.exports.cases import STARTS, STRICT, first_state, relative, run, trajectory
from tests.exports.fmi.units import ONE_VERSION, OWN, SAMPLED, VERSIONS, by_version, exported, system_called

SAME = 1e-12
# CVODE's own tolerance, over the run.
MODEL_EXCHANGE = 1e-6


def columns(result: Any, prefix: str) -> np.ndarray:
    return np.array([result[name][-1] for name in result.dtype.names if name.startswith(prefix)])


@pytest.mark.parametrize(("version", "name"), by_version(*SAMPLED, *OWN))
def test_fmpy_validates_the_fmu(made: Any, name: str, version: int) -> None:
    assert validate_fmu(str(made(name, version))) == []


@pytest.mark.parametrize(("version", "name"), by_version(*SAMPLED))
def test_co_simulation_moves_as_python_does(made: Any, name: str, version: int) -> None:
    found = fmpy.simulate_fmu(str(made(name, version)), fmi_type="CoSimulation", stop_time=0.2, output_interval=0.01)
    wanted = trajectory(name, 0.2)
    assert relative(columns(found, "q."), wanted.q[-1]) < SAME
    assert relative(columns(found, "v."), wanted.v[-1]) < SAME


@pytest.mark.parametrize(("version", "name"), by_version(*SAMPLED, *OWN))
def test_model_exchange_moves_as_python_does(made: Any, name: str, version: int) -> None:
    found = fmpy.simulate_fmu(
        str(made(name, version)), fmi_type="ModelExchange", stop_time=0.2, output_interval=0.01, relative_tolerance=1e-9
    )
    model = sf.compile(system_called(name))
    q, v = first_state(model, name) if name in STARTS else (model.neutral(), np.zeros(model.nv))
    wanted = sf.simulate(model, q, v, 0.2, dt=1e-4)
    assert relative(columns(found, "q."), wanted.q[-1]) < MODEL_EXCHANGE


def test_shipped_sources_compile_strictly(made: Any, version: int, tmp_path: Path) -> None:
    """The sources that travel with it, as an importer builds them, under the strictest flags."""
    fmpy.extract(str(made("four_bar", version)), tmp_path)
    headers = Path(fmpy.__file__).parent / "c-code"
    run(
        "gcc",
        *STRICT,
        "-fsyntax-only",
        "-isystem",  # The headers of FMI are not ours.
        headers,
        f"four_bar_fmi{version}.c",
        cwd=tmp_path / "sources",
    )


def test_sources_of_two_fmus_share_no_symbol(made: Any, version: int, tmp_path: Path) -> None:
    """FMI 3 asks sources to prefix their functions; FMPy's header of FMI 2 knows no prefix."""
    headers = Path(fmpy.__file__).parent / "c-code"
    defined = []
    for name in ("planar", "four_bar"):
        fmpy.extract(str(made(name, version)), tmp_path / name)
        source = tmp_path / name / "sources" / f"{name}_fmi{version}.c"
        run("gcc", "-std=c99", "-O0", f"-I{headers}", "-c", source, "-o", f"{name}.o", cwd=tmp_path)
        symbols = run("nm", "--defined-only", "--extern-only", f"{name}.o", cwd=tmp_path).split()[2::3]
        defined.append({symbol for symbol in symbols if not symbol.startswith("fmi2")})
    assert all(symbol.startswith("planar_") for symbol in defined[0])
    assert not defined[0] & defined[1]
    assert ("planar_fmi3GetVersion" in defined[0]) == (version == 3)


def test_only_the_interface_is_visible(made: Any, version: int, tmp_path: Path) -> None:
    fmpy.extract(str(made("four_bar", version)), tmp_path)
    (library,) = (tmp_path / "binaries").rglob("*.so")
    symbols = run("nm", "-D", "--defined-only", library, cwd=tmp_path).split()[2::3]
    assert symbols
    assert all(symbol.startswith(f"fmi{version}") for symbol in symbols)


@pytest.mark.parametrize("version", ONE_VERSION)
def test_units_and_dependencies_are_declared(made: Any, version: int) -> None:
    description = fmpy.read_model_description(str(made("planar", version)))
    units = {variable.name: variable.unit for variable in description.modelVariables}
    assert units["q.q1"] == "rad"
    assert units["der(v.q1)"] == "rad/s2"
    assert units["u.q1"] == "N.m"
    assert units["p.tool.x"] == "m"
    outputs = {output.variable.name: output.dependencies for output in description.outputs}
    assert outputs["p.tool.z"] == []  # It moves in the plane.
    assert {variable.name for variable in outputs["p.tool.x"]} >= {"q.q1", "q.'link.bend_y[0]'"}
    assert float(description.defaultExperiment.stepSize) == 0.01  # Ten steps of the unit's own.


def test_places_of_frames_depend_on_what_moves_them_anywhere(made: Any) -> None:
    """On prescribed motions, and on coordinates that move a frame along an axis where those are not zero, too."""
    description = fmpy.read_model_description(str(made("driven", VERSIONS["driven"])))
    prescribed = {v.name for v in description.modelVariables if v.causality == "input"} - {"u.q1"}
    assert len(prescribed) == 9
    for output in description.outputs:
        if output.variable.name.startswith("p."):
            assert {v.name for v in output.dependencies} == prescribed | {"q.q1"}, output.variable.name


def test_a_missing_fmpy_is_reported(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(sf.ExportError, match=r"pip install 'symofros\[fmi\]'"):
        sf.export(REFERENCE["pendulum"], "fmu2", tmp_path)


@pytest.mark.parametrize(
    ("version", "prescribed"),
    [
        (2, True),
        (3, False),
        pytest.param(2, False, marks=pytest.mark.slow),
        pytest.param(3, True, marks=pytest.mark.slow),
    ],
)
def test_models_without_states_or_inputs_become_fmus(tmp_path: Path, version: int, prescribed: bool) -> None:
    body = sf.RigidBody("b", sf.Joint("j", "revolute", prescribed=prescribed), sf.Inertia(1.0, (1, 0, 0), (1, 1, 1)))
    path = str(exported(sf.System("odd", (body,)), version, tmp_path, outputs=[]))
    assert validate_fmu(path) == []
    assert fmpy.simulate_fmu(path, fmi_type="CoSimulation", stop_time=0.01)["time"][-1] == 0.01


def test_equal_names_of_variables_are_numbered_inside_their_quotes() -> None:
    names = ("'a'", "'b'", "'a'", "'a'")
    variables = [Variable(k, name, "output", "continuous") for k, name in enumerate(names)]
    assert [one.name for one in _distinct(variables)] == ["'a'", "'b'", "'a 1'", "'a 2'"]
    assert [one.reference for one in variables] == [0, 1, 2, 3]
