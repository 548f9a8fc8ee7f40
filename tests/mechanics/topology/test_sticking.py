"""Friction that sticks: where its modes end."""

from __future__ import annotations

from typing import Literal

import pytest

import symofros as sf
from symofros.mechanics.topology.conditions import Formulas
from symofros.mechanics.topology.sticking import sticking_coordinates


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_modes_end_beyond_the_rounding_of_a_joint_that_begins_to_move(way: float) -> None:
    """Sliding forwards or backwards at a speed against it, held at the force of breaking away (36)."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(sf.Friction(1.5, 2.0, sticks=True),))
    (one,) = sticking_coordinates(joint)

    def watch(mode: float, speed: float, force: float) -> float:
        at = {one.mode: mode, one.key: speed, f"lam.{one.condition}": force}
        return float(Formulas([one.watch])(at)[0])

    assert watch(way, -1e-15 * way, 0.0) > 0.0 > watch(way, -1e-13 * way, 0.0)
    assert watch(way, 0.3 * way, 5.0) == pytest.approx(0.3)
    assert watch(2.0, 0.0, way * 1.5) == pytest.approx(2.0**2 - 1.5**2)


def test_any_coordinate_of_a_joint_sticks_as_a_slide_does() -> None:
    """The length of a cylindrical joint, which turns at a constant rate meanwhile."""

    def run(kind: Literal["cylindrical", "prismatic"], q: list[float], v: list[float]) -> sf.Trajectory:
        number = len(q) - 1
        elements = (sf.Spring(40.0, coordinate=number), sf.Friction(1.0, 1.5, coordinate=number, sticks=True))
        joint = sf.Joint("c", kind, axis=(0, 0, 1), elements=elements)
        body = sf.RigidBody("b", joint, sf.Inertia(2.0, moments=(0.1, 0.1, 0.1)))
        options = sf.Options(backend="tape")
        model = sf.compile(sf.System("held", (body,), gravity=(0, 0, 0)), options)
        return sf.simulate(model, q, v, 2.0, method="dopri5", rtol=1e-9, atol=1e-11)

    both, alone = run("cylindrical", [0.3, 0.2], [0.5, 1.0]), run("prismatic", [0.2], [1.0])
    assert [found.t for found in both.events] == pytest.approx([found.t for found in alone.events], abs=1e-7)
    assert both.q[-1] == pytest.approx([0.3 + 0.5 * 2.0, alone.q[-1, 0]], abs=1e-7) and len(alone.events) > 1
