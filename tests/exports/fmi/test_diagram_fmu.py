"""FMUs of diagrams, by FMPy: their variables, and the values of the same diagram run from Python."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.simulation import FMICallException
from fmpy.validation import validate_fmu

import symofros as sf
from reference_models import MODELS
from symofros import blocks
from tests.exports.fmi.logs import heard
from tests.exports.test_controller import inside, rates

STEPS = 20


class Unit:
    """A unit of Co-Simulation of either version, its variables by name."""

    def __init__(self, path: Path, version: int) -> None:
        said = fmpy.read_model_description(str(path))
        self.references = {variable.name: variable.valueReference for variable in said.modelVariables}
        kind: Any = FMU2Slave if version == 2 else FMU3Slave
        self.slave = kind(
            guid=said.guid,
            unzipDirectory=fmpy.extract(str(path)),
            modelIdentifier=said.coSimulation.modelIdentifier,
            instanceName="unit",
        )
        self.version = version
        self.slave.instantiate()

    def begin(self, values: dict[str, float]) -> None:
        """Initialise with values of variables."""
        if self.version == 2:
            self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.put(values)
        self.slave.exitInitializationMode()

    def put(self, values: dict[str, float]) -> None:
        """Set variables."""
        into = self.slave.setReal if self.version == 2 else self.slave.setFloat64
        into([self.references[name] for name in values], list(map(float, values.values())))

    def get(self, *names: str) -> list[float]:
        """Values of variables."""
        of = self.slave.getReal if self.version == 2 else self.slave.getFloat64
        return list(of([self.references[name] for name in names]))


def entries(name: str, row: np.ndarray) -> dict[str, float]:
    return {f"{name}[{i}]": float(x) for i, x in enumerate(row)}


@pytest.mark.parametrize("version", [2, 3])
def test_a_unit_shows_inputs_outputs_and_parameters(version: int, tmp_path: Path) -> None:
    path = sf.export(rates(), f"fmu{version}", tmp_path / "fmu").files[0]  # type: ignore[arg-type]
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


@pytest.mark.parametrize(("version", "make"), [(2, rates), (3, rates), (2, inside), (3, inside)])
def test_a_unit_gives_what_python_gives(version: int, make: Any, tmp_path: Path) -> None:
    """Inputs of the end of a step are read by the samples there; a saved state is gone back to."""
    diagram = make()
    rng, t = np.random.default_rng(3), np.arange(STEPS) / 1000.0
    rows = {name: rng.uniform(-1.0, 1.0, (STEPS, 2)) for name in diagram.inlets}
    unit = Unit(sf.export(diagram, f"fmu{version}", tmp_path / "fmu").files[0], version)  # type: ignore[arg-type]
    moved = sf.Simulation(diagram).run(
        t[-1],
        dt=1e-3,
        record=1e-3,
        inputs={name: sf.Signal(t, values, "hold") for name, values in rows.items()},
        parameters={"pd.kp": [12.0, 30.0]} if make is rates else {},
    )
    wanted = moved["effort"]
    at = {k: {key: x for name in rows for key, x in entries(name, rows[name][k]).items()} for k in range(STEPS)}
    unit.begin(at[0] | ({"pd.kp[0]": 12.0} if make is rates else {}))
    found = [unit.get("effort[0]", "effort[1]")]
    saved = unit.slave.getFMUState() if version == 3 else unit.slave.getFMUstate()
    for attempt in range(2):
        for k in range(1, STEPS):
            unit.put(at[k])
            unit.slave.doStep(t[k - 1], 1e-3)
            found.append(unit.get("effort[0]", "effort[1]"))
        np.testing.assert_allclose(found, wanted, rtol=1e-11, atol=1e-11)
        if attempt == 0:
            (unit.slave.setFMUState if version == 3 else unit.slave.setFMUstate)(saved)
            found = found[:1]


@pytest.mark.parametrize("version", [2, 3])
def test_a_unit_refuses_in_words(version: int, tmp_path: Path) -> None:
    diagram = sf.Diagram("cart")
    diagram.add_model("cart", MODELS["cart_pole"])
    diagram.add(blocks.ForwardDynamics(name="cart", model="cart"))
    diagram.add_inlet("effort", "cart.u")
    path = sf.export(diagram, f"fmu{version}", tmp_path / "fmu").files[0]  # type: ignore[arg-type]
    refused: list[tuple[dict[str, Any], str]] = [
        ({"start_time": 1.0}, "a diagram begins at t = 0"),
        ({"start_values": {"cart.m_cart": -1.0}}, "mass >= 0"),
    ]
    for options, words in refused:
        with heard() as (logger, log), pytest.raises(FMICallException):
            fmpy.simulate_fmu(str(path), stop_time=2.0, logger=logger, **options)
        assert words in "".join(log), log
