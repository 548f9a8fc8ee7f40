"""Friction that sticks: where its modes end."""

from __future__ import annotations

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
