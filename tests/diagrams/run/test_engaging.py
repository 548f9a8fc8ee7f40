"""Constraints that engage while they are not fulfilled: refused with the size, or said."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import symofros as sf
import symofros.blocks as blocks
from symofros.diagrams.run import projection
from symofros.simulation.results.engaging import ENGAGE_TOLERANCE
from tests.diagrams.parts import moving


def sliders(gap: float) -> sf.Diagram:
    """Two masses on one rail, `gap` apart, that a closure holds together from 0.02 s on."""
    rail = (
        sf.RigidBody(n, sf.Joint(n, "prismatic", axis=(1, 0, 0)), sf.Inertia(m)) for n, m in (("x", 1.0), ("y", 3.0))
    )
    grip = sf.Closure("grip", ("x", None), ("y", None), ("x",))
    system = sf.System("plant", tuple(rail), constraints=(grip,))
    diagram = moving(system, {"y": gap, "dx": 0.0}, engaged="grip.y")
    diagram.add(blocks.Step(name="grip", time=0.02, before=[0.0], after=[1.0], period=0.01))
    return diagram


@pytest.mark.parametrize("gap", [2.0 * ENGAGE_TOLERANCE, 0.7, 0.5 * ENGAGE_TOLERANCE, 0.0])
def test_a_large_gap_ends_the_run_and_a_small_one_is_closed_with_a_note(gap: float) -> None:
    """With its size and the input that engages; a small one is closed and said, none is closed in silence."""
    simulation = sf.Simulation(sliders(gap))
    for run in (simulation.run(0.05, dt=1e-3, record=0.01), simulation.interpret(0.05, dt=1e-3, record=0.01)):
        if gap > ENGAGE_TOLERANCE:
            assert run.outcome.kind == "constraints lost" and run.outcome.t == pytest.approx(0.02)
            assert "'plant.engaged[0]'" in run.outcome.reason and f"|phi| = {gap:.3g}" in run.outcome.reason
            assert np.array_equal(run["plant.q"][-1], [0.0, gap])
            continue
        assert run.outcome.kind == "finished" and np.ptp(run["plant.q"][-1]) < 1e-12
        said = [f"{gap:.2g}" in note for note in run.outcome.notes if "closed a gap of |phi|" in note]
        assert said == [True] * (gap > 0.0) and (gap > 0.0 or not run.outcome.notes)


def test_engaging_a_weld_half_a_turn_off_ends_the_run() -> None:
    """Its conditions are fulfilled there, too: without a word it would hold four directions of six."""
    mass = sf.Inertia(1.0, (0, 0, 0), (0.1, 0.2, 0.25))
    bodies = tuple(sf.RigidBody(n, sf.Joint(n, "free"), mass) for n in "ab")
    weld = sf.Closure("weld", ("a", None), ("b", None), ("x", "y", "z"), ("x", "y", "z"))
    system = sf.System("plant", bodies, constraints=(weld,), gravity=(0, 0, 0))
    turned = {"b.qx": 0.6, "b.qy": 0.8, "b.qz": 0.0, "b.qw": 0.0}
    diagram = moving(system, start=turned, engaged="grip.y")
    diagram.add(blocks.Step(name="grip", time=0.02, before=[0.0], after=[1.0], period=0.01))
    run = sf.Simulation(diagram).run(0.05, dt=1e-3, record=0.01)
    assert run.outcome.kind == "constraints lost"


@pytest.mark.parametrize("engaged", [(1.0, 0.0, 1.0), (1.0, 1.0, 0.0), (0.0, 0.0, 0.0)])
def test_the_constraint_that_engages_apart_is_named(
    engaged: tuple[float, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The one that holds and did not before; all of them where none has begun to. The state stays."""

    def apart(scene: Any) -> float:
        scene.q[:] = 7.0
        return 1.0

    monkeypatch.setattr(projection, "project_all", apart)
    names = ("first", "second", "third")
    resolved = SimpleNamespace(layout=SimpleNamespace(lock_names=names))
    scene: Any = SimpleNamespace(q=np.ones(2), v=np.zeros(2), engaged=lambda: np.array(engaged), resolved=resolved)
    before = np.array([1.0, 0.0, 0.0])
    rising = [name for name, now, then in zip(names, engaged, before, strict=True) if now > then]
    with pytest.raises(projection.EngagedApartError) as caught:
        projection.engage(scene, before)
    assert caught.value.args[-1] == (rising[-1] if rising else "first, second, third") and scene.q.tolist() == [
        1.0,
        1.0,
    ]
