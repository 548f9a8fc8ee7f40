"""Bodies that are thrown on a plane come to rest above it, and gain no energy (docs/theory/constraints.md, 15)."""

from __future__ import annotations

from dataclasses import replace
from math import cos, sin
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.simulation.rigid_scenes import GROUND, WITHOUT_ANSWER, G, box, box_system, rested, three_feet


def settled(run: sf.Trajectory) -> None:
    """A motion that has ended as stated, above the plane, and has never gained energy beyond the error of its steps."""
    assert run.outcome.ok, run.outcome
    assert run.contact_forces().gap.min() > -1e-9
    assert np.diff(run.energy).max() < 1e-6 * run.energy[0]


@pytest.mark.parametrize(("method", "off"), [("dopri5", 5e-5), ("rk4", 5e-4)])  # Fixed steps blur how slow slips turn.
def test_a_box_that_rocks_from_edge_to_edge_comes_to_rest(method: str, off: float) -> None:
    """(46a): its strikes without restitution follow each other at a constant ratio, some at speeds of rounding."""
    model = box(0.5, height=0.05)
    run = sf.simulate(model, rested(model, 0.3), [1.0, 0, 0, 2.0, -1.0, 0], t_end=0.6, method=method, dt=1e-3)
    settled(run)
    assert run.q[-1, 2] == pytest.approx(0.05, abs=1e-9) and np.abs(run.v[-1]).max() < 1e-9
    # Where the strikes accumulate, less what is left of them within the threshold; by dop853 with a tolerance of 1e-12.
    assert run.events[-1].t == pytest.approx(0.306446, abs=off)
    # Two edges strike while two feet touch, slipping: of all sets of modes one agrees with (46), found by enumeration.
    assert [event.energy_lost for event in run.events if event.energy_lost > 1.5] == pytest.approx(
        [2.8352, 1.6693], abs=3e-4
    )


@pytest.mark.parametrize("method", ["dopri5", "rk4"])
def test_energy_lost_by_several_feet_at_once_is_counted_once(method: str) -> None:
    """A box that falls flat: its four feet strike at one instant, each with an event of its own."""
    model = box(0.5, height=0.05)
    run = sf.simulate(model, rested(model, 0.3), [0, 0, -1.0, 0, 0, 0], t_end=0.4, method=method, dt=1e-3)
    settled(run)
    assert len(run.events) == 4
    assert sum(event.energy_lost for event in run.events) == pytest.approx(run.energy[0] - run.energy[-1], rel=1e-6)


DISC = [(0.2 * cos(angle), 0.2 * sin(angle), -0.06) for angle in (0, 2.1, 4.2)]
BOX = [(x, y, -0.05) for x in (-0.2, 0.2) for y in (-0.1, 0.1)]


@pytest.mark.parametrize(
    ("feet", "restitution", "friction", "seed", "t_end"),
    [
        (DISC, 0.3, 1.1, 9, 0.75),  # A slip vanishes in a spiral.
        (DISC, 0.3, 1.1, 118, 0.6),  # What keeps a ball from moving away changes its slip.
        (BOX, 0.3, 0.6, 115, 0.6),  # A ball opens that has been a little below the plane.
        (DISC, 0.7, 0.6, 224, 0.9),  # As it begins, at speeds of rounding, a slip turns by more than a right angle.
    ],
)
def test_thrown_bodies_land(
    feet: list[tuple[float, float, float]], restitution: float, friction: float, seed: int, t_end: float
) -> None:
    """Found among 300 such motions: balls that fell through the plane, forces of friction that drove them."""
    sole = sf.Contact("sole", ("thing", None), GROUND, restitution=restitution, friction=friction, points=feet)
    thing = sf.RigidBody("thing", sf.Joint("free", "free"), sf.Inertia(2.0, moments=(0.02, 0.03, 0.04)))
    model = sf.compile(sf.System("thrown", [thing], connections=[sole]))
    draw = np.random.default_rng(seed)
    draw.random(2)
    speeds = np.concatenate([draw.normal(size=3), 3.0 * draw.normal(size=3)])
    settled(sf.simulate(model, rested(model, 0.35), speeds, t_end=t_end, method="dopri5"))


@pytest.mark.parametrize(("share", "heard"), [(1.0, 1), (0.5, 1), (0.0, 0)])
def test_strikes_in_sequence_for_want_of_another_answer_are_noted(share: float, heard: int) -> None:
    """By single runs, by hand and in batches, once each; a strike with an answer, without spin, bears no such note."""
    model = sf.compile(three_feet())
    q, v = rested(model, 0.1), np.array(WITHOUT_ANSWER) * ([1.0] * 3 + [np.sign(share)] * 3) * (share or 1.0)
    by_hand = sf.Stepper(model, dt=1e-3)
    by_hand.reset(q, v)
    by_hand.step(steps=5)
    outcomes = [
        sf.simulate(model, q, v, t_end=5e-3, dt=1e-3).outcome,
        by_hand.outcome,
        sf.simulate_batch(model, [q] * 3, [v] * 3, t_end=5e-3, dt=1e-3).outcome(1),
    ]
    said = "several balls struck one after the other at t = 0 s, as no motion was found in which they do at once"
    assert [sum(note.startswith(said) for note in one.notes) for one in outcomes] == [heard] * 3, outcomes


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_a_box_that_a_closure_takes_where_it_stands_is_held_and_let_go(method: Any) -> None:
    """Held in all directions its feet can't move, whatever presses them: let go, it stands on them again."""
    every = ("x", "y", "z")
    hold = sf.Closure("hold", GROUND, ("box", None), every, rotations=every)
    switch = sf.Switch("hold", "grip", "moment")
    described = replace(
        box_system(0.3), parameters=(sf.Parameter("grip", 0.0),), constraints=(hold,), switches=(switch,)
    )
    m = sf.compile(described)
    takes, gives = (sf.Event(f"t - {t}", action={"grip": grip}) for t, grip in ((0.0501, 1), (0.0801, 0)))
    begin, events = {"free.vx": 1.0}, {"takes": takes, "gives": gives}
    run = sf.simulate(m, rested(m, 0.1), begin, t_end=0.2, dt=1e-3, method=method, events=events)
    stop = 0.0501 - 0.5 * 0.3 * G * 0.0501**2
    assert run.outcome.ok
    np.testing.assert_allclose(run.q[-1], [stop, 0, 0.1, 0, 0, 0, 1], atol=1e-9)
    np.testing.assert_allclose(run.v[run.t > 0.0502], 0.0, atol=1e-9)
