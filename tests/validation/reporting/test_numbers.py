"""Numbers as tables show them."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from validation.reporting.numbers import compact, duration, formatted


@pytest.mark.parametrize(
    ("form", "value", "shown"),
    [
        (".1e", 2e-15, "2.0e-15"),
        (".2f", None, "-"),
        ("d", 3, "3"),
        (duration, 3e-3, "3 ms"),
        (compact, [99.94, 341.0], "99.9, 341"),
    ],
)
def test_a_number_or_several_are_formatted_and_none_is_a_dash(
    form: str | Callable[[float], str], value: float | None, shown: str
) -> None:
    assert formatted(value, form) == shown
