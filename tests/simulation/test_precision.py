"""What solves or simulates does so in double precision, whatever the model returns: the same bits, and right ones."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.models import GUESSES, compiled


def start(m: sf.Model, name: str) -> sf.Assembled:
    return sf.assemble(m, GUESSES[name] if m.nc else [0.2, 0.1], np.ones(m.nv))


def motion_of_joints(m: sf.Model, frame: str) -> tuple[np.ndarray, ...]:
    p = m.frame_pose(frame, [0.4, 0.5])[0][None].astype(float)
    within = np.array([[0.1, 0.0, 0.1]])  # The plane in which the links move.
    return sf.joint_motion(m, frame, p.round(3), within, np.zeros((1, 3)), q=[0.5, 0.6])


def rest(m: sf.Model, name: str) -> sf.Equilibrium:
    return sf.equilibrium(m, start(m, name).q)


def linear(m: sf.Model, name: str) -> tuple[np.ndarray, ...]:
    space = sf.state_space(m, rest(m, name).q)
    return space.A, space.B, space.basis


WAYS: dict[str, Callable[[sf.Model, str], Iterable[Any]]] = {
    "assemble": lambda m, name: (start(m, name).q, start(m, name).v),
    "equilibrium": lambda m, name: (rest(m, name).q, rest(m, name).lam),
    "state_space": linear,
    "modes": lambda m, name: (sf.modes(m, rest(m, name).q).frequencies,),
    "simulate": lambda m, name: recorded(sf.simulate(m, start(m, name).q, np.zeros(m.nv), 0.1, dt=1e-2)),
}


def recorded(run: sf.Trajectory) -> tuple[np.ndarray, ...]:
    return run.q, run.v, run.a


@pytest.mark.parametrize("name", ["double_pendulum", "four_bar"])
@pytest.mark.parametrize("way", WAYS)
def test_functions_that_solve_stay_in_double_precision(name: str, way: str) -> None:
    exact = compiled(name)
    for ours, theirs in zip(WAYS[way](exact.with_precision("single"), name), WAYS[way](exact, name), strict=True):
        assert ours.dtype == np.float64 and np.array_equal(ours, theirs)


def test_inverse_kinematics_and_base_parameters_of_single_precision_models_are_double() -> None:
    exact = compiled("double_pendulum")
    single, frame = exact.with_precision("single"), exact.names.frames[-1]
    for ours, theirs in zip(motion_of_joints(single, frame), motion_of_joints(exact, frame), strict=True):
        assert ours.dtype == np.float64 and np.array_equal(ours, theirs)
    target = {frame: sf.Target(exact.frame_pose(frame, [0.4, 0.5])[0])}
    reached = sf.inverse_kinematics(single, target, [0.5, 0.6])
    assert reached.converged and reached.q == pytest.approx([0.4, 0.5], abs=1e-9)
    assert np.array_equal(sf.base_parameters(single).combine, sf.base_parameters(exact).combine)
