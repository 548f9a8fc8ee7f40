"""Which intervals are made once more where energy has no source, and what their change tells: runs that state it."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from symofros.diagrams.run.examination.energy_balance import _Doubts, _is_numerical, energy_note


def judged(
    gained: np.ndarray,
    kinetic: np.ndarray,
    change: Callable[[int, int], float | None],
    unseen: float = 0.0,
    evident: bool = True,
    h: float = 0.01,
) -> tuple[bool, list[tuple[int, int]]]:
    """The verdict on intervals that change by `change(interval, level)`, and which were made once more."""
    made: list[tuple[int, int]] = []
    states = [np.arange(len(kinetic)), np.zeros((len(kinetic), 1)), np.zeros((len(kinetic), 1))]

    def repeat(first: int, t_end: float, level: int) -> Any:
        made.append((first, level))
        assert t_end == first + 1
        energy = change(first, level)
        return None if energy is None else [np.array([t_end]), np.array([[energy]]), np.zeros((1, 1))]

    energies = SimpleNamespace(of=lambda _, states: (None, states[1][:, 0]))
    run: Any = SimpleNamespace(states=states, h=h, repeat=repeat, energies=energies)
    doubts = _Doubts(gained, np.full(len(gained), unseen), kinetic, evident)
    return _is_numerical(run, "arm", np.arange(len(kinetic)), doubts), made


def test_the_interval_that_throws_a_body_is_among_those_made_once_more() -> None:
    """It gains little beside the later motion, and much beside the one before."""
    gained = np.array([1e-7, 1e-7, 1e-3, *np.linspace(-0.02, -0.01, 9)])
    kinetic = np.array([1e-6] * 3 + [1.0] * 10)
    _, made = judged(gained, kinetic, lambda *_: 0.0)
    assert {interval for interval, _ in made} == {2, 3, 4, 5, 6}


@pytest.mark.parametrize(
    ("evident", "changes", "levels", "numerical"),
    [
        (True, [0.0031], 1, True),  # Of what four intervals gained, 0.04, three tenths are 0.012.
        (True, [0.0029] * 2, 2, False),
        (True, [0.0001, 0.0015, 0.0032], 3, True),  # Not settled: by an eighth it is more.
        (True, [0.0001, 0.0010, 0.0020, 0.0028], 4, False),
        (False, [0.0251], 1, True),  # Of the kinetic energy a tenth.
        (False, [0.0249] * 2, 2, False),
    ],
)
def test_finer_steps_must_change_a_share_of_what_was_gained(
    evident: bool, changes: list[float], levels: int, numerical: bool
) -> None:
    gained, kinetic = np.full(4, 0.01), np.ones(5)
    verdict, made = judged(gained, kinetic, lambda _, level: changes[level - 1], evident=evident)
    assert verdict == numerical
    assert [level for _, level in made] == [level for level in range(1, levels + 1) for _ in range(4)]


def test_methods_that_adapt_are_repeated_once() -> None:
    assert judged(np.full(4, 0.01), np.ones(5), lambda _, level: 1e-3 * level, h=0.0)[1] == [(i, 1) for i in range(4)]


def test_steps_that_do_not_come_to_the_end_of_an_interval_are_at_fault() -> None:
    assert judged(np.full(4, 0.01), np.ones(5), lambda *_: None)[0]


@pytest.mark.parametrize(("change", "numerical"), [(0.0016, True), (0.0014, False)])
@pytest.mark.parametrize("size", [1.0, 1e3])
def test_small_changes_of_many_intervals_add_up(change: float, numerical: bool, size: float) -> None:
    """A hundred intervals that gain a hundredth each: 15 % of the motion's energy is too much."""
    gained = np.full(100, 0.01 * size)
    assert judged(gained, np.full(101, size), lambda *_: change * size)[0] == numerical


class Recorded:
    """A run of one mechanism whose energy is its coordinate and whose power is its speed; 1 J of it moves.

    Args:
        t: Times of its records (n) [s].
        energy: Energies (n) [J].
        power: Powers (n) [W].
        sides: First and last record of each action, by number.
        finer: Records of an interval by finer steps: t, energy.
    """

    h, steps = 0.01, 1000

    def __init__(self, t: Any, energy: Any, power: Any, sides: Any, finer: Any = None) -> None:
        column = np.zeros((len(t), 1))
        self.states = [np.array(t, float), column + np.array(energy)[:, np.newaxis], column + np.array(power)[:, None]]
        self.states.append(column[:, :0])
        self.sides = tuple(np.array(side, int) for side in zip(*sides, strict=True))
        self.layout = SimpleNamespace(driven=False, lock_inputs=[], q={"arm": None})
        one = SimpleNamespace(layout=self.layout)
        self.energies = SimpleNamespace(
            resolved=one, of=lambda _, x: (np.ones(len(x[0])), x[1][:, 0]), powers=lambda _, x, a: x[2][:, 0]
        )
        self.finer, self.repeated = finer, list[int]()

    def accelerations(self, rows: Any) -> Any:
        return np.zeros((len(rows), 1))

    def repeat(self, first: int, t_end: float, level: int) -> Any:
        self.repeated.append(first)
        t, energy = self.finer
        return [
            np.array(t, float),
            np.array(energy, float)[:, np.newaxis],
            np.zeros((len(t), 1)),
            np.zeros((len(t), 0)),
        ]


def test_energy_that_actions_add_is_not_that_of_steps() -> None:
    """Five actions of 10 J each, and 0.2 J that come between two records, where finer steps find none."""
    t = np.repeat(np.arange(7.0), 2)[1:-1]
    energy = np.cumsum([0.0, *([0.0, 10.0] * 5), 0.2])
    actions = [(2 * i + 1, 2 * i + 2) for i in range(5)]
    run: Any = Recorded(t, energy, 0.0 * t, actions, finer=([5.0, 6.0], [50.0, 50.0]))
    note = energy_note(run)
    assert "changes by 0.2 J" in note and set(run.repeated) == {10}


def test_an_interval_that_ends_at_an_action_ends_before_it() -> None:
    """Finer steps meet the action a little sooner: what it adds is not their error."""
    run: Any = Recorded(
        [0, 1, 1, 2], [0.0, 0.5, 9.0, 9.0], [0.0] * 4, [(1, 2)], finer=([0.0, 0.99, 0.99], [0.0, 0.5, 9.0])
    )
    assert energy_note(run) == "" and 0 in run.repeated


def test_a_power_that_begins_with_an_action_has_no_bend() -> None:
    run: Any = Recorded([0, 1, 2, 2, 3, 4], [0.0, 0.0, 0.0, 7.0, 17.0, 27.0], [0.0] * 3 + [10.0] * 3, [(2, 3)])
    assert energy_note(run) == "" and not run.repeated
