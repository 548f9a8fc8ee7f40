"""What formulas of time do within a step: Co-Simulation meets it by its own steps, Model Exchange by time events."""

from __future__ import annotations

from pathlib import Path

import fmpy
import pytest

import symofros as sf
from tests.pulses import END, SHAPES, cart, drawn

# Of CVODE at FMPy's relative tolerance, 1e-4 a step; of dopri5 at its default bounds.
BOUND = {"ModelExchange": 2e-3, "CoSimulation": 1e-4}


@pytest.fixture(scope="module", params=[2, 3])
def units(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """An FMU of each shape, of one version."""
    folder, target = tmp_path_factory.mktemp("fmu"), f"fmu{request.param}"
    written = {}
    for shape, (force, _) in SHAPES.items():
        sf.export(cart(force), target, folder / shape, method="dopri5")
        written[shape] = str(folder / shape / "cart.fmu")
    return written


@pytest.mark.parametrize("kind", BOUND)
@pytest.mark.parametrize("shape", SHAPES)
def test_a_pulse_gives_its_impulse(units: dict[str, str], shape: str, kind: str) -> None:
    """With no time events, CVODE leaves the cart at rest."""
    for late, width in drawn(4):
        done = fmpy.simulate_fmu(
            units[shape],
            stop_time=END,
            output_interval=0.1,
            fmi_type=kind,
            output=["v.x"],
            start_values={"par.late": late, "par.width": width},
        )
        assert done["v.x"][-1] == pytest.approx(SHAPES[shape][1], rel=BOUND[kind]), (late, width)


def test_smooth_formulas_have_no_time_events(tmp_path: Path) -> None:
    sf.export(cart("sin(t) + late + width"), "fmu2", tmp_path / "smooth")
    assert _events(tmp_path / "smooth" / "cart.fmu", tmp_path / "out", END) == []


def test_time_events_are_the_instants_of_the_formula(tmp_path: Path) -> None:
    """With a stop time those alone; without one also where the search goes on, at the latest."""
    sf.export(cart(SHAPES["tent"][0]), "fmu2", tmp_path / "tent")
    unit = tmp_path / "tent" / "cart.fmu"
    corners = pytest.approx([5.0 - 1e-3, 5.0, 5.0 + 1e-3], abs=1e-9)
    assert _events(unit, tmp_path / "stopped", END) == corners
    on = _events(unit, tmp_path / "open", None)
    assert [t for t in on if abs(t - 5.0) < 0.01] == corners
    assert max(b - a for a, b in zip([0.0, *on], on, strict=False)) < 0.55


def _events(unit: Path, folder: Path, stop: float | None) -> list[float]:
    """Times that a unit of Model Exchange announces, up to END."""
    description = fmpy.read_model_description(str(unit))
    model = fmpy.fmi2.FMU2Model(
        guid=description.guid,
        modelIdentifier=description.modelExchange.modelIdentifier,
        unzipDirectory=fmpy.extract(str(unit), unzipdir=str(folder)),
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
