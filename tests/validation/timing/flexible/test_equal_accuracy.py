"""The flexible robot is the same robot on both sides of its timing, and each side computes what it should."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from validation.timing.flexible import equal_accuracy
from validation.timing.flexible.equal_accuracy import (
    NotTheSameError,
    exudyn_frequencies,
    exudyn_robot,
    generated_frequencies,
    pairs,
    robot,
)
from validation.timing.flexible.loop import GeneratedLoop

# Of the two lowest frequencies, those of the elastic drive and of the first bending: three functions and two elements
# both have them to 1.3e-5.
LOWEST = 2e-5


def test_both_sides_are_one_robot() -> None:
    """Seven frequencies: drives, rotors, strips and what they carry are in all of them; hinges turn freely."""
    fine = exudyn_robot(12)
    expected = exudyn_frequencies(fine)
    np.testing.assert_allclose(generated_frequencies(3)[:2], exudyn_frequencies(exudyn_robot(2))[:2], rtol=LOWEST)
    assert fine.frequencies(3).max() < 1e-3 * expected[0]


@pytest.mark.slow
def test_robots_that_differ_are_not_timed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(equal_accuracy, "SAME_ROBOT", 1e-3)
    with pytest.raises(NotTheSameError, match="3 functions: frequencies err by 2.8e-02"):
        list(pairs([3]))


def test_the_timed_loop_matches_the_model(rng: np.random.Generator) -> None:
    system = robot(3)
    model = sf.compile(system, sf.Options(("dynamics", "bias"), backend="interpreter"))
    q, v = 0.01 * rng.standard_normal((4, model.nq)), rng.standard_normal((4, model.nv))
    loop = GeneratedLoop(system, ("dynamics", "bias"), q, v)
    expected = {"dynamics": model.dynamics(q, v, np.zeros(model.nu)), "bias": [model.bias(q, v)]}
    for name, outputs in expected.items():
        rows = np.concatenate([output.reshape(len(q), -1) for output in outputs], axis=1)
        np.testing.assert_allclose(loop.results(name), rows, rtol=1e-12, atol=1e-12)
