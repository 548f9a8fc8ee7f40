"""Times are minima and medians of turns; sides that disagree are not timed."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from validation.timing import race as racing
from validation.timing.race import DisagreementError, checked, error, race
from validation.timing.task import Loop


def test_sides_run_in_turn_and_times_are_per_state(monkeypatch: pytest.MonkeyPatch) -> None:
    """By a clock of our own: one side takes 2 ms a round, the other 6."""
    clock, order = [0], []
    monkeypatch.setattr(racing, "thread_time_ns", lambda: clock[0])

    def side(name: str, nanoseconds: int) -> Loop:
        def run(rounds: int) -> None:
            order.append(name)
            clock[0] += rounds * nanoseconds

        return Loop("bias", name, run, lambda: np.zeros((1, 1)))

    times = race({"a": side("a", 2_000_000), "b": side("b", 6_000_000)}, 1000, 5)
    assert (times["a"].median, times["b"].median) == (2000.0, 6000.0)
    assert order[-10:] == ["a", "b"] * 5
    assert Counter(order)["a"] == Counter(order)["b"]


def test_an_error_is_relative_to_the_largest_entry_of_a_state() -> None:
    expected = np.array([[1.0, 100.0], [0.0, 2.0]])
    assert error(expected + [[0.0, 0.0], [0.5, 0.0]], expected) == 0.25
    assert error(expected, expected) == 0.0


def test_sides_that_disagree_are_named() -> None:
    assert checked("bias", "them", np.array([[1.0 + 1e-14]]), np.array([[1.0]])) < 1e-13
    with pytest.raises(DisagreementError, match="their times mean nothing"):
        checked("bias", "them", np.array([[1.0 + 1e-11]]), np.array([[1.0]]))
    with pytest.raises(DisagreementError, match="2 numbers a state, not 1"):
        checked("bias", "them", np.zeros((1, 2)), np.zeros((1, 1)))
