"""Formats of columns."""

from __future__ import annotations

import pytest

from validation.reporting.numbers import Form


@pytest.mark.parametrize(
    ("form", "value", "shown"),
    [
        ("{:.1e}", 2e-15, "2.0e-15"),
        ("{:1e6*.1f}", 2.5e-5, "25.0"),
        ("{:1e3*.3g}", (0.001, 0.0025), "1, 2.5"),
        ("{:.2f}", None, "-"),
        ("{:time}", 3e-3, "3 ms"),
        ("{:compact}", [99.94, 341.0], "99.9, 341"),
        ("{:}", "words", "words"),
    ],
)
def test_columns_scale_list_and_name_numbers(form: str, value: object, shown: str) -> None:
    assert Form().of(form.replace("{", "{x"), {"x": value}) == shown
