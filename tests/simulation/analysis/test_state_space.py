"""Outputs of the linearisation against differences, and the independent changes of a constrained system."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.models import sampled, state_of
from tests.simulation.mechanisms import loop

CLOSED = {
    "four_bar": [1.2, -1.2, 1.2],
    "slider_crank": [0.5, -0.7, 0.4],
    "parallelogram": [1.0, -1.0, 1.0, 1.0],
    "rolling_disc": [0, 0, 0.5, 0.5, 0.5, 0.5, 0.5],
}
OPEN = ("double_pendulum", "cart_pole", "rx90", "space_arm", "flexible_pendulum")
CASES = (*OPEN, *CLOSED, "driven")
STEP = 1e-3
SOLID = sf.Inertia(1.5, (0.1, -0.2, 0.05), (0.3, 0.4, 0.5))


def driven() -> sf.System:
    """An arm on a base that moves as prescribed."""
    base = sf.RigidBody("base", sf.Joint("sweep", "revolute", prescribed=True), SOLID, (sf.Frame("e", (0.5, 0, 0)),))
    arm = sf.RigidBody(
        "arm",
        sf.Joint("q", "revolute", "base", "e", axis=(0, 1, 0), actuated=True),
        SOLID,
        (sf.Frame("tip", (0.3, 0.1, 0.2)),),
    )
    return sf.System("driven", (base, arm))


@cache
def model(name: str) -> sf.Model:
    return sf.compile(driven() if name == "driven" else MODELS[name])


def state(name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return state_of(model(name), CLOSED.get(name))


@pytest.mark.parametrize("name", sampled(CASES, [name for name in CASES if name != "rx90"]))
def test_output_matrices_match_differences(name: str) -> None:
    m = model(name)
    q, v, u = state(name)
    frame = m.names.frames[-1]
    outputs = [
        "q",
        "v",
        "a",
        "lam",
        *((kind, frame) for kind in ("frame_pose", "frame_velocity", "frame_acceleration")),
    ]
    R0 = m.frame_pose(frame, q, u=u)[1]

    def y(x: np.ndarray) -> np.ndarray:
        q1, v1, u1 = m.integrate(q, x[: m.nv]), v + x[m.nv : 2 * m.nv], u + x[2 * m.nv :]
        a, lam = m.forward_dynamics(q1, v1, u1, multipliers=True)
        p, R = m.frame_pose(frame, q1, u=u1)
        turn = R @ R0.T
        small = 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
        V, A = m.frame_velocity(frame, q1, v1, u=u1), m.frame_acceleration(frame, q1, v1, a, u=u1)
        return np.concatenate([m.difference(q, q1), v1, a, lam, p, small, V, A])

    # Sixth order, so that rounding and not truncation is what is left; along what the constraints allow.
    weights = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))
    found = sf.state_space(m, q, v, u, outputs=outputs)
    n = found.basis.shape[1]
    directions = np.block([[found.basis, np.zeros((2 * m.nv, m.nu))], [np.zeros((m.nu, n)), np.eye(m.nu)]]).T
    numeric = np.array([sum(w * (y(i * e) - y(-i * e)) for i, w in weights) / STEP for e in STEP * directions]).T
    exact = np.concatenate([found.C, found.D], axis=1)
    assert exact.shape == numeric.shape
    assert np.abs(exact - numeric).max() < 1e-7 * max(1.0, np.abs(numeric).max())


@pytest.mark.parametrize(("name", "freedoms"), [("four_bar", 2), ("slider_crank", 2), ("rolling_disc", 8)])
def test_states_are_reduced_to_admissible_motions(name: str, freedoms: int) -> None:
    """Two states for a degree of freedom; of the disc's twelve a height and its rate go, and two rates of slip."""
    m = model(name)
    q, u = sf.assemble(m, CLOSED[name]).q, np.zeros(m.nu)
    if name != "rolling_disc":  # Upright it is at rest as it stands.
        q = sf.equilibrium(m, q, u=u).q
    v = np.zeros(m.nv)
    found = sf.state_space(m, q, v, u)
    assert found.A.shape == (freedoms, freedoms)
    assert found.basis.T @ found.basis == pytest.approx(np.eye(freedoms), abs=1e-12)
    # About a state of rest the changes stay among themselves: nothing is projected away.
    A, _ = m.linearize(q, v, u)
    assert found.basis @ found.A == pytest.approx(A @ found.basis, abs=1e-8)


def test_an_accelerometer_on_an_oscillator_matches_theory() -> None:
    """On a mass of 2 kg, spring 50 N/m, damper 2 N s/m it reads x'' = -25 x - x' + u/2."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), actuated=True, elements=(sf.Spring(50.0), sf.Damper(2.0)))
    m = sf.compile(sf.System("s", [sf.RigidBody("b", joint, sf.Inertia(2.0))]))
    found = m.linearize([0.0], [0.0], [0.0], outputs=[("frame_acceleration", "b")])
    assert found.C[0] == pytest.approx([-25.0, -1.0]) and found.D[0] == pytest.approx([0.5])
    assert not found.C[1:].any() and not found.D[1:].any()


def test_unknown_outputs_are_refused() -> None:
    m = model("double_pendulum")
    with pytest.raises(sf.UnknownNameError, match="did you mean 'frame_pose'"):
        m.linearize([0, 0], [0, 0], np.zeros(m.nu), outputs=[("frame_pos", "tip")])
    with pytest.raises(sf.UnknownNameError, match="no frame 'nowhere'"):
        m.linearize([0, 0], [0, 0], np.zeros(m.nu), outputs=[("frame_pose", "nowhere")])


@pytest.mark.parametrize("L", [1e-8, 1e3])
def test_a_loop_and_a_shaft_of_any_sizes_have_the_same_freedoms(L: float) -> None:
    """Conditions on angles beside those of a loop of micrometres, which a rank by the largest of all would drop."""
    thin, axis = (1e-3, 1e-3, 1e-3), (0, -1, 0)
    shaft = sf.RigidBody("shaft", sf.Joint("q4", "revolute", axis=axis), sf.Inertia(1.0, (0.5, 0, 0), thin))
    gear = sf.Nonholonomic("gear", {"dq4": 1.0, "dq1": 2.0})
    more = {"rows": (("x", "y", "z"), ()), "bodies": (shaft,), "constraints": (gear,)}
    system = loop((0.5 * L, L, L), L, axis, inertia=lambda x: sf.Inertia(1.0, (x / 2, 0, 0), thin), **more)
    m = sf.compile(system, sf.Options(backend="interpreter"))
    at = sf.assemble(m, [1.2, -0.9, 1.4, -2.4], held=("q1",))
    linear = sf.state_space(m, at.q)
    assert linear.A.shape == (3, 3)  # Angles of crank and shaft, one speed.


def test_states_of_runs_with_baumgartes_stabilization_have_linear_models() -> None:
    model = sf.compile(MODELS["four_bar"])
    run = sf.simulate(model, [1.2, -1.2, 1.2], t_end=1.0, method="rk4", dt=0.01, stabilisation="baumgarte")
    assert np.isfinite(sf.state_space(model, run.q[-1], run.v[-1]).A).all()
    assert np.isfinite(sf.modes(model, run.q[-1], run.v[-1]).eigenvalues).all()
    with pytest.raises(sf.AssemblyError, match="violates its constraints"):
        sf.state_space(model, run.q[-1] + [0.0, 0.0, 1e-3], run.v[-1])
