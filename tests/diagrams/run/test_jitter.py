"""How late instants of a run were."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from symofros.diagrams.rates import schedule
from symofros.diagrams.run.jitter import jitter_of
from symofros.diagrams.run.recording import Cost


def cost(late: list[float], spacing: float = 1e-3) -> Cost:
    return Cost("rk4", 0, 0, 0, 0, 0.0, late=np.array(late), spacing=spacing)


def test_jitter_statistics_follow_from_the_times() -> None:
    found = jitter_of(cost([1e-6] * 499 + [5e-6] * 500 + [2e-3]))
    assert (found.minimum, found.median, found.maximum, found.instants) == (1e-6, 5e-6, 2e-3, 1000)
    assert 5e-6 < found.p999 < 2e-3 and found.missed == 1
    assert "median 5.0" in str(found) and "1 missed the next instant, 1 ms later" in str(found)
    assert jitter_of(cost([6e-4] * 3, 5e-4)).missed == 3 and jitter_of(cost([6e-4] * 3)).missed == 0


def test_jitter_needs_a_real_time_run() -> None:
    with pytest.raises(sf.SymofrosError, match="run with realtime=True"):
        jitter_of(cost([]))


@pytest.mark.parametrize(
    ("rates", "spacing"),
    [
        ([("a", 0.01, 0.0)], 0.01),
        ([("a", 0.01, 0.0), ("b", 0.003, 0.0)], 0.001),
        ([("a", 0.01, 0.0), ("b", 0.01, 0.004)], 0.004),
        ([("a", 0.01, 0.0), ("b", 0.01, 0.007)], 0.003),
        ([], float("inf")),
    ],
)
def test_schedules_report_the_shortest_interval(rates: list[tuple[str, float, float]], spacing: float) -> None:
    assert schedule(rates, "d").spacing == pytest.approx(spacing)
