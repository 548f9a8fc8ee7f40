"""Constraints that bind nothing, or what is not there: refused in words."""

from __future__ import annotations

from typing import Any

import pytest

import symofros as sf

SOLID = sf.Inertia(1.0, (0, 0, 0), (1, 1, 1))
BODIES = (
    sf.RigidBody("a", sf.Joint("p", "revolute"), SOLID, (sf.Frame("left"), sf.Frame("right"))),
    sf.RigidBody("b", sf.Joint("q", "revolute"), SOLID, (sf.Frame("end"),)),
)


@pytest.mark.parametrize(
    ("constraint", "said"),
    [
        (sf.Closure("k", ("a", "left"), ("a", "right")), ["both frames are on body 'a'", "two different bodies"]),
        (sf.Closure("k", ("c", None), ("a", None)), ["no body 'c'"]),
        (sf.Closure("k", ("a", "lefd"), ("b", "end")), ["'lefd'", "did you mean 'left'"]),
        (sf.Closure("k", ("a", "end"), ("b", None)), ["it is on body 'b'"]),
        (sf.Rod("k", ("a", None), ("b", None), -1.0), ["length -1", "positive"]),
        (sf.Rod("k", ("a", None), ("b", None), "q"), ["'q' may not be used here"]),
        (sf.Rolling("k", ("a", "left"), 0.0), ["radius 0"]),
        (sf.KnifeEdge("k", ("a", "middle")), ["'middle'"]),
        (sf.Nonholonomic("k", {"dr": 1.0}), ["'dr' is not a speed"]),
        (sf.Nonholonomic("k", {"dq": "dp"}), ["'dp' may not be used here"]),
    ],
)
def test_a_constraint_that_can_not_hold_is_refused(constraint: sf.Constraint, said: list[str]) -> None:
    with pytest.raises(sf.DescriptionError) as caught:
        sf.compile(sf.System("s", BODIES, constraints=(constraint,)))
    assert all(part in str(caught.value) for part in said), str(caught.value)


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
    ],
)
def test_a_constraint_is_refused_when_it_is_stated(make: Any, said: str) -> None:
    with pytest.raises(sf.DescriptionError, match=said):
        make()
