"""Names that formulas reserve, between backquotes where no coordinate has them."""

from __future__ import annotations

from dataclasses import replace

import pytest

import symofros as sf


@pytest.mark.parametrize("name", ["t", "pi"])
def test_the_remedy_for_a_reserved_name_in_backquotes_is_not_to_declare_it(name: str) -> None:
    """Nobody can declare a parameter of such a name."""
    inertia = sf.Inertia(1.0, (1, 0, 0))
    body = sf.RigidBody("b", sf.Joint("q", "revolute", "world", effort=f"2*`{name}`"), inertia)
    with pytest.raises(sf.DescriptionError) as caught:
        sf.compile(sf.System("s", (body,)), sf.Options(backend="interpreter"))
    assert f"no coordinate is called {name}" in str(caught.value) and "declare" not in str(caught.value).split("rem")[1]


def test_a_name_has_two_meanings_only_where_speeds_may_stand() -> None:
    """`door` is a coordinate, and the rate of `oor`: unclear in an effort, but not in a potential without speeds."""
    inertia = sf.Inertia(1.0, (1, 0, 0), (1, 1, 1))
    bodies = [sf.RigidBody(name, sf.Joint(name, "revolute"), inertia) for name in ("oor", "door")]
    potential = sf.System("s", bodies, potentials=(sf.Potential("spring", "3*door^2"),))
    model = sf.compile(potential, sf.Options(("potential_energy",), (), backend="interpreter"))
    assert model.potential_energy([0.3, 2.0]) == pytest.approx(12.0)
    assert bodies[1].joint is not None
    pushed = replace(bodies[1], joint=replace(bodies[1].joint, effort=("-3*door",)))
    with pytest.raises(sf.DescriptionError, match=r"'door' has two meanings[\s\S]*`door` for the coordinate"):
        sf.compile(sf.System("s", (bodies[0], pushed)), sf.Options(backend="interpreter"))
