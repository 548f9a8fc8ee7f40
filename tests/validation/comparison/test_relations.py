"""Relations between descriptions of one mechanism hold for every kind of model, and a small fault on one side shows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.validation.subjects import every_kind, subject_of
from validation.adapters import interpreted
from validation.comparison import relations
from validation.comparison.errors import Comparison, typical_scales
from validation.comparison.relations import Related, judge_relations
from validation.comparison.restated import RESTATEMENTS, Restated
from validation.comparison.units import Units
from validation.contract.interface import Subject
from validation.inputs.cases import named
from validation.inputs.sampling import sample

# Trees with motors, elements and parameters; loops; beams; joints by formula; a free joint amid a tree.
ASKED = ("motors", "friction_arm", "four_bar", "rolling_disc", "flexible_pendulum", "soft_pendulum", "joint_zoo")


def judged(subject: Subject, ours: Any = None) -> dict[str, Comparison]:
    ours = ours or interpreted.build(subject)
    states = sample(subject.assembly, ours.model.nu, 14)
    scales = typical_scales(ours, states)
    return {
        row.quantity: row
        for row in judge_relations(Related(subject, subject.assembly, ours, states, scales, np.inf, states))
    }


def subject(name: str) -> Subject:
    return every_kind() if name == "every kind" else subject_of(named([name])[0].load().system)


@pytest.mark.parametrize("name", ["every kind", *ASKED])
def test_every_relation_holds_or_says_why_it_is_not_asked(name: str) -> None:
    rows = judged(subject(name))
    assert set(RESTATEMENTS) < set(rows)
    assert all(row.ok and (row.status == "agree" or row.note) for row in rows.values())
    assert sum(row.status == "agree" for row in rows.values()) >= 5


@pytest.mark.parametrize("relation", RESTATEMENTS)
def test_a_millionth_of_a_mass_shows_in_every_relation(relation: str, monkeypatch: pytest.MonkeyPatch) -> None:
    restate = RESTATEMENTS[relation]

    def heavier(body: Any) -> Any:
        inertia = getattr(body, "inertia", None)
        return body if inertia is None else replace(body, inertia=replace(inertia, mass=inertia.mass * (1 + 1e-6)))

    def wrong(stated: sf.System, rng: np.random.Generator) -> Restated:
        made = restate(stated, rng)
        assert isinstance(made, Restated)
        return replace(made, system=replace(made.system, bodies=tuple(map(heavier, made.system.bodies))))

    monkeypatch.setattr(relations, "RESTATEMENTS", {relation: wrong})
    rows = judged(subject("every kind"))
    assert [name for name, row in rows.items() if not row.ok] == [relation]


@pytest.mark.parametrize(
    ("function", "relation"),
    [("mass_matrix", "asked again, in another order"), ("bias", "asked again, in another order")],
)
def test_answers_that_depend_on_the_call_before_are_found(
    function: str, relation: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    one = subject("motors")
    ours = interpreted.build(one)
    right: Callable[..., np.ndarray] = getattr(type(ours), function)
    calls: list[int] = []

    def stale(self: Any, states: Any) -> np.ndarray:
        calls.append(1)
        return right(self, states) * (1.0 + 1e-15 * len(calls))

    monkeypatch.setattr(type(ours), function, stale)
    assert judged(one, ours)[relation].status == "disagree"


def test_units_are_powers_of_metre_kilogram_and_second() -> None:
    units = Units(2.0, 3.0, 5.0)
    stated = {"m": 2, "kg m^2": 12, "N m s/rad": 3 * 4 / 5, "N s^2/m^2": 3 / 2, "1/m": 0.5, "rad": 1, "m/s^2": 2 / 25}
    assert {unit: units.factor(unit) for unit in stated} == pytest.approx(stated)
