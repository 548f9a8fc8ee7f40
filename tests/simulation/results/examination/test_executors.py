"""What a single run notes of a motion every executor notes of the same motion, or says that it has not looked."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.diagrams.parts import moving
from tests.models import GUESSES, compiled
from tests.simulation.mechanisms import slide
from tests.simulation.oscillator import oscillator_system

UNSEEN = "not examined"
STEP = 1e-3


class Motion(NamedTuple):
    """A motion by rk4 in steps of 1 ms.

    Attributes:
        system: What moves.
        model: Its model.
        q: First configuration (nq).
        v: First speeds (nv).
        t_end: End [s].
        said: Part of the note that it bears; "" for none.
    """

    system: sf.System
    model: sf.Model
    q: Any
    v: Any
    t_end: float
    said: str


def turning(t_end: float, said: str) -> Motion:
    """A parallelogram that turns over a singular posture at 0.46 s."""
    m = compiled("parallelogram")
    first = sf.assemble(m, GUESSES["parallelogram"], np.full(m.nv, 3.0))
    return Motion(MODELS["parallelogram"], m, first.q, first.v, t_end, said)


def sliding(system: sf.System, v: float, t_end: float, said: str) -> Motion:
    return Motion(system, sf.compile(system), [0.0], [v], t_end, said)


def touching(stiffness: float, said: str) -> Motion:
    """A ball that moves against a floor."""
    floor = sf.Contact("floor", ("body", None), ("world", None), stiffness, radius=0.05, dissipation=2.0)
    system = slide(axis=(0, 0, 1), connections=(floor,))
    return Motion(system, sf.compile(system), [0.2], [-1.0], 0.5, said)


def loaded(force: float, said: str) -> Motion:
    """A block with friction of 1 N that its weight draws to one side."""
    return sliding(slide(sf.Friction(1.0, minimum_velocity=1e-2), gravity=(-force, 0, 0)), 0.0, 1.0, said)


MOTIONS: dict[str, Callable[[], Motion]] = {
    "singular": lambda: turning(0.6, "singular posture"),
    "regular": lambda: turning(0.1, ""),
    "limits left": lambda: sliding(slide(limits=sf.Limits(-0.1, 0.15)), 1.0, 0.5, "leaves its limits"),
    "limits kept": lambda: sliding(slide(limits=sf.Limits(-0.1, 0.15)), 1.0, 0.1, ""),
    "deep": lambda: touching(1.0, "times its radius deep"),
    "shallow": lambda: touching(1e4, ""),
    "creeping": lambda: loaded(0.5, "so that the joint creeps"),
    "sliding": lambda: loaded(3.0, ""),
    "past stability": lambda: sliding(oscillator_system(k=1e7), 1.0, 0.05, "of 0.001 s"),
    "slow": lambda: sliding(oscillator_system(k=1e2), 1.0, 0.05, ""),
}
made = cache(lambda name: MOTIONS[name]())


def in_batch(moved: Motion, **options: Any) -> sf.Outcome:
    """A run as the second of two motions, the first of which begins at rest."""
    speeds = np.stack([0.0 * np.array(moved.v), moved.v])
    return sf.simulate_batch(moved.model, moved.q, speeds, t_end=moved.t_end, method="rk4", dt=STEP, **options).outcome(
        1
    )


def by_hand(moved: Motion) -> sf.Outcome:
    stepper = sf.Stepper(moved.model, method="rk4", dt=STEP)
    stepper.reset(moved.q, moved.v)
    stepper.step(steps=round(moved.t_end / STEP))
    return stepper.outcome


def together(moved: Motion) -> sf.Outcome:
    steppers = sf.Steppers(moved.model, 2, method="rk4", dt=STEP)
    steppers.reset(moved.q, moved.v)
    steppers.step(steps=round(moved.t_end / STEP))
    return steppers.outcome(1)


def drawn(moved: Motion, way: str, record: float) -> sf.Outcome:
    names, free = moved.model.names, len(moved.v) - moved.model.nc
    start = dict(zip(names.q, map(float, moved.q), strict=True))
    start |= {f"d{name}": float(v) for name, v in zip(names.v[: max(free, 1)], moved.v, strict=False)}
    simulation = sf.Simulation(moving(moved.system, start=start))
    outcome: sf.Outcome = getattr(simulation, way)(moved.t_end, method="rk4", dt=STEP, record=record).outcome
    return outcome


EXECUTORS: dict[str, Callable[[Motion], sf.Outcome]] = {
    "single": lambda moved: sf.simulate(moved.model, *moved[2:5], method="rk4", dt=STEP).outcome,
    "last state": in_batch,
    "each step": lambda moved: in_batch(moved, output=STEP),
    "every tenth": lambda moved: in_batch(moved, output=10 * STEP),
    "events": lambda moved: in_batch(moved, output=STEP, events={"never": "t - 100"}),
    "by hand": by_hand,
    "together": together,
    "compiled": lambda moved: drawn(moved, "run", STEP),
    "compiled, every tenth": lambda moved: drawn(moved, "run", 10 * STEP),
    "interpreted": lambda moved: drawn(moved, "interpret", STEP),
    "interpreted, every tenth": lambda moved: drawn(moved, "interpret", 10 * STEP),
}


@pytest.mark.parametrize("executor", EXECUTORS)
@pytest.mark.parametrize("name", MOTIONS)
def test_every_executor_notes_what_a_single_run_notes(name: str, executor: str) -> None:
    moved = made(name)
    notes = EXECUTORS[executor](moved).notes
    assert not any(UNSEEN in note for note in notes), notes
    assert [moved.said in note for note in notes] == [True] * len(notes) and bool(notes) == bool(moved.said), notes


@pytest.mark.parametrize("executor", ["single", "last state", "each step", "by hand"])
def test_notes_on_ranks_have_their_numbers(executor: str) -> None:
    """It begins in the singular posture. A diagram, which closes its start itself, begins another motion there."""
    start = made("regular")._replace(q=[0.0] * 4, v=[1.0, -1.0, 1.0, 1.0], t_end=0.05)
    (note,) = EXECUTORS[executor](start).notes
    assert note == "a singular posture was passed at t = 0 s: the constraints' rank fell from 3 to 2"


@pytest.mark.parametrize("name", ["limits left", "limits kept", "deep", "shallow", "creeping", "sliding"])
def test_a_rollout_notes_what_its_states_show(name: str) -> None:
    moved = made(name)
    steps = round(moved.t_end / STEP)
    notes = sf.rollout(moved.model, moved.q, moved.v, np.zeros((steps, moved.model.nu)), STEP).notes
    assert [moved.said in note for note in notes] == [True] * bool(moved.said), notes
