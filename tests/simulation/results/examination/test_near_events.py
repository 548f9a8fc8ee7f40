"""Turns of events near to zero, by parabolas (docs/theory/simulation.md, (18j))."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from symofros.simulation.results.examination.near_events import _NEAR, _ROUNDING, Turn, _turns


@given(
    seed=st.integers(0, 10**6),
    at=st.floats(-0.4, 0.4),
    share=st.floats(1e-3, 0.9),
    side=st.sampled_from([-1.0, 1.0]),
    t0=st.sampled_from([0.0, 1e3]),
)
def test_a_turn_is_the_vertex_of_a_parabola(seed: int, at: float, share: float, side: float, t0: float) -> None:
    """Between records at any distances; of an event that counts on the way to zero, and not of one that leaves it."""
    t = np.cumsum(np.random.default_rng(seed).uniform(0.05, 0.3, 16))
    t += t0 - t[8]
    bend = 2.0
    reach = bend * np.ptp((t - t0 - at) ** 2)
    distance = share * _NEAR * reach
    g = side * (distance + bend * (t - t0 - at) ** 2)
    for sign in (0, -int(side)):
        assert list(_turns(3, sign, t, g)) == [pytest.approx(Turn(3, t0 + at, distance), rel=1e-6, abs=1e-9)]
    assert not list(_turns(3, int(side), t, g))


@pytest.mark.parametrize("share", [1.01 * _NEAR, 0.5 * _ROUNDING])
def test_a_turn_far_from_zero_or_there_by_rounding_is_none(share: float) -> None:
    t = np.linspace(-1.0, 1.0, 9)
    assert not list(_turns(0, 0, t, share + t**2))
