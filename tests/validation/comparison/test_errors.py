import math

import numpy as np
import pytest

from validation.comparison.errors import BIN_EDGES, Scales, count, judge, scaled_errors, state_errors
from validation.contract.quantities import QUANTITIES, SMALL

ONES = Scales(inertia=1.0, energy=1.0)


def test_errors_are_relative_to_the_largest_reference_entry() -> None:
    reference = np.array([[[4.0, 1.0], [1.0, 2.0]]])
    value = reference.copy()
    value[0, 1, 1] += 0.1
    assert state_errors(QUANTITIES["mass_matrix"], value, reference, ONES) == pytest.approx([0.025])


def test_each_state_has_its_own_scale() -> None:
    reference = np.array([[100.0], [10.0], [1.0]])
    errors = state_errors(QUANTITIES["frame_velocity"], reference + 0.01, reference, ONES)
    assert errors == pytest.approx([1e-4, 1e-3, 1e-2])


def test_the_worst_frame_counts() -> None:
    reference = np.ones((2, 3, 6))
    value = reference.copy()
    value[1, 2, 0] += 0.5
    assert state_errors(QUANTITIES["frame_velocity"], value, reference, ONES).tolist() == [0.0, 0.5]


def test_small_entries_are_judged_by_the_typical_size() -> None:
    reference = np.array([[1.0]] * 9 + [[1e-9]])
    errors = state_errors(QUANTITIES["mass_matrix"], (reference + 1e-12)[..., None], reference[..., None], ONES)
    assert errors[-1] == pytest.approx(1e-12 / SMALL, rel=1e-3)


def test_a_quantity_that_vanishes_has_a_natural_scale() -> None:
    rounding, zero = np.full((5, 2), 1e-17), np.zeros((5, 2))
    for name in ("bias", "forward_dynamics"):
        assert state_errors(QUANTITIES[name], rounding, zero, ONES).max() == pytest.approx(1e-17 / SMALL)
    heavy = Scales(inertia=1e3, energy=1.0)
    assert state_errors(QUANTITIES["bias"], rounding, zero, heavy).max() == pytest.approx(1e-20 / SMALL)


def test_the_zero_of_potential_energy_is_arbitrary() -> None:
    reference = np.array([100.0, 1e-3])
    assert state_errors(QUANTITIES["potential_energy"], reference + 1e-3, reference, ONES).max() == pytest.approx(1e-5)


def test_zero_references_are_judged_absolutely() -> None:
    zero = np.zeros((2, 1, 1))
    assert state_errors(QUANTITIES["mass_matrix"], zero, zero, ONES).max() == 0.0
    assert state_errors(QUANTITIES["mass_matrix"], zero + 0.5, zero, ONES).max() == 0.5


def test_shapes_must_match() -> None:
    with pytest.raises(ValueError, match="mass_matrix"):
        state_errors(QUANTITIES["mass_matrix"], np.zeros((2, 2, 2)), np.zeros((2, 3, 3)), ONES)


@pytest.mark.parametrize("side", ["value", "reference"])
def test_nan_disagrees(side: str) -> None:
    good, bad = np.ones((3, 2)), np.ones((3, 2))
    bad[1, 0] = math.nan
    value, reference = (bad, good) if side == "value" else (good, bad)
    row = judge("m", "e", QUANTITIES["bias"], state_errors(QUANTITIES["bias"], value, reference, ONES))
    assert row.status == "disagree" and row.error is None and row.worst_state == 1 and not row.ok


def test_the_verdict_changes_at_the_tolerance() -> None:
    quantity = QUANTITIES["bias"]
    errors = np.array([0.0, quantity.tolerance])
    assert judge("m", "e", quantity, errors).ok
    row = judge("m", "e", quantity, errors * (1 + 1e-9))
    assert not row.ok and row.worst_state == 1 and row.states == 2


def test_states_are_counted_by_decade() -> None:
    errors = np.array([0.0, 0.0, 1.5e-15, 0.5, 2.0, math.nan])
    counts = count(errors)
    assert sum(counts) == len(errors) and counts[0] == 2 and counts[-1] == 2
    k = next(k for k, n in enumerate(counts) if k and n)
    assert BIN_EDGES[k - 1] <= 1.5e-15 < BIN_EDGES[k]


def test_the_scale_of_an_error_is_taken_from_its_worst_frame() -> None:
    reference = np.array([[[2.0, 1.0], [8.0, 1.0]], [[4.0, 0.0], [1.0, 0.0]]])
    value = reference + np.array([[[0.2, 0.0], [0.4, 0.0]], [[0.1, 0.0], [np.nan, 0.0]]])
    errors, sizes = scaled_errors(QUANTITIES["frame_velocity"], value, reference, ONES)
    assert errors[0] == pytest.approx(0.1) and np.isnan(errors[1])
    assert sizes.tolist() == [2.0, 1.0]
    row = judge("m", "e", QUANTITIES["bias"], np.array([1e-15, 3e-15]), sizes=np.array([5.0, 7.0]))
    assert (row.worst_state, row.scale) == (1, 7.0)
