"""Linearisation against central differences and Pinocchio, equilibria and modes against closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.late import require
from tests.models import compiled as model
from tests.models import sampled
from validation.adapters.pinocchio import tree as pin_adapter
from validation.contract.interface import Subject

pin = require("pinocchio", "validation")
MODEL_NAMES = ("pendulum", "double_pendulum", "cart_pole", "rx90", "space_arm", "flexible_pendulum", "planar_robot")
CLOSED = {"four_bar": [1.2, -1.2, 1.2], "parallelogram": [1.0, -1.0, 1.0, 1.0], "bricard": [0.0] * 5}
# With friction and inputs, on a floating base, elastic, closed, with conditions that repeat each other.
SMALL = ("double_pendulum", "cart_pole", "space_arm", "flexible_pendulum", "four_bar", "parallelogram")
STEP = 1e-4


def without_forces(system: sf.System) -> sf.System:
    """Engines know inertia and weight; efforts and elements are the description's."""
    bodies = [replace(b, joint=b.joint and replace(b.joint, elements=(), effort=()), loads=()) for b in system.bodies]
    return replace(system, bodies=tuple(bodies), connections=(), virtual_power=(), potentials=())


def state(name: str, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    m, rng = model(name), np.random.default_rng(seed)
    if name in CLOSED:
        found = sf.assemble(m, CLOSED[name], rng.normal(size=m.nv))
        return found.q, found.v, rng.normal(size=m.nu)
    q, v = m.random_state(rng)
    return q, v, rng.normal(size=m.nu)


def acceleration(name: str, q: np.ndarray, v: np.ndarray, u: np.ndarray, change: np.ndarray) -> np.ndarray:
    m = model(name)
    return m.forward_dynamics(m.integrate(q, change[: m.nv]), v + change[m.nv : 2 * m.nv], u + change[2 * m.nv :])


@pytest.mark.parametrize("name", sampled((*MODEL_NAMES, *CLOSED), SMALL))
def test_central_differences(name: str) -> None:
    m = model(name)
    q, v, u = state(name)
    A, B = m.linearize(q, v, u)
    # Off the constraints redundant conditions contradict each other, and there is nothing to differentiate: the
    # directions are those that the constraints allow, all of them where there are none.
    S = sf.state_space(m, q, v, u).basis
    directions = np.block([[S, np.zeros((2 * m.nv, m.nu))], [np.zeros((m.nu, S.shape[1])), np.eye(m.nu)]]).T
    # Sixth order, so that rounding and not truncation is what is left.
    weights = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))
    numeric = np.array(
        [
            sum(w * (acceleration(name, q, v, u, i * e) - acceleration(name, q, v, u, -i * e)) for i, w in weights)
            / STEP
            for e in STEP * directions
        ]
    )
    exact = directions @ np.concatenate([A[m.nv :], B[m.nv :]], axis=1).T
    scale = max(1.0, float(np.abs(numeric).max()))
    assert np.abs(exact - numeric).max() / scale < 1e-7


@pytest.mark.parametrize("name", ["rx90", "space_arm"])
def test_the_rows_of_q_along_the_flow(name: str) -> None:
    """How a small difference of q changes as both configurations move on with the same speeds."""
    m = model(name)
    q, v, u = state(name)
    A, _ = m.linearize(q, v, u)
    h, d = 1e-4, 1e-4

    def carried(change: np.ndarray, time: float) -> np.ndarray:
        return m.difference(m.integrate(q, time * v), m.integrate(m.integrate(q, change), time * v))

    for k in range(m.nv):
        e = d * np.eye(m.nv)[k]
        rate = (carried(e, h) - carried(-e, h) - carried(e, -h) + carried(-e, -h)) / (4 * h * d)
        assert np.abs(rate - A[: m.nv, k]).max() < 1e-5
    assert np.array_equal(A[: m.nv, m.nv :], np.eye(m.nv))


@pytest.mark.parametrize(
    "name",
    sampled(
        ("pendulum", "double_pendulum", "cart_pole", "rx90", "open_chain_5r", "chain7", "mss"),
        ("double_pendulum", "cart_pole", "open_chain_5r"),
    ),
)
def test_derivatives_of_inverse_dynamics_against_pinocchio(name: str) -> None:
    system = MODELS[name]
    m = model(name)
    engine = pin_adapter.build(Subject(name, system))
    rng = np.random.default_rng(3)
    q, v = m.random_state(rng)
    a = rng.normal(size=m.nv)
    passive = sf.compile(without_forces(system), sf.Options(functions=("inverse_dynamics_derivatives",)))
    by_q, by_v = passive.inverse_dynamics_derivatives(q, v, a)
    data = engine.model.createData()
    pin.computeRNEADerivatives(engine.model, data, q, v, a)
    for ours, theirs in ((by_q, data.dtau_dq), (by_v, data.dtau_dv)):
        scale = max(1.0, float(np.abs(theirs).max()))
        assert np.abs(ours - np.reshape(theirs, ours.shape)).max() / scale < 1e-10


def test_batches_are_states_one_by_one() -> None:
    m = model("rx90")
    many = [state("rx90", seed) for seed in range(4)]
    q, v, u = (np.array(x) for x in zip(*many, strict=True))
    A, B = m.linearize(q, v, u)
    for i, one in enumerate(many):
        A1, B1 = m.linearize(*one)
        assert np.allclose(A[i], A1, rtol=1e-12, atol=1e-12) and np.allclose(B[i], B1, rtol=1e-12, atol=1e-12)


class TestEquilibrium:
    def test_a_pendulum_hangs(self) -> None:
        found = sf.equilibrium(model("flexible_pendulum"), [1.2, 0, 0, 0])
        assert found.q[0] == pytest.approx(np.pi / 2, abs=1e-10) and np.abs(found.q[1:]).max() < 1e-10

    def test_a_loop_hangs_and_its_multipliers_carry_it(self) -> None:
        m = model("four_bar")
        found = sf.equilibrium(m, [-1.2, 1.2, -1.2])
        assert np.abs(m.constraint(found.q)).max() < 1e-11
        # By the parallelogram's symmetry each side carries half of the coupler's weight.
        assert np.abs(found.lam).max() == pytest.approx(0.5 * 9.81, rel=1e-8)

    def test_what_a_held_coordinate_needs(self) -> None:
        m = model("double_pendulum")
        q = np.array([0.4, -0.2])
        found = sf.equilibrium(m, q, held=m.names.v)
        assert np.array_equal(found.q, q)
        assert found.effort == pytest.approx(m.bias(q, [0, 0]), rel=1e-12)

    @pytest.mark.parametrize("turn", [0.4, 1.7, -2.5])
    def test_inputs_replace_the_effort_on_held_coordinates(self, turn: float) -> None:
        m = model("puma560")
        q = np.linspace(turn, -turn, m.nv)
        rest = sf.equilibrium(m, q, held=m.names.v)
        assert rest.inputs is not None and tuple(rest.inputs) == m.names.u
        assert rest.efforts == dict(zip(m.names.v, rest.effort.tolist(), strict=True))
        free = sf.equilibrium(m, q, u=rest.inputs)
        assert free.iterations == 0 and free.inputs == rest.inputs and not free.efforts

    def test_the_input_of_a_closed_loop_balances_it(self) -> None:
        m = model("slider_crank").with_parameters(m1=2.0)
        q = sf.assemble(m, [0.5, -0.7, 0.4], held=["turn"]).q
        rest = sf.equilibrium(m, q, held=["turn"])
        assert rest.inputs is not None
        assert np.abs(m.forward_dynamics(rest.q, rest.v, list(rest.inputs.values()))).max() < 1e-9

    def test_coordinates_that_no_input_moves_are_held_by_efforts_alone(self) -> None:
        rest = sf.equilibrium(model("cart_pole"), [0.0, 0.3], held=["x", "q"])
        assert rest.inputs is None and abs(rest.efforts["q"]) > 0.1

    def test_none(self) -> None:
        with pytest.raises(sf.EquilibriumError, match="imbalance of .* at 'x'"):
            sf.equilibrium(model("cart_pole"), [0, 1.0], u=[1.0])


class TestModes:
    @pytest.mark.parametrize(("eta", "first"), [(0.0, 3.5160152685), (2.0, 3.6217969641), (6.0, 4.2632254202)])
    def test_a_spinning_beam(self, eta: float, first: float) -> None:
        """First frequency in the plane of rotation, of the rotating cantilever (benchmark A1, hub ratio 0)."""
        beam = sf.Beam(
            "b", sf.Joint("hub", "revolute", prescribed=True), 1.0, 1.0, EI_z=1.0, bend_y=6, family="legendre"
        )
        m = sf.compile(sf.System("s", [beam], gravity=(0, 0, 0)))
        u = [0.0, eta, 0.0]
        steady = sf.equilibrium(m, u=u)
        found = sf.modes(m, steady.q, u=u)
        assert found.frequencies[0] == pytest.approx(first, rel=1e-6) and abs(found.damping[0]) < 1e-9

    def test_a_physical_pendulum(self) -> None:
        m = model("pendulum")
        hanging = sf.equilibrium(m, [-1.3])
        M, scale = m.mass_matrix(hanging.q)[0, 0], 1e-4
        stiffness = (m.bias(hanging.q + scale, [0])[0] - m.bias(hanging.q - scale, [0])[0]) / (2 * scale)
        assert sf.modes(m, hanging.q).frequencies[0] == pytest.approx(np.sqrt(stiffness / M), rel=1e-7)

    def test_a_damped_oscillator(self) -> None:
        slide = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(sf.Spring(50.0), sf.Damper(2.0)))
        m = sf.compile(sf.System("s", [sf.RigidBody("b", slide, sf.Inertia(2.0))]))
        found = sf.modes(m, [0.0])
        assert found.frequencies == pytest.approx([5.0]) and found.damping == pytest.approx([0.1])

    @pytest.mark.parametrize(("excess", "stable"), [(-1e-3, False), (1e-3, True)])
    def test_critical_spin_of_a_rolling_disc(self, excess: float, stable: bool) -> None:
        """A thin disc stays upright above w^2 = I_d m g r / (I_a (I_a + m r^2)) (Appell; Neimark & Fufaev)."""
        critical = np.sqrt(0.25 * 9.81 / (0.5 * 1.5))
        turn, names = sf.Rotation.rpy("lean", 0, "yaw"), ("x", "y", "z", "yaw", "lean")
        pose = sf.Joint("pose", "general", coordinates=names, moving_position=("x", "y", "z"), moving_rotation=turn)
        spin = sf.Joint("spin", "revolute", "fork", rotation=sf.Rotation.rpy("pi/2", 0, 0))
        disc = sf.RigidBody("disc", spin, sf.Inertia(1.0, (0, 0, 0), (0.25, 0.25, 0.5)))
        rolling = sf.Rolling("contact", ("disc", None), 1.0)
        m = sf.compile(sf.System("s", [sf.RigidBody("fork", pose), disc], constraints=[rolling]))
        w = critical * (1 + excess)
        at = sf.assemble(m, [0, 0, 1, 0, 0, 0], [w, 0, 0, 0, 0, w], held=["spin"])
        growth = sf.modes(m, at.q, at.v).eigenvalues.real.max()
        assert (growth < 1e-2) == stable
