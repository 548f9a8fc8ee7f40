"""States are left out of the comparison of constraints only where mechanisms are singular."""

from dataclasses import dataclass

import numpy as np
import pytest

from validation.adapters.compiled import SymofrosEngine
from validation.comparison.regular import RegularStates, judge_omissions, judge_undefined, regular_states
from validation.contract.interface import States


@dataclass(frozen=True)
class PrescribedJacobian:
    """An engine of one speed, G = (q, 0; 0, 1): not a number or of unclear rank where q is."""

    name: str = "prescribed"

    def mass_matrix(self, states: States) -> np.ndarray:
        return np.tile(np.eye(2), (len(states), 1, 1))

    def constraint_jacobian(self, states: States) -> np.ndarray:
        G = np.tile(np.eye(2), (len(states), 1, 1))
        G[:, 0, 0] = states.q[:, 0]
        return G


def states_of(q: list[float]) -> States:
    column = np.array(q)[:, None]
    two = np.zeros((len(q), 2))
    return States(column, two, two, np.zeros((len(q), 0)), two, two)


def sorted_states(q: list[float], special: int = 0) -> RegularStates:
    model: SymofrosEngine = PrescribedJacobian()  # type: ignore[assignment]
    return regular_states(model, states_of(q), special)


def test_states_are_sorted_by_the_rank_of_the_jacobian() -> None:
    doubtful, undefined = 1e-6, np.nan
    regular = sorted_states([doubtful, 1.0, undefined, 0.5, 0.0], special=1)
    assert regular.states.q[:, 0].tolist() == [1.0, 0.5, 0.0]
    assert len(regular.undefined) == 1 and np.isnan(regular.undefined.q).all()
    assert (regular.omitted, regular.drawn) == (1, 4)


@pytest.mark.parametrize(("drawn", "allowed"), [(40, 6), (1000, 71)])
def test_a_few_per_cent_of_states_and_no_more_may_be_left_out(drawn: int, allowed: int) -> None:
    for omitted, accepted in ((allowed, True), (allowed + 1, False)):
        regular = sorted_states([np.nan] * omitted + [1.0] * (drawn - omitted))
        assert (judge_omissions("m", regular) is None) == accepted


def test_leaving_out_all_states_is_a_failure() -> None:
    row = judge_omissions("m", sorted_states([np.nan], special=1))
    assert row is not None and row.status == "failed"


def test_a_jacobian_that_exists_for_an_engine_only_disagrees() -> None:
    engine = PrescribedJacobian()
    row = judge_undefined("m", engine, states_of([1.0, np.nan, 2.0]))  # type: ignore[arg-type]
    assert row is not None and row.status == "disagree" and row.states == 2
    assert judge_undefined("m", engine, states_of([np.nan])) is None  # type: ignore[arg-type]
    assert judge_undefined("m", engine, states_of([])) is None  # type: ignore[arg-type]
