"""What formulas of time do within a step: Co-Simulation meets it by its own steps, Model Exchange by time events."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import fmpy
import pytest

from tests.exports.fmi.units import exported
from tests.pulses import END, SHAPES, cart, drawn

# Of CVODE at FMPy's relative tolerance, 1e-4 a step; of dopri5 at its default bounds.
BOUND = {"ModelExchange": 2e-3, "CoSimulation": 1e-4}


@pytest.fixture(scope="module")
def unit(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, int], str]:
    """Path of the FMU of a force, of a version of the standard; each is made once."""

    @cache
    def made(force: str, version: int) -> str:
        return str(exported(cart(force), version, tmp_path_factory.mktemp("fmu") / "out", method="dopri5"))

    return made


@pytest.mark.parametrize("kind", BOUND)
@pytest.mark.parametrize(
    ("shape", "version"),
    [
        *((shape, 2) for shape in SHAPES),
        ("tent", 3),
    ],  # Versions differ in how they announce an instant, not in how it is found.
)
def test_a_pulse_gives_its_impulse(unit: Callable[[str, int], str], shape: str, version: int, kind: str) -> None:
    """With no time events, CVODE leaves the cart at rest."""
    force, impulse = SHAPES[shape]
    for late, width in drawn(4):
        done = fmpy.simulate_fmu(
            unit(force, version),
            stop_time=END,
            output_interval=0.1,
            fmi_type=kind,
            output=["v.x"],
            start_values={"par.late": late, "par.width": width},
        )
        assert done["v.x"][-1] == pytest.approx(impulse, rel=BOUND[kind]), (late, width)


def test_time_events_are_the_instants_of_the_formula(unit: Callable[[str, int], str], tmp_path: Path) -> None:
    """With a stop time those alone; without one where the search goes on, too; none where all is smooth."""
    tent = unit(SHAPES["tent"][0], 2)
    corners = pytest.approx([5.0 - 1e-3, 5.0, 5.0 + 1e-3], abs=1e-9)
    assert _events(tent, tmp_path / "stopped", END) == corners
    on = _events(tent, tmp_path / "open", None)
    assert [t for t in on if abs(t - 5.0) < 0.01] == corners
    assert max(b - a for a, b in zip([0.0, *on], on, strict=False)) < 0.55
    assert _events(unit("sin(t) + late + width", 2), tmp_path / "smooth", END) == []


def _events(unit: str, folder: Path, stop: float | None) -> list[float]:
    """Times that a unit of Model Exchange announces, up to END."""
    description = fmpy.read_model_description(unit)
    model = fmpy.fmi2.FMU2Model(
        guid=description.guid,
        modelIdentifier=description.modelExchange.modelIdentifier,
        unzipDirectory=fmpy.extract(unit, unzipdir=str(folder)),
        instanceName="cart",
    )
    model.instantiate()
    model.setupExperiment(startTime=0.0, stopTime=stop)
    model.enterInitializationMode()
    model.exitInitializationMode()
    found: list[float] = []
    while True:
        *_, is_next, at = model.newDiscreteStates()
        if not is_next or at > END:
            break
        found.append(at)
        model.enterContinuousTimeMode()
        model.setTime(at)
        model.enterEventMode()
    model.terminate()
    model.freeInstance()
    return found
