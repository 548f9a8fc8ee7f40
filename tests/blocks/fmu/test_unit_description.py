"""What ports are made of a unit's variables, without the unit."""

from __future__ import annotations

from dataclasses import replace

import pytest

from symofros.blocks.fmu.unit_description import UnitDescription, Variable, _port

SCALAR = Variable("gain", "input", "continuous", None, "Float64", "N", (), (2.5,))
VECTOR = replace(SCALAR, name="force", shape=(3,), start=(1.0, 2.0, 3.0), unit="m")
OUTPUT = replace(SCALAR, name="y", causality="output", start=(7.0,))


@pytest.mark.parametrize(
    ("direction", "given", "shape", "default"),
    [
        ("input", "gain", (), 2.5),
        ("input", "force", (3,), [1.0, 2.0, 3.0]),
        ("input", ("gain", "bare"), (2,), [2.5, 0.0]),
        ("output", "y", (), None),
    ],
)
def test_inputs_begin_as_their_variables_do(
    direction: str, given: str, shape: tuple[int, ...], default: object
) -> None:
    """A scalar by itself, an array by its entries, scalars side by side; zero where no start is stated."""
    variables = {one.name: one for one in (SCALAR, VECTOR, OUTPUT, replace(SCALAR, name="bare", start=None))}
    unit = UnitDescription("unit", "", "", ("co_simulation",), variables, False)
    port = _port("block", unit, direction, "u", given).port
    assert (port.shape, port.default) == (shape, default)
