"""What run-time parameters may not take away from a joint: a moment of inertia about its axis."""

from __future__ import annotations

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import symofros as sf
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
