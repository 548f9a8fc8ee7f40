"""Truths of linear equations: what they solve; a minimum in a box, by the points around it."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np

from validation.engines.interface import Slot
from validation.engines.models import single
from validation.engines.proving.pieces import Layout
from validation.engines.truth.dynamics import Point, Truth, digits, random_state
from validation.engines.truth.geometry import solutions


def test_a_minimum_in_a_box_is_below_all_points_around_it() -> None:
    tree = single.trees()["rotations"]
    layout = Layout(4, 3, ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),))
    truth, held = Truth(tree, layout), set()
    for seed in range(6):
        state = random_state(tree, layout, seed)
        if seed % 2:
            state = replace(state, tau=0.25 * state.tau)
        B = np.array([state.v, state.a, state.v2])
        A = B @ B.T + np.eye(3)
        x, free = (digits(truth.value(of, Point.of(state))) for of in (solutions.bounded, solutions.unbounded))
        np.testing.assert_allclose(A @ free, state.tau, atol=1e-14)

        def energy(x: np.ndarray, A: np.ndarray = A, tau: np.ndarray = state.tau) -> float:
            return float(x @ A @ x / 2 - tau @ x)

        around = [
            np.clip(x + 1e-3 * np.array(way), -solutions.BOX, solutions.BOX) for way in product((-1, 0, 1), repeat=3)
        ]
        assert energy(x) <= min(map(energy, around)) + 1e-15 and np.all(np.abs(x) <= solutions.BOX)
        held.add(int(np.sum(np.abs(x) == solutions.BOX)))
    assert len(held) > 1
