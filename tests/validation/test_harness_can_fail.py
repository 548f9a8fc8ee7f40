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
from validation.contract.quantities import QUANTITIES, TREE_QUANTITIES

SUBJECT = floating_arm()
SETTINGS = Settings(states=20, engines=("pinocchio",))
# A later part of a campaign lets nothing fall, which takes nine tenths of a check.
WITHOUT_MOTION = replace(SETTINGS, first=SETTINGS.states)


@dataclass(frozen=True)
class Faulty:
    """An engine with wrong methods."""

    engine: Any
    methods: Collection[str]
    fault: Callable[[np.ndarray], np.ndarray]

    def __getattr__(self, name: str) -> Any:
        right = getattr(self.engine, name)
        return right if name not in self.methods else lambda states: self.fault(right(states))


def checked(build: Callable[[Subject], Any], settings: Settings = SETTINGS) -> ModelResult:
    return check(SUBJECT, settings, {"pinocchio": build})


def disagreeing(result: ModelResult) -> set[str]:
    return {row.quantity for row in result.comparisons if row.status == "disagree"}


def one_entry(result: np.ndarray) -> np.ndarray:
    """Ten times the tolerance, in the largest entry of one state."""
    wrong = result.copy()
    state = wrong[17]
    at = np.unravel_index(np.abs(state).argmax(), state.shape)
    state_value = state[at] * (1 + 1e-11)
    wrong[(17, *at)] = state_value
    return wrong


def test_the_right_engine_passes() -> None:
    assert checked(pinocchio.build).ok


def test_an_entry_off_by_ten_tolerances_is_found() -> None:
    """In every quantity at the same time, at its state."""
    asked = TREE_QUANTITIES - {"gravity", "forward_dynamics"}
    result = checked(lambda subject: Faulty(pinocchio.build(subject), asked, one_entry), WITHOUT_MOTION)
    assert asked <= disagreeing(result) <= TREE_QUANTITIES
    assert {row.worst_state for row in result.comparisons if row.quantity in asked} == {17}


@pytest.mark.parametrize(
    ("method", "fault", "found"),
    [
        ("bias", lambda h: -h, {"bias", "gravity"}),
        ("forward_dynamics", lambda a: a * (1 + 1e-8), {"forward_dynamics"}),
        ("mass_matrix", lambda M: np.roll(M, 1, axis=2), {"mass_matrix"}),
        ("potential_energy", lambda V: V + 1e-9 * np.abs(V).max(), {"potential_energy", "motion_energy"}),
        ("frame_velocity", lambda V: np.roll(V, 3, axis=-1), {"frame_velocity"}),
        ("kinetic_energy", lambda T: np.full_like(T, np.nan), {"kinetic_energy", "motion_energy"}),
    ],
)
def test_planted_faults_are_found(method: str, fault: Callable[[np.ndarray], np.ndarray], found: set[str]) -> None:
    settings = SETTINGS if "motion_energy" in found else WITHOUT_MOTION
    assert disagreeing(checked(lambda subject: Faulty(pinocchio.build(subject), {method}, fault), settings)) == found


def test_classical_and_spatial_acceleration_differ() -> None:
    """Were w x v forgotten, it would show."""

    def forget(engine: Any, states: States) -> np.ndarray:
        velocity = engine.frame_velocity(states)
        wrong = engine.frame_acceleration(states)
        wrong[..., :3] -= np.cross(velocity[..., 3:], velocity[..., :3])
        return np.asarray(wrong)

    class Spatial(Faulty):
        def __getattr__(self, name: str) -> Any:
            if name == "frame_acceleration":
                return lambda states: forget(self.engine, states)
            return getattr(self.engine, name)

    result = checked(lambda s: Spatial(pinocchio.build(s), (), lambda x: x), WITHOUT_MOTION)
    assert disagreeing(result) == {"frame_acceleration"}


def test_another_mechanism_is_found() -> None:
    """An engine built from a description whose last body is one part in a billion heavier."""

    def heavier(subject: Subject) -> Any:
        *bodies, last = subject.system.bodies
        assert last.inertia is not None
        inertia = replace(last.inertia, mass=float(last.inertia.mass) * (1 + 1e-9))
        system = replace(subject.system, bodies=(*bodies, replace(last, inertia=inertia)))
        return pinocchio.build(replace(subject, system=system))

    found = disagreeing(checked(heavier, WITHOUT_MOTION))
    assert {"mass_matrix", "bias", "gravity", "kinetic_energy", "potential_energy", "inverse_dynamics"} <= found
    assert not found & {name for name in QUANTITIES if name.startswith("frame_")}


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
