"""Constraints that bind nothing, or what is not there, beside those of problems.txt: refused in words."""

from __future__ import annotations

from typing import Any

import pytest

import symofros as sf

SOLID = sf.Inertia(1.0, (0, 0, 0), (1, 1, 1))
BODIES = (
    sf.RigidBody("a", sf.Joint("p", "revolute"), SOLID, (sf.Frame("left"), sf.Frame("right"))),
    sf.RigidBody("b", sf.Joint("q", "revolute"), SOLID, (sf.Frame("end"),)),
)


def test_names_are_unique() -> None:
    same = [sf.Rod("k", ("a", None), ("b", None), 1.0)] * 2
    with pytest.raises(sf.DescriptionError, match="'k' appears 2 times"):
        sf.compile(sf.System("s", BODIES, constraints=tuple(same)))


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: sf.Closure("k", ("a", None), ("b", None), ("x", "w")), "unknown direction"),  # type: ignore[arg-type]
        (lambda: sf.Closure("k", ("a", None), ("b", None), ()), "blocks nothing"),
        (lambda: sf.KnifeEdge("k", ("a", None), "u"), "unknown direction"),  # type: ignore[arg-type]
        (lambda: sf.Rolling("k", ("a", None), 1.0, "cube"), "a disc or a sphere"),  # type: ignore[arg-type]
        (lambda: sf.Nonholonomic("k", {}), "binds no speed"),
        (lambda: sf.Coupling("k", "pi - 3"), "binds no coordinate"),
    ],
)
def test_a_constraint_is_refused_when_it_is_stated(make: Any, said: str) -> None:
    with pytest.raises(sf.DescriptionError, match=said):
        make()


def test_a_ratio_of_zero_locks_the_follower() -> None:
    """A joint that mimics another by a multiplier of zero stays at the offset, as MuJoCo's does."""
    system = sf.System("s", BODIES, constraints=(sf.Coupling("k", "q - 0*p - 0.5"),), gravity=(0, -9.81, 0))
    run = sf.simulate(sf.compile(system), {"q": 0.5, "p": 0.1}, {"p": 1.0}, t_end=0.1)
    assert run.q[-1] == pytest.approx([0.2, 0.5], abs=1e-12)


def test_a_coupling_of_prescribed_coordinates_alone_binds_nothing() -> None:
    led = sf.RigidBody("a", sf.Joint("p", "revolute", prescribed=True), SOLID)
    with pytest.raises(sf.DescriptionError, match="binds no coordinate"):
        sf.compile(sf.System("s", (led, BODIES[1]), constraints=(sf.Coupling("k", "p - 1"),)))


def test_conditions_nonlinear_in_speeds_have_their_own_message() -> None:
    """Not in those for potentials, which share the names that they may use."""
    upright = sf.Nonholonomic("upright", (("dq", "dp"),))
    bodies = (
        sf.RigidBody("a", sf.Joint("q", "prismatic"), sf.Inertia(1.0)),
        sf.RigidBody("b", sf.Joint("p", "prismatic"), sf.Inertia(1.0)),
    )
    with pytest.raises(sf.DescriptionError) as caught:
        sf.compile(sf.System("points", bodies, constraints=(upright,)))
    problem = caught.value.problems[0]
    assert "linear in" in problem.rule and "potential" not in str(problem)
    assert "product of two" in problem.remedy
