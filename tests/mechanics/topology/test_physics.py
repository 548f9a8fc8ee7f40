"""Inertia that no body can have: stated, and made by run-time parameters."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import symofros as sf
from symofros.mechanics.topology import find_problems
from symofros.mechanics.topology.numbers import Numbers
from symofros.mechanics.topology.physics import has_physical_inertia
from symofros.mechanics.topology.run_time import RunTimeCheck

NAMES = ("x", "y", "z")
Triple = tuple[int, int, int]


@settings(max_examples=60)
@given(st.tuples(*[st.integers(-2, 2)] * 3), st.tuples(*[st.integers(-2, 2)] * 3), st.booleans())
def test_a_point_mass_turns_about_axes_that_miss_it_only(axis: Triple, center: Triple, on_axis: bool) -> None:
    """Whatever the axis, a mass without moments has one about it, unless the axis passes through the mass."""
    assume(any(axis))
    values = 2.0 * np.array(axis) if on_axis else np.array(center, dtype=float)
    body = sf.RigidBody("x", sf.Joint("q", "revolute", axis=axis), sf.Inertia(1.0, NAMES, (0, 0, 0)))
    system = sf.System("s", (body,), parameters=[sf.Parameter(name, 0.1 + i) for i, name in enumerate(NAMES)])
    problems = RunTimeCheck(system, NAMES).problems(values[None])
    assert any("moves no mass" in problem.what for problem in problems) != bool(np.cross(axis, values).any())


@settings(max_examples=60)
@given(st.integers(0, 10**6), st.sampled_from([(0.0, 1.0, 1.0), (0.3, 0.7, 1.0), (1.0, 1.0, 2.0)]), st.floats(-6, 6))
def test_rods_and_plates_in_any_place_are_physical(seed: int, moments: tuple[float, ...], size: float) -> None:
    """The largest moment is the sum of the others, to rounding; beyond a share of 1e-5 it is not that of a body."""
    turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))  # Inertias are the same in a mirror.
    for excess in (0.0, 1e-5):
        J = 10.0**size * turn @ np.diag([*moments[:2], moments[2] + excess]) @ turn.T
        inertia = sf.Inertia(1.0, (0, 0, 0), (J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]))
        body = sf.RigidBody("plate", sf.Joint("q", "revolute"), inertia)
        assert has_physical_inertia(body, Numbers(sf.System("s", [body]))) == (excess == 0.0)


@pytest.mark.parametrize("waived", [False, True])
@pytest.mark.parametrize(
    ("entries", "said"),
    [({"armature": "j"}, "armature -0.5"), ({"rotors": [sf.Rotor("j", 3.0)]}, "inertia of a rotor -0.5")],
)
def test_negative_inertia_of_rotors_is_refused_unless_waived(entries: dict[str, Any], said: str, waived: bool) -> None:
    waive = ("nonphysical_inertia",) if waived else ()
    body = sf.RigidBody("x", sf.Joint("q", "revolute", **entries), sf.Inertia(1.0, moments=(1, 1, 1)), waive=waive)
    for value in (-0.5, 0.0, 0.5):
        system = sf.System("s", (body,), parameters=[sf.Parameter("j", 0.5)])
        stated = sf.System("s", (body,), parameters=[sf.Parameter("j", value)])
        for problems in (RunTimeCheck(system, ("j",)).problems(np.array([[value]])), find_problems(stated)):
            assert [said in problem.what for problem in problems] == [True] * (value < 0.0 and not waived)
