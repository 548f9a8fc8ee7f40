"""FMUs of diagrams, by FMPy: their variables, and the values of the same diagram run from Python."""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import replace
from math import cos
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.simulation import FMICallException
from fmpy.validation import validate_fmu

import symofros as sf
from reference_models import MODELS
from symofros import blocks
from tests.diagrams.run.test_states_of_forces import driven
from tests.diagrams.run.test_switching import CASES, Case
from tests.diagrams.run.test_switching import diagram as alone
from tests.exports.fmi.logs import heard
from tests.exports.fmi.units import Unit, exported
from tests.exports.test_controller import conditional, inside, machine, rates
from tests.exports.test_diagram import switching
from tests.simulation.rigid_scenes import rod_system

STEPS = 20


def put(unit: Unit, values: dict[str, float]) -> None:
    for name, value in values.items():
        unit.set(name, value)


def entries(name: str, row: np.ndarray) -> dict[str, float]:
    return {f"{name}[{i}]": float(x) for i, x in enumerate(row)}


@pytest.mark.parametrize("version", [2, 3])
def test_a_unit_shows_inputs_outputs_and_parameters(version: int, tmp_path: Path) -> None:
    path = exported(rates(), version, tmp_path / "fmu")
    assert validate_fmu(str(path)) == []
    said = fmpy.read_model_description(str(path))
    shown = {
        variable.name: (variable.causality, variable.unit, variable.start and float(variable.start))
        for variable in said.modelVariables
    }
    assert shown["goal[1]"] == ("input", "rad", 0.0)
    assert shown["v[0]"] == ("input", "rad/s", 0.5)
    assert shown["effort[0]"] == ("output", "N.m", None)
    assert shown["ticks"] == ("output", None, None)
    assert shown["pd.kp[0]"] == ("parameter", None, 50.0)
    assert len(shown) == 1 + 6 + 5 + 4
    assert said.modelExchange is None and float(said.defaultExperiment.stepSize) == 1e-3


@pytest.mark.parametrize("make", [rates, inside, machine, conditional])
@pytest.mark.parametrize("version", [2, 3])
def test_a_unit_gives_what_python_gives(version: int, make: Any, tmp_path: Path) -> None:
    """Inputs of the end of a step are read by the samples there; a saved state is gone back to."""
    diagram = make()
    rng, t = np.random.default_rng(3), np.arange(STEPS) / 1000.0
    rows = {name: rng.uniform(-1.0, 1.0, (STEPS, 2)) for name in diagram.inlets}
    path = exported(diagram, version, tmp_path / "fmu")
    unit = Unit(path, version, True, tmp_path / "unit")
    moved = sf.Simulation(diagram).run(
        t[-1],
        dt=1e-3,
        record=1e-3,
        inputs={name: sf.Signal(t, values, "hold") for name, values in rows.items()},
        parameters={"pd.kp": [12.0, 30.0]} if make is rates else {},
    )
    scalars = {machine: ("y", "count", "state"), conditional: ("runs", "edges")}
    read = scalars.get(make, ("effort[0]", "effort[1]"))
    wanted = np.column_stack([moved[name] for name in read]) if make in scalars else moved["effort"]
    at = {k: {key: x for name in rows for key, x in entries(name, rows[name][k]).items()} for k in range(STEPS)}
    put(unit, at[0] | ({"pd.kp[0]": 12.0} if make is rates else {}))
    unit.start()
    found = [unit.get(*read)]
    saved = unit.save()
    for attempt in range(2):
        for k in range(1, STEPS):
            put(unit, at[k])
            unit.fmu.doStep(t[k - 1], 1e-3)
            found.append(unit.get(*read))
        np.testing.assert_allclose(found, wanted, rtol=1e-11, atol=1e-11)
        if attempt == 0:
            unit.restore(saved)
            found = found[:1]


@pytest.mark.parametrize("version", [2, 3])
def test_a_unit_switches_where_python_does(version: int, tmp_path: Path) -> None:
    """Within steps, too; what is gone back to has its memory and does not begin anew."""
    diagram, outputs = switching()
    path = exported(diagram, version, tmp_path / "fmu", outputs=outputs)
    unit = Unit(path, version, True, tmp_path / "unit")
    unit.start()
    run, t = sf.Simulation(diagram).run(1.1, dt=1e-3, record=0.05), 0.05 * np.arange(1, 23)
    last = [np.flatnonzero(np.abs(run.t - x) < 1e-12)[-1] for x in t]
    wanted = np.column_stack([run[name][last] for name in outputs])
    variables = [re.sub(r"^(.*/.*)\.", r"'\1'.", name) for name in outputs]  # Structured names.
    saved, found = None, []
    for k in (*range(12), *range(6, 22)):
        if k == 6 and saved is None:
            saved = unit.save()
        elif k == 6:
            unit.restore(saved)
        unit.fmu.doStep(t[k] - 0.05, 0.05)
        found.append((k, unit.get(*variables)))
    assert len(set(wanted[:, 3])) == 2
    for k, values in found:
        np.testing.assert_allclose(values, wanted[k], atol=1e-9, err_msg=f"t = {t[k]}")


@pytest.mark.parametrize("version", [2, 3])
def test_outputs_after_a_restored_state_are_those_of_its_inputs(version: int, tmp_path: Path) -> None:
    """A state may be saved between an input that was set and the output that follows from it."""
    diagram = sf.Diagram("doubled")
    diagram.add(blocks.Gain(name="gain", gain=2.0))
    diagram.add_inlet("u", "gain.u", shape=())
    path = exported(diagram, version, tmp_path / "fmu", outputs=["gain.y"])
    unit = Unit(path, version, True, tmp_path / "unit")
    unit.start()
    unit.set("u", 3.0)
    saved = unit.save()
    unit.set("u", -1.0)
    unit.fmu.doStep(0.0, 1e-3)
    assert unit.get("gain.y")[0] == -2.0
    unit.restore(saved)
    assert unit.get("gain.y")[0] == 6.0
    if version == 2:  # What is asked of a step that may take its time: ours do not.
        terminated, *others = 3, 0, 1, 2
        assert unit.fmu.getBooleanStatus(terminated) is False
        for kind in others:
            with pytest.raises(FMICallException):
                unit.fmu.getBooleanStatus(kind)
    unit.fmu.freeInstance()


@pytest.mark.parametrize("version", [2, 3])
def test_a_unit_refuses_in_words(version: int, tmp_path: Path) -> None:
    diagram = sf.Diagram("cart")
    diagram.add_model("cart", MODELS["cart_pole"])
    diagram.add(blocks.ForwardDynamics(name="cart", model="cart"))
    diagram.add_inlet("effort", "cart.u")
    path = exported(diagram, version, tmp_path / "fmu")
    refused: list[tuple[dict[str, Any], str]] = [
        ({"start_time": 1.0}, "a diagram begins at t = 0"),
        ({"start_values": {"cart.m_cart": -1.0}}, "mass >= 0"),
    ]
    for options, words in refused:
        with heard() as (logger, log), pytest.raises(FMICallException):
            fmpy.simulate_fmu(str(path), stop_time=2.0, logger=logger, **options)
        assert words in "".join(log), log


@pytest.mark.parametrize(
    ("version", "case"),
    [
        *[(2, "brake"), (3, "bounce"), (3, "grasp"), (2, "rest"), (3, "rest"), (2, "slab"), (3, "backspin")],
        *[(2, "lugre"), (3, "lugre")],
    ],
)
def test_a_unit_moves_as_the_run(version: int, case: str, tmp_path: Path) -> None:
    """With its actions, or with states of forces; from a state that was saved before, too: both belong to it."""
    of, end = (driven(case), 0.2) if case == "lugre" else (alone(CASES[case]), CASES[case].t_end)
    outputs, h = ["plant.q", *(["plant.z"] if case == "lugre" else [])], end / 10
    unit = Unit(exported(of, version, tmp_path / "fmu", outputs=outputs, dt=1e-3), version, True, tmp_path / "unit")
    run = sf.Simulation(of).run(end, dt=1e-3, record=h)
    last = [np.flatnonzero(run.t <= k * h + 1e-12)[-1] for k in range(11)]
    wanted = np.column_stack([run[name][last] for name in outputs])
    names = [f"{name}[{i}]" for name in outputs for i in range(run[name].shape[1])]
    unit.start()
    bound = {"rtol": 1e-10, "atol": 0.0} if case == "lugre" else {"rtol": 1e-9, "atol": 1e-10}
    np.testing.assert_allclose(unit.get(*names), wanted[0], rtol=1e-12, atol=bound["atol"])
    for found in unit.twice(10, h, *names):
        np.testing.assert_allclose(found, wanted[1:], **bound)


def test_parameters_are_what_actions_have_set(tmp_path: Path) -> None:
    """A latch that breaks: it was said to be shut, as it was at the start."""
    unit = Unit(exported(alone(CASES["latch"]), 3, tmp_path / "fmu", dt=1e-3), 3, True, tmp_path / "unit")
    unit.start()
    assert unit.get("m.shut") == 1.0
    unit.fmu.doStep(0.0, 0.5)
    assert unit.get("m.shut") == 0.0
    unit.set("m.shut", 1.0)
    assert unit.get("m.shut") == 1.0, "what is set later counts, too"


def test_importers_get_the_reason_why_a_motion_has_ended(tmp_path: Path) -> None:
    """A rod that leans against its slide, with too much friction from an instant on."""
    rod = replace(rod_system(sf.formula("mu")), parameters=(sf.Parameter("mu", 0.1),))
    rough = {"rough": sf.Event("t - 0.02", action={"mu": 1.6})}
    of = alone(Case(rod, rough, 0.1, {"z": cos(0.5), "angle": 0.5, "dx": -2.0}))
    path = exported(of, 2, tmp_path / "fmu", outputs=["plant.q"], dt=1e-3)
    with heard() as (logger, log), suppress(FMICallException):
        fmpy.simulate_fmu(str(path), stop_time=1.0, output_interval=0.01, logger=logger)
    assert "Painleve's paradox" in "".join(log), log


def test_a_unit_does_not_end(tmp_path: Path) -> None:
    ends = alone(CASES["bounce"], events={"down": sf.Event("z", "falling", terminal=True)})
    with pytest.raises(sf.SymofrosError, match=r"event 'plant\.down' ends the motion"):
        sf.export(ends, "fmu3", tmp_path / "fmu")
