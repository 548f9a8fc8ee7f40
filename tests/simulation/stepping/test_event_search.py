"""The search for zeros along steps, by itself: what it makes of functions that are known by their values."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from symofros.runtime.calls.binding import NativeMemory, constants, native_library

Function = Callable[[float], float]


def searched(functions: list[Function], h: float) -> tuple[list[float], int]:
    """Zeros over steps, in steps, and how often the functions, one a step over [0, 1], were evaluated."""
    native, memory, known = native_library(), NativeMemory(), constants()
    values, evaluated, k = np.zeros((known["SYM_EVENT_ROWS"], 1)), 0, 0

    def evaluate(_: Any, x: float, value: Any) -> int:
        nonlocal evaluated
        evaluated += 1
        value[0] = functions[k](x)
        return 0

    search = memory.own("sym_event_search[]", 1)
    search[0].n, search[0].direction, search[0].memory = 1, memory.own("int32_t[]", [0]), memory.shared(values)
    search[0].evaluate = memory.callback("int32_t(void *, double, double *)", evaluate)
    values[0], values[known["SYM_EVENT_EARLIER"]] = functions[0](0.0), np.nan
    which, x, found = memory.own("int32_t[]", 1), memory.own("double[]", 1), list[float]()
    for k in range(len(functions)):
        native.sym_event_search_set_step(search, k * h, h, 0.01, k + 1)
        assert native.sym_event_search_begin(search) == 0
        while native.sym_event_search_next(search, which, x) == 0 and which[0] >= 0:
            found.append(k + x[0])
        values[0] = values[known["SYM_EVENT_NODES"] - 1]
    return found, evaluated


def cubic(level: float, size: float, turn: float) -> Function:
    """A cubic at the level at both ends of a step."""
    return lambda x: level + size * x * (1.0 - x) * (x - turn)


@pytest.mark.parametrize("h", [0.005, 0.05])
@pytest.mark.parametrize("seed", range(4))
def test_a_function_and_its_negative_have_the_same_zeros(seed: int, h: float) -> None:
    """Falling as rising, near zero and far from it: the same zeros by the same evaluations."""
    rng = np.random.default_rng(seed)
    drawn = [(0.1, float(rng.uniform(-3.0, 3.0)), float(rng.uniform(-0.5, 1.5))) for _ in range(40)]
    up, down = ([cubic(sign * a, sign * b, c) for a, b, c in drawn] for sign in (1.0, -1.0))
    assert searched(up, h) == searched(down, h)


@pytest.mark.parametrize("h", [0.005, 0.05])
def test_zeros_are_those_of_the_function_where_it_crosses_in_each_step(h: float) -> None:
    rng = np.random.default_rng(7)
    functions, wanted = list[Function](), list[float]()
    for k in range(40):
        size, turn = float(rng.uniform(1.0, 3.0)), float(rng.uniform(0.0, 1.0))
        functions.append(cubic(0.02, size, turn))
        zeros = np.roots([-size, size * (1.0 + turn), -size * turn, 0.02])
        wanted += sorted(k + z.real for z in zeros if abs(z.imag) < 1e-12 and 0.0 < z.real < 1.0)
    found, _ = searched(functions, h)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-8)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("least", [1e-20, 1e-100, 2.3e-308])
@pytest.mark.parametrize("zero", [0.0, 0.1, 0.2319, 0.5])
def test_a_zero_beside_an_end_that_is_next_to_nothing_is_located(zero: float, least: float, sign: float) -> None:
    """A signal that is just below zero up to some instant, and passes zero from there on."""
    found, evaluated = searched([lambda x: -sign * least if x <= zero else sign * (x - zero)], 0.01)
    assert found == pytest.approx([zero], abs=1e-9) and evaluated < 500
