"""Thousands of motions, few here: both sides move the same arm, and the report says what was measured."""

from __future__ import annotations

import pytest

from validation.studies import rollouts


@pytest.mark.parametrize("threads", [1, 2])
def test_both_sides_move_the_same_arm(threads: int) -> None:
    rows = rollouts.run(1, trajectories=19, steps=20, threads=threads)
    assert [row.motion for row in rows] == ["PD control"] * 4 + ["let go"] * 4
    for motion in ("PD control", "let go"):
        engine, generated, adaptive, first_order = (row for row in rows if row.motion == motion)
        assert engine.ratio == 1.0 and engine.steps == generated.steps == 19 * 20
        # The same method and step: alike to a fraction of their error, which is above rounding under control.
        assert 0 < generated.error < 1e-5 and engine.error == pytest.approx(generated.error, rel=0.05, abs=1e-12)
        assert adaptive.error < 1e-5 < first_order.error < 0.1
        assert all(row.nanoseconds[0] > 0 for row in rows)
