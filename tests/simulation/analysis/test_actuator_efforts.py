"""Efforts of chosen actuators: closed forms, round trips with forward dynamics, least norm, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS

G = 9.81
INTERPRETED = sf.Options(backend="interpreter")


def slider_crank(r: float = 1.0, rod: float = 2.5, mass: float = 1.0, **crank: bool) -> sf.System:
    """A crank in the x-z plane, its rod, and a piston on the x axis that 10 N push back, in units of mass and r."""
    push = sf.Load((-10.0 * mass, 0, 0), at="body")
    return sf.System(
        "slider_crank",
        [
            sf.RigidBody(
                "crank",
                sf.Joint("q1", "revolute", axis=(0, -1, 0), **crank),
                sf.Inertia(mass, (r / 2, 0, 0), (mass * r * r / 12,) * 3),
                [sf.Frame("end", (r, 0, 0))],
            ),
            sf.RigidBody(
                "rod",
                sf.Joint("q2", "revolute", "crank", "end", axis=(0, -1, 0)),
                sf.Inertia(mass, (rod / 2, 0, 0), (mass * r * r / 12,) * 3),
                [sf.Frame("end", (rod, 0, 0))],
            ),
            sf.RigidBody(
                "piston",
                sf.Joint("q3", "prismatic", axis=(1, 0, 0)),
                sf.Inertia(mass, (0, 0, 0), (mass * r * r,) * 3),
                loads=(push,),
            ),
        ],
        constraints=[sf.Closure("pin", ("piston", None), ("rod", "end"), ("x", "z"))],
        gravity=(0, 0, 0),
    )


def posture(theta: float, r: float = 1.0, rod: float = 2.5) -> tuple[np.ndarray, float]:
    """Coordinates of the slider-crank, and the rod's angle to the axis."""
    beta = np.arcsin(r * np.sin(theta) / rod)
    return np.array([theta, -beta - theta, r * np.cos(theta) + rod * np.cos(beta)]), float(beta)


@pytest.mark.parametrize(("scale", "mass"), [(1e-6, 1e-6), (1e-3, 1e6), (1.0, 1.0), (1e3, 1e-6), (1e3, 1e6)])
def test_the_torque_of_a_crank_that_holds_a_piston(scale: float, mass: float) -> None:
    """tau = F r sin(theta + beta)/cos(beta), by virtual work, at every size and mass; here F pushes back."""
    m = sf.compile(slider_crank(scale, 2.5 * scale, mass, actuated=True), INTERPRETED)
    q, beta = posture(0.8, scale, 2.5 * scale)
    result = sf.actuator_efforts(m, q, np.zeros(3), np.zeros(3))
    wanted = -10.0 * mass * scale * np.sin(0.8 + beta) / np.cos(beta)
    assert result.efforts == pytest.approx([wanted], rel=1e-11)
    assert result.redundancy == 0


def test_the_torque_that_holds_a_parallelogram() -> None:
    """The coupler does not turn: V = g l sin(theta) (m_1/2 + m_2 + m_3/2), here of a mass and a metre each."""
    m = sf.compile(MODELS["four_bar"], INTERPRETED)
    q, wanted = [0.7, -0.7, 0.7], 2.0 * G * np.cos(0.7)
    for name in ("q1", "q3"):
        assert sf.actuator_efforts(m, q, np.zeros(3), np.zeros(3), [name]).efforts == pytest.approx([wanted], rel=1e-12)
    # Two alike share alike, which is the least norm; by size in the ratio of the squares of sizes.
    both = sf.actuator_efforts(m, q, np.zeros(3), np.zeros(3), ["q1", "q3"])
    assert both.efforts == pytest.approx([wanted / 2, wanted / 2], rel=1e-12) and both.redundancy == 1
    unlike = sf.actuator_efforts(m, q, np.zeros(3), np.zeros(3), ["q1", "q3"], sizes=[2.0, 1.0])
    assert unlike.efforts == pytest.approx([0.8 * wanted, 0.2 * wanted], rel=1e-12)


def test_an_actuator_and_a_drive_need_the_same_effort() -> None:
    """A crank that is driven as it moves under its actuator: two functions, one torque."""
    free = sf.compile(slider_crank(actuated=True), INTERPRETED)
    driven = sf.compile(slider_crank(prescribed=True), INTERPRETED)
    start = sf.assemble(free, posture(0.8)[0], [3.0, 0, 0], held=["q1"])
    a, lam = free.forward_dynamics(start.q, start.v, [7.0], multipliers=True)
    result = sf.actuator_efforts(free, start.q, start.v, a)
    motion = [start.q[0], start.v[0], a[0]]
    assert result.efforts == pytest.approx([7.0], rel=1e-12)
    assert result.lam == pytest.approx(lam, rel=1e-11)
    drive = driven.prescribed_efforts(start.q[1:], start.v[1:], a[1:], motion, result.lam)
    assert drive == pytest.approx([7.0], rel=1e-12)
    # The actuator is an internal force of its joint: the wrench's moment about the axis (0, -1, 0).
    assert free.joint_wrenches(start.q, start.v, a, [7.0], lam)[0, 4] == pytest.approx(-7.0, rel=1e-12)


def test_a_beam_bent_beyond_its_theory_is_reported() -> None:
    """The worst of a batch: a note from 1 % on, a refusal beyond the limit."""
    beam = sf.Beam("beam", sf.Joint("q1", "revolute", actuated=True), 1.0, 1.0, 1.0, bend_y=1, retain="all")
    m = sf.compile(sf.System("s", [beam]), INTERPRETED)
    q, v = np.array([[0, 0.01], [0, 0.1]]), np.zeros((2, 2))
    a = m.forward_dynamics(q, v, [[1.0], [2.0]])
    assert not sf.actuator_efforts(m, q[0], v[0], a[0]).notes
    result = sf.actuator_efforts(m, q, v, a)
    assert result.efforts == pytest.approx(np.array([[1.0], [2.0]]), rel=1e-11)
    assert len(result.notes) == 1 and "beam" in result.notes[0]
    with pytest.raises(sf.BeamTheoryError, match="the motion lies beyond the theory"):
        sf.actuator_efforts(m, 5 * q, v, m.forward_dynamics(5 * q, v, [[1.0], [2.0]]), beam_limit=0.1)


class TestRefused:
    def test_a_motion_that_needs_more_actuators_is_refused(self) -> None:
        m = sf.compile(MODELS["double_pendulum"], INTERPRETED)
        q, v = np.array([0.3, 0.4]), np.zeros(2)
        with pytest.raises(sf.ActuationError, match="1 independent efforts for 2 freedoms; .* is left at speed 'q2'"):
            sf.actuator_efforts(m, q, v, np.ones(2), [m.names.v[0]])
        # What it does by itself needs none.
        a = m.forward_dynamics(q, v, np.zeros(m.nu))
        assert sf.actuator_efforts(m, q, v, a, [m.names.v[0]]).efforts == pytest.approx([0.0], abs=1e-12)

    @pytest.mark.parametrize(
        ("q", "v", "a", "words"),
        [
            ([0.01, 0, 0], [0, 0, 0], [0, 0, 0], "phi = .* at 'pin"),
            ([0, 0, 0], [1, 0, 0], [0, 0, 0], "G v - b = "),
            ([0, 0, 0], [0, 0, 0], [0, 1, 0], "G a - gamma = "),
        ],
    )
    def test_motions_that_violate_constraints_are_refused(
        self, q: list[float], v: list[float], a: list[float], words: str
    ) -> None:
        m = sf.compile(slider_crank(), INTERPRETED)
        with pytest.raises(sf.ActuationError, match=words):
            sf.actuator_efforts(m, posture(0.8)[0] + q, v, a, ["q1"])

    def test_an_input_with_quadratic_effect_is_refused(self) -> None:
        joint = sf.Joint("q1", "revolute", effort=("current^2",))
        body = sf.RigidBody("b", joint, sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)))
        m = sf.compile(sf.System("s", [body], inputs=[sf.Input("current")]), INTERPRETED)
        with pytest.raises(sf.ActuationError, match="forces not linear in actuators 'current'"):
            sf.actuator_efforts(m, [0.0], [0.0], [2.0])


def test_efforts_that_act_alike_are_redundant() -> None:
    """Two forces along one line at the end of a double pendulum, which no row or column shows as alike."""
    arm = sf.Inertia(1.0, (0.5, 0, 0), (0.1, 0.1, 0.1))
    end, axis = sf.Frame("end", (1, 0, 0)), (0, 1, 0)
    push = [
        sf.Load((sf.formula(f"{k}*u_{n}"), 0, sf.formula(f"{k / 3}*u_{n}")), at="end")
        for k, n in ((0.3, "f"), (0.7, "g"))
    ]
    bodies = [
        sf.RigidBody("upper", sf.Joint("q1", "revolute", axis=axis), arm, [end]),
        sf.RigidBody("lower", sf.Joint("q2", "revolute", "upper", "end", axis=axis), arm, [end], loads=push),
    ]
    m = sf.compile(sf.System("pushed", bodies, inputs=[sf.Input("u_f"), sf.Input("u_g")]), INTERPRETED)
    q, v = np.array([0.37, 0.91]), np.array([0.3, -0.7])
    a = m.forward_dynamics(q, v, [1.0, 2.0])
    result = sf.actuator_efforts(m, q, v, a)
    assert result.redundancy == 1
    # 0.3 f + 0.7 g = 1.7, of least norm.
    assert result.efforts == pytest.approx(1.7 / 0.58 * np.array([0.3, 0.7]), rel=1e-9)


def test_an_actuator_named_twice_is_refused() -> None:
    """It would have one column of efforts, and those behind it another place than their names."""
    m = sf.compile(MODELS["double_pendulum"], INTERPRETED)
    with pytest.raises(sf.ActuationError, match="named more than once\n  found:  'q1'"):
        sf.actuator_efforts(m, [0.1, 0.2], [0, 0], [0, 0], ["q1", "q1", "q2"])


def test_prescribed_motions_are_not_actuators() -> None:
    arm = sf.Inertia(1.0, (0.5, 0, 0), (0.1, 0.1, 0.1))
    bodies = [
        sf.RigidBody("base", sf.Joint("turn", "revolute", prescribed=True), arm),
        sf.RigidBody("arm", sf.Joint("q", "revolute", "base", axis=(0, 1, 0), actuated=True), arm),
    ]
    m = sf.compile(sf.System("driven", bodies), INTERPRETED)
    u = [1.5, 0.2, 0.4, -0.3]
    a = m.forward_dynamics([0.3], [0.2], u)
    result = sf.actuator_efforts(m, [0.3], [0.2], a, u=u)
    assert result.actuators == ("q",) and result.efforts == pytest.approx([1.5], rel=1e-11)
