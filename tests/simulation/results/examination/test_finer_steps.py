"""What a comparison with finer steps concludes of runs whose changes are known: parts, refinements, notes."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
import pytest

from symofros.simulation.results.examination.finer_steps import (
    Changed,
    HeldRun,
    Part,
    States,
    change_of_states,
    finer_steps_note,
    percent,
)
from symofros.simulation.stepping.windows import WHOLE, Window, windows

H, START = 0.01, 5.0


@dataclass
class Held(HeldRun):
    """A run at rest in which a part of so many steps changes by `share(steps, refinements)`; None: it does not end."""

    steps: int
    share: Callable[[int, int], float | None]
    step: float = H
    source: str = ""
    jumping: bool = False
    made: list[tuple[Part, int, int]] = field(default_factory=list)  # Part, steps, refinements of what was made anew.

    def __post_init__(self) -> None:
        t = START + H * np.arange(self.steps + 1)
        self.states = (t, np.zeros((len(t), 1)), np.zeros((len(t), 1)))

    @property
    def h(self) -> float:
        return self.step

    @property
    def external(self) -> str:
        return self.source

    def coarse(self, window: Window, every: int) -> States | None:
        self.every = every
        return [np.array([self._length(window)])]

    def fine(self, window: Window, refinements: int, every: int) -> States | None:
        share = self.share(self._length(window), refinements)
        self.asked = self._length(window), refinements
        return None if share is None else [np.array([share])]

    def _length(self, window: Window) -> int:
        return round((window.t_end - float(self.states[0][window.first])) / H)

    def change(self, coarse: States, fine: States, part: Part) -> tuple[float, str]:
        self.made.append((part, *self.asked))
        return float(fine[0][0]), "arm"

    def jumps(self, fine: States) -> bool:
        return self.jumping or super().jumps(fine)


def listed(shares: Sequence[float]) -> Callable[[int, int], float]:
    return lambda _, k: shares[k - 1]


@pytest.mark.parametrize(
    ("shares", "jumping", "refinements", "largest"),
    [
        ([0.009], False, 1, 0.009),  # Within a tenth of the tolerance at once.
        ([0.009, 0.009], True, 2, 0.009),  # Speeds that jump: half the step may have the same error.
        ([0.02, 0.05, 0.055], False, 3, 0.055),
        ([0.05, 0.02, 0.011], False, 3, 0.05),
        ([0.02, 0.04, 0.06, 0.08], False, 4, 0.08),
        ([0.02, 0.101], False, 2, 0.101),
        ([math.nan], False, 1, math.nan),
    ],
)
def test_steps_are_halved_until_little_is_added(
    shares: list[float], jumping: bool, refinements: int, largest: float
) -> None:
    run = Held(100, listed(shares), jumping=jumping)
    changed = run.changed(Window(20, None, START + 60 * H), "run")
    assert [k for *_, k in run.made] == list(range(1, refinements + 1))
    assert changed.share == pytest.approx(largest, nan_ok=True)
    assert changed.t == START + 20 * H and changed.steps == 40 and changed.name == "arm" and changed.arrived
    assert changed.size == (math.inf if math.isnan(largest) else largest)


def test_a_part_of_less_than_a_step_counts_as_one() -> None:
    changed = Held(100, lambda _, k: 0.0).changed(Window(20, None, START + 20.3 * H), "run")
    assert changed.steps == 1


@pytest.mark.parametrize(("part", "step", "most"), [("run", H, 4), ("window", H, 1), ("run", 0.0, 1)])
def test_only_fixed_steps_of_whole_runs_are_halved_again(part: Part, step: float, most: int) -> None:
    run = Held(100, lambda _, k: 0.02 * k, step=step)
    run.changed(Window(0, 100, START + 100 * H), part)
    assert len(run.made) == most


@pytest.mark.parametrize("total", [0.029, 0.031, 0.099, 0.101, 2.0])
@pytest.mark.parametrize("power", [1.0, 2.0])
def test_changes_that_add_up_are_followed_until_it_is_clear_what_they_come_to(total: float, power: float) -> None:
    """Parts eight times as long each, until one changes too much or what is to come is a share of it."""
    steps = 5000
    run = Held(steps, lambda n, _: total * (n / steps) ** power)
    note = finer_steps_note(run)
    parts = [n for part, n, _ in run.made if part == "part"]
    first = run.made[0][1]
    lengths = [first * 8, first * 64, steps]
    beyond = [n for n in lengths if total * (n / steps) ** power > 0.1]
    if power == 2.0 and not beyond:  # The window tells as much.
        assert not parts
    else:
        followed = lengths[: lengths.index(beyond[0]) + 1] if beyond else lengths
        assert parts == (lengths[:1] if total < 0.03 else followed)
    assert bool(note) == bool(beyond)
    if beyond:
        assert f"half of that changes it by {percent(total * (beyond[0] / steps) ** power)} (seen at t = 5 s)" in note


@pytest.mark.parametrize(("share", "parts"), [(2.4e-6, 0), (2.6e-6, 1), (0.05, 3)])
def test_changes_that_grow_less_than_linearly_are_extrapolated_linearly(share: float, parts: int) -> None:
    """A part that is shorter than a period may show less; with the square of time it may come to a tenth, (17b)."""
    run = Held(5000, lambda n, _: share)
    assert run.may_add_up_to(Changed(share, START, 25)) == pytest.approx(share * 200.0**2)
    assert not finer_steps_note(run)
    assert len([n for part, n, _ in run.made if part == "part"]) == parts


def test_the_longest_part_is_bounded_and_compared_at_some_states() -> None:
    run = Held(100_000, lambda n, _: 0.09 * n / 100_000)
    assert not finer_steps_note(run)
    assert run.made[-1][1] == 20_000 and run.every == 78


@pytest.mark.parametrize(("external", "part"), [("", "run"), ("law", "window")])
@pytest.mark.parametrize("share", [0.099, 0.101])
def test_short_runs_are_made_once_more_unless_blocks_answer(external: str, part: Part, share: float) -> None:
    run = Held(WHOLE, lambda *_: share, source=external)
    note = finer_steps_note(run)
    assert {made[:2] for made in run.made} == {(part, 8 if external else WHOLE)}
    if external and share < 0.1:
        assert f"steps of {H:g} s are not held against half of that over all of the run, as 'law'" in note
        assert f"0.08 s of the motion of 'arm' change by {percent(share)} (seen at t = 5 s), which adds up" in note
    else:
        assert bool(note) == (share > 0.1)
        assert (", even where external" in note) == bool(external) and ("(seen at" in note) == bool(external)
    small = Held(WHOLE, lambda *_: 0.29 / 32**2, source="law")
    assert not finer_steps_note(small)


@pytest.mark.parametrize("step", [H, 0.0])
@pytest.mark.parametrize("longest", [0, 30, 300])
def test_finer_steps_that_do_not_come_to_the_end_are_noted(step: float, longest: int) -> None:
    """In a short run, in a window and in a part of a longer one."""
    run = Held(5000 if longest else 100, lambda n, _: None if n > longest else 1e-4 * n, step=step)
    note = finer_steps_note(run)
    finer, cure = ("half of that", "a smaller dt") if step else ("a hundredth of them", "tighter tolerances")
    assert f"with {finer} it does not come to this end" in note and note.endswith(cure)
    assert ("from t = 5 s" in note) == (longest == 0 and run.steps > WHOLE)


@pytest.mark.parametrize(("steps", "count", "length"), [(257, 1, 8), (5000, 1, 25), (49_999, 1, 249), (50_000, 2, 166)])
def test_windows_are_the_start_and_where_speeds_change_most(steps: int, count: int, length: int) -> None:
    t = H * np.arange(steps + 1)
    jumps = np.linspace(0, steps, count + 1, dtype=int)[:-1] + steps // (2 * count)
    v = np.cumsum(np.isin(np.arange(steps + 1), jumps + 1)[:, None] * [[1.0, -2.0]], axis=0)
    first, *others = windows(t, v, H, steps)
    assert (first.first, first.last) == (0, length) and first.t_end == t[length]
    assert [(one.first, one.last) for one in others] == [(i, i + length) for i in jumps]


@pytest.mark.parametrize(
    ("steps", "interval", "made_twice"),
    [(5000, 128, False), (5000, 129, True), (40_000, 800, False), (40_000, 801, True)],
)
def test_windows_between_distant_records_are_made_twice(steps: int, interval: int, made_twice: bool) -> None:
    """Records more than four windows and 128 steps apart."""
    t = H * interval * np.arange(steps // interval)
    window = windows(t, np.zeros((len(t), 1)), H, steps)[0]
    span = H * (25 if steps == 5000 else 200)
    assert (window.last, window.t_end) == ((None, span) if made_twice else (1, t[1]))


def test_states_change_in_the_mean_by_a_share_of_half_their_range() -> None:
    """The worst of them counts, whatever its unit; one that stands still is compared with rounding of what it is."""
    t = np.linspace(0.0, 1.0, 11)
    run = np.stack([300.0 + 4.0 * t, 1e-6 * np.cos(6.0 * np.pi * t), np.full(11, 2.0)], axis=1)
    off = np.zeros((5, 3))
    assert change_of_states(run, run[:5], run[:5]) == 0.0
    off[:, 0] = [0.1, -0.1, 0.3, 0.0, 0.0]
    assert change_of_states(run, run[:5], run[:5] + off) == pytest.approx(0.1 / 2.0, rel=1e-9)
    off[:, 1] = 2e-7
    assert change_of_states(run, run[:5], run[:5] + off) == pytest.approx(0.2, rel=1e-6)
    assert change_of_states(run[:, 2:], run[:5, 2:], run[:5, 2:] + 1e-12) == pytest.approx(1e-12 / 2e-11, rel=1e-3)
