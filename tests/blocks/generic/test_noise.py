"""The random number generator: against whole numbers, published states, and statistics."""

from __future__ import annotations

import numpy as np
import pytest

from symofros.blocks import Noise
from symofros.blocks.generic.noise import stream
from tests.blocks.support import STEP, run
from tests.late import late

stats = late("scipy.stats")

M1, M2 = 2**32 - 209, 2**32 - 22853


def uniforms(state: list[int], count: int) -> list[float]:
    """MRG32k3a in whole numbers, as in L'Ecuyer's paper of 1999."""
    x, y, found = state[:3], state[3:], []
    for _ in range(count):
        x = [*x[1:], (1403580 * x[1] - 810728 * x[0]) % M1]
        y = [*y[1:], (527612 * y[2] - 1370589 * y[0]) % M2]
        found.append(((x[2] - y[2]) % M1 or M1) / (M1 + 1))
    return found


def test_streams_match_rngstreams() -> None:
    # The states that the authors' package RngStreams gives its first three streams.
    assert stream(0, 0) == [12345] * 6
    assert stream(1, 0) == [3692455944, 1366884236, 2968912127, 335948734, 4161675175, 475798818]
    assert stream(2, 0) == [1015873554, 1310354410, 2249465273, 994084013, 2912484720, 3876682925]
    # And its first number.
    assert uniforms([12345] * 6, 1)[0] == pytest.approx(0.127011122046577, abs=1e-15)


def test_uniform_numbers_match_the_streams_in_python_and_c() -> None:
    block = Noise(name="n", seed=3, size=3, kind="uniform", scale=0.5, mean=0.5, period=STEP)
    found = run(block, t_end=5.0, compare=1e-300)["y"]
    expected = np.array([uniforms(stream(3, i), len(found)) for i in range(3)]).T
    # (2 u - 1) / 2 + 1/2 rounds twice.
    np.testing.assert_allclose(found, expected, atol=2.3e-16)


def test_normal_numbers_follow_box_and_muller() -> None:
    block = Noise(name="n", seed=8, period=STEP, scale=2.0)
    found = run(block, t_end=20.0, compare=1e-300, compiled=True)["y"]
    # NumPy does not fuse the angle into the cosine's reduction: a unit in the last place.
    run(block, t_end=2.0, compare=4e-16)
    u = np.array(uniforms(stream(8, 0), 2 * len(found))).reshape(-1, 2)
    np.testing.assert_allclose(found, 2 * np.sqrt(-2 * np.log(u[:, 0])) * np.cos(2 * np.pi * u[:, 1]), atol=1e-14)
    # A false alarm once in a thousand seeds; the seed is fixed.
    assert stats.kstest(found / 2, "norm").pvalue > 1e-3
