"""A harness that can't fail proves nothing: single faults are planted in an engine, and must be found."""

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.validation.subjects import floating_arm
from validation.adapters import compiled
from validation.adapters.compiled import SymofrosEngine
from validation.adapters.pinocchio import tree as pinocchio
from validation.checking import ModelResult, Settings, check
from validation.contract.interface import States, Subject

SETTINGS = Settings(states=20, engines=("pinocchio",))


@dataclass(frozen=True)
class Faulty:
    """An engine with wrong methods."""

    engine: Any
    methods: Collection[str]
    fault: Callable[[np.ndarray], np.ndarray]

    def __getattr__(self, name: str) -> Any:
        right = getattr(self.engine, name)
        return right if name not in self.methods else lambda states: self.fault(right(states))


def disagreeing(result: ModelResult) -> set[str]:
    return {row.quantity for row in result.comparisons if row.status == "disagree"}


@pytest.mark.parametrize(
    ("method", "fault", "found"),
    [
        ("potential_energy", lambda V: V + 1e-9 * np.abs(V).max(), {"potential_energy", "motion_energy"}),
        ("kinetic_energy", lambda T: np.full_like(T, np.nan), {"kinetic_energy", "motion_energy"}),
    ],
)
def test_a_wrong_energy_is_found_in_a_free_motion_too(
    method: str, fault: Callable[[np.ndarray], np.ndarray], found: set[str]
) -> None:
    """All other comparisons: test_every_comparison_can_fail.py."""
    build = {"pinocchio": lambda subject: Faulty(pinocchio.build(subject), {method}, fault)}
    assert disagreeing(check(floating_arm(), SETTINGS, build)) == found


@pytest.mark.parametrize(("light", "expected"), [(1.0, "disagree"), (1e-12, "agree")])
def test_forward_dynamics_is_judged_by_what_the_condition_of_m_allows(light: float, expected: str) -> None:
    """An error of 2e-9 in forward dynamics: too much, unless M is so ill-conditioned that rounding explains it."""
    arm, hand = (sf.Joint("a", "prismatic"), sf.Joint("b", "prismatic", "arm", axis=(1.0, 0.0, 0.0)))
    bodies = [sf.RigidBody("arm", arm, sf.Inertia(1.0)), sf.RigidBody("hand", hand, sf.Inertia(light))]
    subject = Subject("slides", sf.System("slides", bodies))

    def build(subject: Subject) -> Any:
        return Faulty(pinocchio.build(subject), {"forward_dynamics"}, lambda a: a * (1 + 2e-9))

    result = check(subject, SETTINGS, {"pinocchio": build})
    (row,) = (row for row in result.comparisons if row.quantity == "forward_dynamics")
    assert row.status == expected and row.extra["condition"] == pytest.approx(1 / light, rel=1e-3, abs=2)
    assert ("allows no better" in row.note) == (expected == "agree")


@dataclass(frozen=True)
class NotANumberWhere(SymofrosEngine):
    """Our model with G not a number where the first coordinate is negative."""

    def constraint_jacobian(self, states: States) -> np.ndarray:
        right = super().constraint_jacobian(states)
        return np.where(states.q[:, :1, None] < 0.0, np.nan, right)


def test_a_nan_in_our_jacobian_disagrees(monkeypatch: pytest.MonkeyPatch) -> None:
    """States where G has no clear rank are left out; those where ours alone does not exist are no such states."""
    build = compiled.build
    monkeypatch.setattr(compiled, "build", lambda subject: NotANumberWhere(**vars(build(subject))))
    result = check(Subject("four_bar", MODELS["four_bar"]), replace(SETTINGS, states=40))
    assert not result.ok
    (row,) = (row for row in result.comparisons if (row.engine, row.quantity) == ("pinocchio", "constraint_jacobian"))
    assert row.status == "disagree" and "our G is not a finite number in" in row.note
    (row,) = (row for row in result.comparisons if row.status == "failed")
    assert "of 33 random states left out" in row.note


def test_a_model_with_events_is_compared_without_them_and_says_so() -> None:
    """As a tree, which engines know: events that act within its free motion would take it from theirs."""
    given = floating_arm()
    name = given.system.bodies[-1].joint.name  # type: ignore[union-attr]
    event = sf.Event("t - 1e-3", action={f"d{name}": 5.0})
    result = check(replace(given, system=replace(given.system, events={"kick": event})), SETTINGS)
    assert result.ok and "motion_energy" in {row.quantity for row in result.compared}
    (row,) = (row for row in result.comparisons if row.quantity == "events")
    assert row.status == "unsupported" and row.note.startswith("kick: ")
