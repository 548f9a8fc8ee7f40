"""A mechanism shown while a run goes on, without a browser."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.blocks import ForwardDynamics, Sequence, View3D
from symofros.blocks.graphics.view import with_view

PATIENCE = 10.0


def arm(system: sf.System = MODELS["double_pendulum"]) -> sf.Diagram:
    d = sf.Diagram("arm")
    d.add_model("arm", system, {"q1": 0.5}, {"L1": 0.8})
    d.add(ForwardDynamics(name="plant", model="arm"))
    return d


def shown(**fields: Any) -> tuple[sf.Simulation, View3D]:
    diagram, block = with_view(arm(), open_browser=False, **fields)
    return sf.Simulation(diagram), block


@pytest.fixture
def viewed() -> Iterator[tuple[sf.Simulation, View3D]]:
    simulation, block = shown()
    yield simulation, block
    block.close()


def until_shown(block: View3D, q: np.ndarray, u: np.ndarray | None = None) -> None:
    deadline = time.monotonic() + PATIENCE
    assert block.viewer is not None
    while not (np.array_equal(block.viewer.state.q, q) and (u is None or np.allclose(block.viewer.state.u, u))):
        assert time.monotonic() < deadline, "the last state was not shown"
        time.sleep(0.005)


def test_the_view_shows_the_run_without_changing_it(
    viewed: tuple[sf.Simulation, View3D], capsys: pytest.CaptureFixture[str]
) -> None:
    simulation, block = viewed
    assert block.viewer is None
    run = simulation.run(0.4, dt=1e-2)
    plain = sf.Simulation(arm()).run(0.4, dt=1e-2)
    assert np.allclose(run["plant.q"], plain["plant.q"], rtol=0, atol=1e-14)
    assert block.viewer is not None and block.viewer.url in capsys.readouterr().err
    until_shown(block, run["plant.q"][-1])
    kept = run.kept["view3d"]
    assert kept["shown"] == 11 and 0 <= kept["dropped"] < 11  # Every 0.04 s.
    # Drawn with the parameters that the diagram states.
    elbow = block.viewer._server.scene.get_handle_by_name("/mechanism/link1").position
    assert np.linalg.norm(elbow) == pytest.approx(0.8)


def test_a_new_page_opens_only_for_another_model(viewed: tuple[sf.Simulation, View3D]) -> None:
    """One block in two diagrams, of which one has another model in place of the first; one page for all runs of one."""
    simulation, block = viewed
    simulation.run(0.1, dt=1e-2)
    first = block.viewer
    assert simulation.run(0.2, dt=1e-2).kept["view3d"]["shown"] == 6
    assert simulation.interpret(0.1, dt=1e-2).kept["view3d"]["shown"] == 3 and block.viewer is first
    setup = replace(simulation.diagram.models["arm"], system=MODELS["pendulum"], start={}, parameters={})
    other = sf.Simulation(simulation.diagram.with_model("arm", setup))
    for one, nq in ((simulation, 2), (other, 1), (simulation, 2)):
        run = one.run(0.08, dt=1e-2)
        assert block.viewer is not None and block.viewer.mechanism.model.nq == nq
        until_shown(block, run["plant.q"][-1])


def test_the_viewer_closes_with_the_run_if_asked() -> None:
    simulation, block = shown(stays=False)
    simulation.run(0.1, dt=1e-2)
    first = block.viewer
    assert first is not None and first.is_closed
    simulation.run(0.1, dt=1e-2)
    assert block.viewer is not first and block.viewer is not None and block.viewer.is_closed


def test_prescribed_motions_are_shown() -> None:
    t = np.array([0.0, 1.0])
    d = sf.Diagram("spin")
    d.add_model("beam", MODELS["spinning_beam"])
    d.add(Sequence(name="hub", t=t, values=np.stack([3 * t, 3 + 0 * t, 0 * t], axis=1)))
    d.add(ForwardDynamics(name="plant", model="beam"), u="hub.y")
    diagram, block = with_view(d, open_browser=False)
    run = sf.Simulation(diagram).run(0.2, dt=1e-3)
    until_shown(block, run["plant.q"][-1], np.array([0.6, 3.0, 0.0]))  # Its q stays zero: the beam spins steadily.
    block.close()


def test_a_missing_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "viser", None)
    simulation, _ = shown()
    with pytest.raises(sf.SymofrosError, match=r"viser is not installed\n(.*\n)*  remedy: pip install 'symofros"):
        simulation.run(0.1, dt=1e-2)


@pytest.mark.parametrize("fields", [{"port": 70000}, {"exaggeration": float("nan")}])
def test_invalid_view_fields_are_refused(fields: dict[str, Any]) -> None:
    with pytest.raises(sf.DescriptionError, match="block 'view3d': can't show that"):
        shown(**fields)
