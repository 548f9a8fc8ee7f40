"""Boxes on rigid contacts: held, sliding, tipping, tumbling (docs/theory/constraints.md, section 15)."""

from __future__ import annotations

from math import cos, sin, tan

import numpy as np
import pytest

import symofros as sf
from tests.simulation.rigid_scenes import G, box, rested


@pytest.mark.parametrize("share", [1 + 1e-3, 1 - 1e-3])
def test_a_box_on_four_feet_holds_or_slides(share: float) -> None:
    """Its feet share the load in many ways: they hold as long as one is within the cones, and slide together."""
    angle = 0.3
    model = box(tan(angle) * share, (G * sin(angle), 0, -G * cos(angle)))
    run = sf.simulate(model, rested(model, 0.1), t_end=0.2, dt=1e-3, method="rk4")
    assert run.outcome.kind == "finished" and not run.outcome.notes and not run.events
    expected = G * sin(angle) * (1 - share) if share < 1 else 0.0
    assert abs(run.v[-1, 0] - 0.2 * expected) < 1e-12 * G
    assert np.abs(run.v[-1, 1:]).max() < 1e-12
    if share > 1:
        assert np.abs(run.q[-1] - run.q[0]).max() < 1e-15


@pytest.mark.parametrize(("height", "friction"), [(0.1, 0.5), (0.5, 0.9)])
def test_a_box_that_is_drawn_slides_or_tips(height: float, friction: float) -> None:
    """A force that grows lets it slide at mu m g, or a tall one tip about its front edge at m g b/h."""
    model = box(friction, height=height)
    run = sf.simulate(
        model, rested(model, height), u={"pull": "20*t"}, t_end=0.6, method="dopri5", rtol=1e-8, atol=1e-11
    )
    limit = 2 * G * min(friction, 0.2 / height)
    assert run.events[0].name.split()[-1] == ("slides" if friction < 0.2 / height else "opens")
    assert run.events[0].t == pytest.approx(limit / 20, abs=1e-7)
    assert run.v[-1, 0] > 0.0 and (abs(run.v[-1, 4]) > 0.1) == (friction > 0.2 / height)


def test_a_thrown_box_tumbles_to_rest() -> None:
    """Energy never rises, not by an impact and not between; no foot is below the ground, none is drawn to it."""
    model = box(0.5, e=0.3)
    q = rested(model, 0.5)
    q[3:7] = np.array([0.1, 0.2, 0.05, 0.97]) / np.linalg.norm([0.1, 0.2, 0.05, 0.97])
    run = sf.simulate(
        model,
        q,
        [0.3, 0.1, 0, 1, 2, 3],
        t_end=3.0,
        output=np.linspace(0, 3, 600),
        method="dopri5",
        rtol=1e-9,
        atol=1e-12,
    )
    assert run.outcome.kind == "finished" and len(run.events) > 30
    assert min(found.energy_lost for found in run.events) > -1e-12
    assert np.diff(run.energy).max() < 1e-8 and np.abs(run.v[-1]).max() < 1e-12
    gaps = model.contact_forces(run.q, run.v).gap
    normal = run.lam[:, [model.names.constraints.index(f"sole.{k}.normal") for k in range(4)]]
    assert gaps.min() > -1e-11 and normal.min() > -1e-8
