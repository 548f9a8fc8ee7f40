"""Pieces of C: what a compiler makes of them is what was meant."""

from __future__ import annotations

import math

import pytest

from symofros.base.c_text import doubles

MEANT = {"HUGE_VAL": math.inf, "-HUGE_VAL": -math.inf, "NAN": math.nan}


@pytest.mark.parametrize("count", [0, 1, 8, 9, 20])
def test_initialisers_have_the_values_in_their_order(count: int) -> None:
    values = [(-1.0) ** k * 0.1 * 10.0 ** (30 * k - 300) for k in range(count)]
    values[5:8] = [math.inf, -math.inf, math.nan][: len(values[5:8])]
    read = [MEANT[text] if text in MEANT else float(text) for text in doubles(values).replace("\n", " ").split(", ")]
    assert list(map(repr, read)) == list(map(repr, values or [0.0]))
