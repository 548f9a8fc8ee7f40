"""The harness's own rod: an adaptive integration of the same strains; its rates are in `test_carried.py`."""

from __future__ import annotations

import numpy as np
import pytest

from tests.mechanics.beams.rods import integrated, rod
from validation.mechanics.rod import StrainRod


def test_rod_sections_match_an_adaptive_integration(rng: np.random.Generator) -> None:
    counts, stations = (3, 2, 2), np.array([0.0, 0.3, 0.75, 1.0])
    q = 0.5 * rng.standard_normal((1, 7))
    one = StrainRod(rod(counts), {})
    p, R = integrated(counts, q[0], stations)
    assert one.axis(one.length * stations, q, 0 * q).value[0] / one.length == pytest.approx(p, abs=1e-11)
    assert one.rotation(one.length * stations, q, 0 * q).R[0] == pytest.approx(R, abs=1e-11)
