"""A description is no model: what takes a model says how to make one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import symofros as sf
from reference_models import MODELS

CALLS: dict[str, Callable[[Any], Any]] = {
    "simulate": sf.simulate,
    "simulate_batch": lambda model: sf.simulate_batch(model, [[0.0]], [[0.0]], 1.0),
    "equilibrium": sf.equilibrium,
    "modes": lambda model: sf.modes(model, [0.0]),
    "assemble": lambda model: sf.assemble(model, [0.0]),
}


@pytest.mark.parametrize("name", CALLS)
@pytest.mark.parametrize(("given", "remedy"), [(MODELS["cart_pole"], "sf.compile"), ("cart_pole.yaml", "sf.load")])
def test_a_description_is_no_model(name: str, given: object, remedy: str) -> None:
    with pytest.raises(sf.SymofrosError, match=rf"there is no compiled model(.|\n)*{remedy}"):
        CALLS[name](given)
