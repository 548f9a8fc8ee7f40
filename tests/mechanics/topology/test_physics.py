"""What run-time parameters may not take away from a joint: a moment of inertia about its axis."""

from __future__ import annotations

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import symofros as sf
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
