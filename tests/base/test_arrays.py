"""What is no array of real numbers is refused in words, by every function that takes one."""

from __future__ import annotations

import datetime
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.base.arrays import real_array

NO_NUMBERS: dict[str, Any] = {
    "a text": "1.0",
    "texts": ["1.0"],
    "bytes": [b"1"],
    "None": [None],
    "a complex number": [1.0 + 2.0j],
    "complex with no imaginary part": np.array([1.0 + 0.0j]),
    "a date": [datetime.date(2020, 1, 1)],
    "a date of NumPy": np.array(["2020-01-01"], dtype="datetime64[D]"),
    "a span of NumPy": np.array([3], dtype="timedelta64[s]"),
    "a record": np.array([(1.0,)], dtype=[("x", float)]),
    "a set": {1.0},
    "rows of unequal length": [[1.0], [1.0, 2.0]],
}


@cache
def model() -> sf.Model:
    body = sf.RigidBody("b", sf.Joint("q", "revolute", actuated=True), sf.Inertia("m", (0, -0.5, 0), (0.1, 0.1, 0.1)))
    return sf.compile(sf.System("pendulum", (body,), parameters=(sf.Parameter("m", 1.0),), gravity=(0, -9.81, 0)))


# Each takes what is no array in one of its places.
TAKERS: dict[str, Callable[[Any], Any]] = {
    "q of a function": lambda x: model().mass_matrix(x),
    "par of a function": lambda x: model().mass_matrix([0.0], par=x),
    "q of integrate": lambda x: model().integrate(x, [0.0]),
    "q0 of simulate": lambda x: sf.simulate(model(), x, [0.0], 0.01),
    "par of simulate": lambda x: sf.simulate(model(), [0.0], [0.0], 0.01, par=x),
    "v0 of simulate_batch": lambda x: sf.simulate_batch(model(), [0.0], x, 0.01),
    "samples of a signal": lambda x: sf.Signal([0.0], x),
    "q of assemble": lambda x: sf.assemble(model(), x),
    "q of equilibrium": lambda x: sf.equilibrium(model(), x),
    "u of equilibrium": lambda x: sf.equilibrium(model(), [0.0], u=x),
    "q of modes": lambda x: sf.modes(model(), x),
    "q of inverse kinematics": lambda x: sf.inverse_kinematics(model(), {"b": sf.Target([0, 0, 0])}, x),
}


@pytest.mark.parametrize("taker", TAKERS)
@pytest.mark.parametrize("values", NO_NUMBERS)
def test_values_that_are_not_numbers_are_refused(taker: str, values: str) -> None:
    with pytest.raises(sf.ShapeError) as raised:
        TAKERS[taker](NO_NUMBERS[values])
    problem = raised.value.problem
    assert problem.found and problem.rule and problem.remedy


@pytest.mark.parametrize("value", [1, True, 1.5, np.float32(1.5), np.int8(3), Fraction(3, 2)])
def test_any_numeric_type_is_accepted(value: Any) -> None:
    array = real_array([value])
    assert array is not None and array.dtype == np.float64 and array[0] == float(value)
    assert real_array(value) is not None
