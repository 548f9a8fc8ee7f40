"""Wrong answers of engines: permuted, of the wrong sign, one entry scaled; every comparison must go red."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from reference_models import MODELS
from tests.late import require
from tests.validation.subjects import floating_arm
from validation.checking import Settings, check
from validation.comparison.participants import Participant
from validation.contract.interface import States, Subject
from validation.contract.quantities import MOTION_ENERGY, QUANTITIES, Quantity

STATES = 4
# Free motions, which take longest, are seen to fail in test_harness_can_fail.py.
SETTINGS = Settings(STATES, first=1)
# Every route takes part in one of them but those of files; between them they have every quantity.
MODELS_ASKED = ("floating_arm", "friction_arm", "four_bar", "spinning_beam")
ROUTES_ASKED = {
    "pinocchio",
    "mujoco",
    "exudyn",
    "pinocchio-loops",
    "exudyn-loops",
    "lagrangian",
    "exudyn-beams",
    "vectors",
    "interpreted",
    "description",
}

Fault = Callable[[Quantity, np.ndarray], np.ndarray]


def permuted(quantity: Quantity, value: np.ndarray) -> np.ndarray:
    """The entries of each state in another order; of numbers, the states."""
    if value.ndim == 1:
        return np.roll(value, 1)
    return np.roll(value.reshape(len(value), -1), 1, axis=1).reshape(value.shape)


def of_wrong_sign(quantity: Quantity, value: np.ndarray) -> np.ndarray:
    return -value


def one_entry_scaled(quantity: Quantity, value: np.ndarray) -> np.ndarray:
    """The largest entry of all, off by a hundred tolerances."""
    wrong = value.copy()
    wrong[np.unravel_index(np.abs(wrong).argmax(), wrong.shape)] *= 1.0 + 100.0 * quantity.tolerance
    return wrong


def statuses(name: str, monkeypatch: pytest.MonkeyPatch, fault: Fault) -> dict[tuple[str, str], str]:
    """(engine, quantity) -> status, where every engine answers every quantity wrongly.

    Left out is what vanishes in all states, and the gap of closed loops, a size that is compared with zero.
    """
    sizes: dict[tuple[str, str], float] = {}
    right = Participant.value

    def wrong(self: Participant, quantity: Quantity, states: States) -> np.ndarray:
        value = np.asarray(right(self, quantity, states), float)
        sizes[self.name, quantity.name] = float(np.abs(value).max(initial=0.0))
        return fault(self.held(quantity), value)

    monkeypatch.setattr(Participant, "value", wrong)
    subject = floating_arm() if name == "floating_arm" else Subject(name, MODELS[name])
    rows = {(row.engine, row.quantity): row.status for row in check(subject, SETTINGS).comparisons}
    left_out = {key for key, size in sizes.items() if size < 1e-3} | {key for key in rows if key[1] == "closure_gap"}
    return {key: status for key, status in rows.items() if key not in left_out and status in ("agree", "disagree")}


@pytest.mark.parametrize("name", MODELS_ASKED)
@pytest.mark.parametrize("fault", [permuted, of_wrong_sign, one_entry_scaled], ids=lambda f: f.__name__)
def test_a_wrong_answer_is_red_whatever_the_quantity_and_the_engine(
    name: str, fault: Fault, monkeypatch: pytest.MonkeyPatch
) -> None:
    require("exudyn", "validation")
    answers = statuses(name, monkeypatch, fault)
    assert answers
    silent = sorted(key for key, status in answers.items() if status == "agree")
    assert not silent, f"answered wrongly, and the check says nothing: {silent}"


def test_every_quantity_and_every_engine_is_among_them(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = {key for name in MODELS_ASKED for key in statuses(name, monkeypatch, lambda quantity, value: value)}
    assert {engine for engine, _ in asked} == ROUTES_ASKED
    assert {quantity for _, quantity in asked} >= set(QUANTITIES) - {"closure_gap", MOTION_ENERGY.name}
