"""A diagram's package begins where a run from Python begins, and its notes say what that run would say of it."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros import blocks
from symofros.diagrams.settings import RunSettings
from tests.exports.cases import build, run


def moved(system: sf.System | str | Path, start: dict[str, float]) -> sf.Diagram:
    diagram = sf.Diagram("moved")
    diagram.add_model("plant", system, start=start)
    diagram.add(blocks.ForwardDynamics(name="plant", model="plant"))
    return diagram


@pytest.mark.parametrize("angle", [1.0, 2.2])
def test_an_exported_diagram_keeps_its_stated_start(angle: float, tmp_path: Path) -> None:
    """A projection alone, which a package makes of itself, moves the crank as well as what follows it."""
    diagram = moved(MODELS["slider_crank"], {"turn": angle, "dturn": 1.0})
    exported = sf.export(diagram, "c", tmp_path / "c")
    program = build(exported.folder, "program")
    first = [float(word) for word in run(program, "0", cwd=tmp_path).splitlines()[1].split(",")]
    begun = sf.Simulation(diagram).run(0.01, dt=1e-3, record=0.01)
    np.testing.assert_allclose(first[1:], [*begun["plant.q"][0], *begun["plant.v"][0]], atol=1e-12)
    assert first[1] == pytest.approx(angle, abs=1e-9)
    check = subprocess.run([program, "--check"], capture_output=True, text=True)
    assert check.returncode == 0, check.stdout


def test_limits_and_first_steps_are_noted(tmp_path: Path) -> None:
    """Limits are data, as in packages of models; a start outside them is noted as by a run."""
    joint = sf.Joint("a", "revolute", axis=(0, 1, 0), limits=sf.Limits(-0.5, 0.5, 2.0, 3.0))
    system = sf.System("limited", (sf.RigidBody("b", joint, sf.Inertia(1.0, (0.3, 0, 0))),))
    within, beyond = (sf.export(moved(system, {"a": angle}), "c", tmp_path / str(angle)).notes for angle in (0.1, 1.0))
    dropped = [f"model 'plant': limits of {measure} dropped: a" for measure in ("travel", "speed", "effort")]
    assert [note for note in within if "limits" in note] == dropped
    assert (
        [note for note in beyond if note not in within]
        == [note for note in beyond if note.startswith("in the first 0.02 s: 'plant.a' leaves its limits, -0.5 to 0.5")]
        != []
    )


def test_a_singular_start_is_noted(tmp_path: Path) -> None:
    """As in a package of the model alone."""
    system = MODELS["four_bar"]
    alone = [note for note in sf.export(system, "c", tmp_path / "alone").notes if "singular posture" in note]
    flat = sf.export(moved(system, {}), "c", tmp_path / "flat").notes
    assert alone and {f"model 'plant': {note}" for note in alone} <= set(flat)
    assert not any("singular" in note for note in sf.export(moved(system, {"q1": 1.2}), "c", tmp_path / "off").notes)


def test_a_run_that_ends_early_is_noted(tmp_path: Path) -> None:
    """The self-test of the package then compares what there is no more of."""
    pushed = sf.Load(force=("exp(x^2)", 0, 0))
    body = sf.RigidBody(
        "b", sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Inertia(1.0, moments=(1, 1, 1)), loads=(pushed,)
    )
    diagram = moved(sf.System("pushed", (body,), gravity=(0, 0, 0)), {"x": 5.0})
    diagram.simulation = RunSettings(method="rk4", dt=0.01)
    assert any(
        "a run of the first 0.2 s ends at t = " in note for note in sf.export(diagram, "c", tmp_path / "c").notes
    )
