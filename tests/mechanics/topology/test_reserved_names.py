"""Names that formulas reserve, between backquotes where no coordinate has them."""

from __future__ import annotations

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
