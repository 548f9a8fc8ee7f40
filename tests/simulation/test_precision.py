"""What solves or simulates does so in double precision, whatever the model returns: the same bits, and right ones."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from tests.models import GUESSES, compiled, model

G = 9.81


def pair(name: str) -> tuple[sf.Model, sf.Model]:
    exact = compiled(name)
    return exact, exact.with_precision("single")


def gap_of(name: str, q: np.ndarray) -> np.ndarray:
    """What keeps a loop open, or a disc off its plane, by geometry."""
    if name == "four_bar":  # A parallelogram.
        return np.array([q[0] + q[1], q[0] - q[2]])
    if name == "slider_crank":
        angles, lengths = np.array([q[0], q[0] + q[1]]), np.array([0.15, 0.30])
        return np.array([lengths @ np.sin(angles), lengths @ np.cos(angles) - q[2]])
    return np.array([q[2] - 1.0])  # Upright by its quaternion: the centre is a radius above the plane.


@pytest.mark.parametrize("name", ["four_bar", "slider_crank", "rolling_disc"])
def test_assembly(name: str) -> None:
    exact, single = pair(name)
    expected = sf.assemble(exact, GUESSES[name], np.ones(exact.nv))
    assembled = sf.assemble(single, GUESSES[name], np.ones(exact.nv))
    assert assembled.q.dtype == np.float64 and assembled.residual == expected.residual
    assert np.array_equal(assembled.q, expected.q) and np.array_equal(assembled.v, expected.v)
    # Single precision would leave some 1e-8.
    assert np.abs(gap_of(name, assembled.q)).max() < 1e-12 and np.abs(assembled.v).max() > 0.1


def rates(name: str) -> np.ndarray:
    """Circular frequencies about the posture that hangs straight down, from textbook M and K."""
    if name == "four_bar":  # Two bars of 1 kg and 1 m that turn, one that is carried around.
        M, K = np.array([[2 / 3 + 1.0]]), np.array([[2 * G]])
    else:
        (m1, m2), (L1, L2), r = (1.0, 0.7), (0.5, 0.4), 0.02
        turning = m1 * (L1**2 / 3 + r**2 / 4) + m2 * L1**2, m2 * (L2**2 / 3 + r**2 / 4)
        M = np.diag(turning) + m2 * L1 * L2 / 2 * np.array([[0, 1], [1, 0]])
        K = G * np.diag([m1 * L1 / 2 + m2 * L1, m2 * L2 / 2])
    return np.sort(np.sqrt(np.linalg.eigvals(np.linalg.solve(M, K))))


@pytest.mark.parametrize(
    ("name", "hanging"), [("double_pendulum", [np.pi / 2, 0]), ("four_bar", np.pi / 2 * np.array([1, -1, 1]))]
)
def test_equilibrium_state_space_and_modes(name: str, hanging: list[float]) -> None:
    exact, single = pair(name)
    q = sf.assemble(exact, GUESSES[name]).q if exact.nc else np.array([0.2, 0.1])
    rest, same = sf.equilibrium(exact, q), sf.equilibrium(single, q)
    assert np.array_equal(same.q, rest.q) and np.array_equal(same.lam, rest.lam) and same.residual == rest.residual
    assert same.q == pytest.approx(hanging, abs=1e-11)
    expected = sf.state_space(exact, rest.q)
    space = sf.state_space(single, rest.q)
    for ours, theirs in zip((space.A, space.B, space.basis), (expected.A, expected.B, expected.basis), strict=True):
        assert ours.dtype == np.float64 and np.array_equal(ours, theirs)
    poles = np.sort(np.abs(np.linalg.eigvals(space.A)))
    assert poles == pytest.approx(np.repeat(rates(name), 2), rel=1e-9)
    frequencies = sf.modes(single, rest.q).frequencies
    assert np.array_equal(frequencies, sf.modes(exact, rest.q).frequencies)
    assert np.unique(frequencies.round(9)) == pytest.approx(rates(name), rel=1e-8)


def test_inverse_kinematics_and_joint_motion() -> None:
    exact, single = pair("double_pendulum")
    frame = exact.names.frames[-1]
    q = np.array([0.4, 0.5])
    p = exact.frame_pose(frame, q)[0]
    guess = q + 0.1
    expected, reached = (sf.inverse_kinematics(m, {frame: sf.Target(p)}, guess) for m in (exact, single))
    assert reached.converged and np.array_equal(reached.q, expected.q) and reached.q == pytest.approx(q, abs=1e-9)
    path = p[None], np.full((1, 3), 0.1), np.zeros((1, 3))
    motion = sf.joint_motion(single, frame, *path, q=guess)
    for ours, theirs in zip(motion, sf.joint_motion(exact, frame, *path, q=guess), strict=True):
        assert ours.dtype == np.float64 and np.array_equal(ours, theirs)
    # Rods of 0.5 m and 0.4 m in the plane of x and z.
    angles, lengths = np.cumsum(motion[0][0]), np.array([0.5, 0.4])
    assert (lengths @ np.cos(angles), -lengths @ np.sin(angles)) == pytest.approx(p[[0, 2]], abs=1e-9)
    assert exact.frame_jacobian(frame, q)[[0, 2]] @ motion[1][0] == pytest.approx([0.1, 0.1], abs=1e-9)


def test_base_parameters() -> None:
    exact, single = pair("double_pendulum")
    found, expected = sf.base_parameters(single), sf.base_parameters(exact)
    assert found.independent == expected.independent and np.array_equal(found.combine, expected.combine)
    # Six, as of every such pendulum; the lower mass counts at the elbow, L1 = 0.5 m from the pivot.
    assert found.combine.shape == (6, 20) and found.combine[:, 10] == pytest.approx([0.5, 0, 0.25, 0, 0, 0], abs=1e-12)


@pytest.mark.parametrize("name", ["double_pendulum", "four_bar"])
def test_simulation(name: str) -> None:
    exact, single = pair(name)
    q = sf.assemble(exact, GUESSES[name]).q if exact.nc else np.array([0.2, 0.1])
    expected, run = (sf.simulate(m, q, np.zeros(m.nv), 0.1, dt=1e-2) for m in (exact, single))
    assert np.array_equal(run.q, expected.q) and np.array_equal(run.v, expected.v)
    assert run.a.dtype == np.float64 and np.array_equal(run.a, expected.a)
    # It falls, by more than a hundredth, and what it loses in height it gains in speed.
    kinetic, potential = model(name).kinetic_energy(run.q, run.v), model(name).potential_energy(run.q)
    assert kinetic[-1] > 1e-2 and kinetic + potential == pytest.approx(np.full(len(run.t), potential[0]), abs=1e-7)
