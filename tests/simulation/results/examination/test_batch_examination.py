"""Batches over events and contacts are examined as single runs are."""

from __future__ import annotations

from typing import Any

import pytest

import symofros as sf
from symofros.simulation.results.examination import batch_examination, diagnosis
from symofros.simulation.results.examination.step_size import examine_run
from tests.simulation.events.test_forces_that_switch import FALL, model_of
from tests.simulation.results.examination.test_switched_run import (
    box_over_floor,
    relay,
)


def test_a_motion_of_a_batch_with_compliant_contacts_is_examined_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its steps, and then the whole."""
    examined = list[Any]()
    for module in (diagnosis, batch_examination):
        monkeypatch.setattr(module, "examine_run", lambda *run, **of: examined.append(run) or examine_run(*run, **of))
    batch = sf.simulate_batch(box_over_floor(), [[0.0, 0.3, 0.6]] * 2, [[0.5, 0.0, 1.0]] * 2, 1.2, dt=4e-3)
    assert "over its contacts" in batch.outcome(1).notes[0] and len(examined) == 1
    assert "over its contacts" in str(batch) and len(examined) == 2


@pytest.mark.parametrize(("n", "wrong"), [(120, True), (12000, False)])
def test_runs_of_batches_are_held_as_single_ones_are(n: int, wrong: bool) -> None:
    """Over all actions of their events, when their outcomes are asked for; the batch in words says so as well."""
    model, q, v, given = relay()
    options: dict[str, Any] = {"method": "semi_implicit_euler", "dt": 2.0 / n}
    alone = sf.simulate(model, q, v, **given, **options)
    many = sf.simulate_batch(model, [q] * 2, [v, 0.9 * v], **given, **options)
    assert many.outcome(0).notes == alone.outcome.notes and bool(alone.outcome.notes) == wrong
    assert ("steps, first seen in [0]: steps of" in str(many)) == wrong and many.q.shape[1] == 1


def test_long_runs_of_batches_with_events_say_that_they_are_not_examined(monkeypatch: pytest.MonkeyPatch) -> None:
    model, q, v, given = relay()
    monkeypatch.setattr(batch_examination, "_MADE_AGAIN", 100)
    (note,) = sf.simulate_batch(model, [q], [v], **given, method="rk4", dt=2.0 / 120).outcome(0).notes
    assert note == "a motion of so many steps is not examined in a batch: sf.simulate says more of it"


def test_long_runs_of_batches_that_record_their_end_alone_say_that_they_are_not_examined() -> None:
    """A pendulum on a stop by steps that are too long: records show it, and its end alone does not."""
    given: dict[str, Any] = {**FALL, "t_end": 20.0, "dt": 1.8e-4}
    model, start = model_of("pendulum", "stop"), [[0.0]]
    (note,) = sf.simulate_batch(model, start, **given).outcome(0).notes
    assert note.startswith("a motion of so many steps is not examined in a batch")
    assert note in str(sf.simulate_batch(model, start, **given))
    (note,) = sf.simulate_batch(model, start, **given, output=0.01).outcome(0).notes
    assert "over forces that bend or jump" in note
