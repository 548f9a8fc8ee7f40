"""Speeds that move no mass: M is made all the same, an acceleration is refused in words."""

from __future__ import annotations

import pytest

import symofros as sf


def test_no_mass_no_acceleration() -> None:
    bodies = (
        sf.RigidBody("a", sf.Joint("q1", "revolute"), sf.Inertia(1.0, (0.5, 0, 0), (0.1, 0.1, 0.1))),
        sf.RigidBody("b", sf.Joint("q2", "revolute", "a"), None, waive=("massless_tip",)),
    )
    model = sf.compile(sf.System("s", bodies), sf.Options(backend="interpreter"))
    assert model.mass_matrix([0.1, 0.2])[1, 1] == 0.0
    with pytest.raises(sf.DescriptionError, match="speed 'q2' moves no mass"):
        model.forward_dynamics([0.1, 0.2], [0, 0], [])
