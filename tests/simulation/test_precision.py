"""What solves or simulates does so in double precision, whatever the model returns."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.models import GUESSES


def pair(name: str) -> tuple[sf.Model, sf.Model]:
    exact = sf.compile(MODELS[name])
    return exact, exact.with_precision("single")


@pytest.mark.parametrize("name", ["four_bar", "slider_crank", "rolling_disc"])
def test_assembly(name: str) -> None:
    exact, single = pair(name)
    expected = sf.assemble(exact, GUESSES[name], np.ones(exact.nv))
    found = sf.assemble(single, GUESSES[name], np.ones(exact.nv))
    assert found.q.dtype == np.float64 and found.residual == expected.residual
    assert np.array_equal(found.q, expected.q) and np.array_equal(found.v, expected.v)


@pytest.mark.parametrize("name", ["double_pendulum", "four_bar"])
def test_equilibrium_state_space_and_modes(name: str) -> None:
    exact, single = pair(name)
    q = sf.assemble(exact, GUESSES[name]).q if exact.nc else np.array([0.2, 0.1])
    rest, found = sf.equilibrium(exact, q), sf.equilibrium(single, q)
    assert np.array_equal(found.q, rest.q) and np.array_equal(found.lam, rest.lam) and found.residual == rest.residual
    expected = sf.state_space(exact, rest.q)
    space = sf.state_space(single, rest.q)
    for ours, theirs in zip((space.A, space.B, space.basis), (expected.A, expected.B, expected.basis), strict=True):
        assert ours.dtype == np.float64 and np.array_equal(ours, theirs)
    assert np.array_equal(sf.modes(single, rest.q).frequencies, sf.modes(exact, rest.q).frequencies)


def test_inverse_kinematics_and_joint_motion() -> None:
    exact, single = pair("double_pendulum")
    frame = exact.names.frames[-1]
    q = np.array([0.4, 0.5])
    p = exact.frame_pose(frame, q)[0]
    guess = q + 0.1
    expected, found = (sf.inverse_kinematics(m, {frame: sf.Target(p)}, guess) for m in (exact, single))
    assert found.converged and np.array_equal(found.q, expected.q)
    path = p[None], np.full((1, 3), 0.1), np.zeros((1, 3))
    for ours, theirs in zip(*(sf.joint_motion(m, frame, *path, q=guess) for m in (single, exact)), strict=True):
        assert ours.dtype == np.float64 and np.array_equal(ours, theirs)


def test_base_parameters() -> None:
    exact, single = pair("double_pendulum")
    found, expected = sf.base_parameters(single), sf.base_parameters(exact)
    assert found.independent == expected.independent and np.array_equal(found.combine, expected.combine)


@pytest.mark.parametrize("name", ["double_pendulum", "four_bar"])
def test_simulation(name: str) -> None:
    exact, single = pair(name)
    q = sf.assemble(exact, GUESSES[name]).q if exact.nc else np.array([0.2, 0.1])
    expected, found = (sf.simulate(m, q, np.zeros(m.nv), 0.1, dt=1e-2) for m in (exact, single))
    assert np.array_equal(found.q, expected.q) and np.array_equal(found.v, expected.v)
    assert found.a.dtype == np.float64 and np.array_equal(found.a, expected.a)
