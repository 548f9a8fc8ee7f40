"""The mass matrix by entries; that they are the whole of it is asked in test_momentum.py, beside C."""

from __future__ import annotations

from tests.models import model


def test_speeds_on_different_branches_have_no_entry() -> None:
    rows, _ = model("tree2").mass_matrix_pattern()
    assert len(rows) < model("tree2").nv * (model("tree2").nv + 1) // 2
