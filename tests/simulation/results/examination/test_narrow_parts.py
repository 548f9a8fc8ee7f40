"""Parts of steps in which formulas of the state are looked at for what is narrow."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from symofros.simulation.results.examination.narrow_parts import (
    _BEYOND,
    _LOOKED_AT,
    _NEAR,
    NarrowPart,
    Stretch,
    _missed,
    _parts,
    _stretches,
)


def ends(seed: int) -> np.ndarray:
    return np.asarray(np.cumsum(np.random.default_rng(seed).uniform(0.01, 2.0, 9)) - 3.0)


@given(seed=st.integers(0, 10**6), step=st.integers(0, 7), at=st.floats(0.05, 0.95), apart=st.floats(1e-6, 0.9))
def test_two_instants_of_a_step_are_examined_together_and_singly(seed: int, step: int, at: float, apart: float) -> None:
    """Alone where they are farther apart than nearby: from the end of the step that is nearer."""
    t, other = ends(seed), min(at + apart, 0.99)
    places = np.array([at, other])
    assume(min(*np.abs(places - 0.5), abs(other - at - _NEAR[0])) > 1e-9)
    parts = _parts(t, t[step] + places * (t[step + 1] - t[step]))
    assert {part.step for part in parts} == {step}
    wider = _BEYOND * (other - at)
    expected = [(max(0.0, at - wider), min(1.0, other + wider))]
    if other - at > _NEAR[0]:
        alone = [(0.0, x) if x < 0.5 else (x, 1.0) for x in places]
        whole = [(max(0.0, a - _BEYOND * (b - a)), min(1.0, b + _BEYOND * (b - a))) for a, b in alone]
        expected = [*whole, *expected]
    np.testing.assert_allclose([part[1:] for part in parts], expected, atol=1e-9)


@pytest.mark.parametrize("step", [1, 4])
def test_an_instant_on_either_side_of_a_step_has_a_part_in_each(step: int) -> None:
    """What it belongs to may go on in the step beside it."""
    t = ends(3)
    h, after = np.diff(t)[step - 1], np.diff(t)[step]
    parts = _parts(t, np.array([t[step] - 0.02 * h, t[step] + 0.03 * after]))
    assert [part.step for part in parts] == [step - 1, step]
    np.testing.assert_allclose([part[1:] for part in parts], [(0.97, 1.0), (0.0, 0.045)], atol=1e-9)


def test_one_instant_alone_makes_no_part_and_many_are_bounded() -> None:
    t = np.arange(1001.0)
    assert _parts(t, np.array([3.2])) == []
    parts = _parts(t, np.sort(np.concatenate([np.arange(1000) + 0.3, np.arange(1000) + 0.35])))
    assert len(parts) == _LOOKED_AT and [part.step for part in parts[:3]] == [0, 1, 2]


def test_parts_that_follow_upon_each_other_leave_out_their_sum() -> None:
    """From the first begin to the last end, by the longest steps of any; fixed steps alone err together."""
    t, steps = np.array([0.0, 1.0, 3.0, 4.0, 5.0, 6.0]), (0, 1, 1, 4)
    parts = [
        NarrowPart(k, begin, end)
        for k, begin, end in zip(steps, (0.9, 0.0, 0.4, 0.2), (1.0, 0.1, 0.6, 0.3), strict=True)
    ]
    each, missed = [0.1, 0.2, 0.4, 0.1], [1.0, 0.5, 0.25, 2.0]
    alone = [Stretch(p.step, p.begin, p.step, p.end, x / 64, m) for p, x, m in zip(parts, each, missed, strict=True)]
    for whole, others in ((False, []), (True, [Stretch(0, 0.9, 1, 0.6, 0.4 / 64, 1.75)])):
        for order in ([0, 1, 2, 3], [2, 3, 0, 1]):
            found = _stretches(t, [parts[k] for k in order], [missed[k] for k in order], whole=whole)
            wanted = [*(alone[k] for k in order), *others]
            assert [tuple(one) for one in found] == [pytest.approx(tuple(one)) for one in wanted]


@pytest.mark.parametrize("t0", [-40.0, 0.0, 1e3])
@pytest.mark.parametrize("force", [2.5, -2.5])
def test_the_omission_of_a_path_is_a_force_times_its_length(t0: float, force: float) -> None:
    """Whatever the date; by the largest sum on the way, of a force that turns round half way."""
    for turns, share in ((False, 1.0), (True, 0.5)):

        def at(steps: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, ...]:
            assert (steps == 3).all() and x.min() > 0.2 and x.max() < 0.6
            return t0 + 0.5 * x, x[:, np.newaxis], np.zeros((len(x), 1)), np.full((len(x), 1), 7.0)

        def accelerations(t: np.ndarray, q: np.ndarray, v: np.ndarray, turns: bool = turns) -> tuple[np.ndarray, ...]:
            a = 7.0 + force * np.where(turns & (q > 0.4), -1.0, 1.0)
            return a, np.zeros((len(t), 0))

        run: Any = SimpleNamespace(
            stepper=SimpleNamespace(accelerations=accelerations), norms=lambda q, u, v: np.abs(v[:, 0])
        )
        path: Any = SimpleNamespace(at=at)
        left_out = _missed(run, path, NarrowPart(3, 0.2, 0.6))
        assert left_out == pytest.approx(abs(force) * 0.2 * share, rel=0.03)
