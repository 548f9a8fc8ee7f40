"""Applied forces by formula, by connections, loads, potentials, against NumPy and kinematics; derivatives with them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

import symofros as sf

from ...mechanics.assembly import assemble
from ...mechanics.geometry import Array
from ..scene import Cell, Manifold, Scene, derivative, off

ROUNDING, DIFFERENCED = 1e-11, 1e-7
# Formula of a coordinate q and the next one p -> the same by NumPy.
FORMULAS: dict[str, Callable[[float, float], float]] = {
    "{q}^3 - {p}/{q}": lambda q, p: q**3 - p / q,
    "exp({q}) + log({p})": lambda q, p: np.exp(q) + np.log(p),
    "sin({q})*cos({p})": lambda q, p: np.sin(q) * np.cos(p),
    "tan({q}) + sqrt({p})": lambda q, p: np.tan(q) + np.sqrt(p),
    "asin({q}) - acos({p})": lambda q, p: np.arcsin(q) - np.arccos(p),
    "atan({q}) + atan2({p}, {q})": lambda q, p: np.arctan(q) + np.arctan2(p, q),
    "sinh({q}) + cosh({p}) - tanh({q})": lambda q, p: np.sinh(q) + np.cosh(p) - np.tanh(q),
    "abs({q} - 1)*sign({p}) + {q}^{p}": lambda q, p: abs(q - 1) * np.sign(p) + q**p,
    "min({q}, {p}) + max(2*{q}, {p})": lambda q, p: min(q, p) + max(2 * q, p),
}


def formulas(_: Scene) -> Iterator[Cell]:
    """Every function of formulas, and its derivative; at a tie the smaller of two counts half, as the larger does."""
    n = len(FORMULAS)
    names = [f"x{i}" for i in range(n)]
    efforts = [text.format(q=names[i], p=names[(i + 1) % n]) for i, text in enumerate(FORMULAS)]
    bodies = tuple(
        sf.RigidBody(
            f"b{i}",
            sf.Joint(names[i], "prismatic", axis=(1.0, 0.0, 0.0), effort=(sf.formula(efforts[i]),)),
            sf.Inertia(1),
        )
        for i in range(n)
    )
    system = sf.System("formulas", bodies)
    q: Array = np.asarray(0.3 + 0.05 * np.arange(n), dtype=np.float64)

    def forces(x: Array) -> Array:
        return np.array([f(x[i], x[(i + 1) % n]) for i, f in enumerate(FORMULAS.values())])

    for backend in ("c", "interpreter"):
        model = sf.compile(system, sf.Options(backend=backend))
        yield Cell(f"functions of formulas, {backend}", off(model.generalized_force(q, 0 * q, []), forces(q)), ROUNDING)
        by_q = model.forward_dynamics_derivatives(q, 0 * q, [])[0]
        yield Cell(f"derivatives of functions, {backend}", off(by_q, derivative(forces, q)), DIFFERENCED)
        tied = np.full(n, 0.4)
        row = model.forward_dynamics_derivatives(tied, 0 * q, [])[0][-1]
        yield Cell(f"derivatives at a tie, {backend}", off(row[[n - 1, 0]], np.array([2.5, 0.5])), ROUNDING)


def carried(loaded: bool = True) -> sf.System:
    """A body on a ball joint that carries a rod, with every kind of applied force between them and from outside.

    Args:
        loaded: Whether there are forces from outside.
    """
    ball = sf.Joint("b", "ball", position=(0.1, 0.0, 0.2))
    first = sf.RigidBody(
        "first",
        ball,
        sf.Inertia(1.2, center_of_mass=(0.1, 0.2, -0.1), moments=(0.2, 0.25, 0.3)),
        frames=(sf.Frame("side", (0.3, -0.1, 0.2), sf.Rotation.rpy(0.2, -0.4, 0.7)),),
        loads=(
            sf.Load(
                force=(1.0, -2.0, sf.formula("F")), torque=(0.3, sf.formula("0.2*t"), -0.4), at="side", axes="body"
            ),
            sf.Load(force=(sf.formula("0.5*dq"), 0.2, 1.0), at="center_of_mass", axes="world"),
        )
        if loaded
        else (),
    )
    rod = sf.RigidBody(
        "rod",
        sf.Joint(
            "q",
            "revolute",
            parent="first",
            position=(0.2, 0.1, 0.0),
            axis=(0.6, 0.0, 0.8),
            elements=(
                sf.Stop(2.0, upper=-5.0),
                sf.Stop(2.0, lower=5.0),
                sf.Spring(3.0, rest=0.1, cubic=2.0),
                sf.Damper(0.2, quadratic=0.2),
                sf.Damper(0.1),
            ),
        ),
        sf.Inertia(0.7, center_of_mass=(0.0, 0.1, 0.1), moments=(0.1, 0.12, 0.14)),
        frames=(sf.Frame("tip", (0.1, 0.3, 0.4)),),
    )
    return sf.System(
        "carried",
        (first, rod),
        inputs=(sf.Input("F"),),
        connections=(
            sf.Connection("spring", ("world", None), ("rod", "tip"), stiffness=40.0, length=0.2, damping=1.5),
            sf.Connection("inner", ("first", "side"), ("rod", "tip"), stiffness=9.0, damping=0.7),
        ),
        potentials=(sf.Potential("well", sf.formula("0.4*sin(2*q)")),),
        virtual_power=(sf.VirtualPower("drag", (("dq", sf.formula("-0.6*dq*q")),)),),
    )


def applied(_: Scene) -> Iterator[Cell]:
    """Q of connections, loads, elements, potentials by Jacobians of frames; its potential part by differences of V."""
    system = carried()
    model = sf.compile(system)
    manifold = Manifold.of(assemble(system))
    q, v = model.random_state(np.random.default_rng(6))
    t, u = 0.8, np.array([0.9])
    Q = np.zeros(model.nv)
    i, (angle, rate) = model.nv - 1, (q[-1], v[-1])

    def jacobian(frame: str) -> Array:
        return np.asarray(model.frame_jacobian(frame, q))

    tip, side = model.frame_pose("tip", q)[0], model.frame_pose("side", q)[0]
    J_tip, J_side = jacobian("tip")[:3], jacobian("side")[:3]
    length = float(np.linalg.norm(tip))
    stretching = tip @ J_tip / length
    Q -= stretching * (40.0 * (length - 0.2) + 1.5 * float(stretching @ v))
    inner = J_tip - J_side  # Without a rest length the damper takes all of the relative velocity.
    Q -= inner.T @ (9.0 * (tip - side) + 0.7 * inner @ v)
    R = model.frame_pose("side", q)[1]
    Q += jacobian("side").T @ np.concatenate([R @ [1.0, -2.0, u[0]], R @ [0.3, 0.2 * t, -0.4]])
    R_first = model.frame_pose("first", q)[1]
    J = jacobian("first")
    arm = R_first @ [0.1, 0.2, -0.1]
    outside = np.array([0.5 * rate, 0.2, 1.0])
    Q += J.T @ np.concatenate([outside, np.cross(arm, outside)])
    Q[i] += -3.0 * (angle - 0.1) - 2.0 * (angle - 0.1) ** 3 - 0.3 * rate - 0.2 * abs(rate) * rate
    Q[i] += -2.0 * (angle + 5.0) + 2.0 * (5.0 - angle)  # Beyond both ends of the stop, as they are stated.
    Q[i] += -0.8 * np.cos(2 * angle) - 0.6 * rate * angle
    yield Cell("applied forces", off(model.generalized_force(q, v, u, t=t), Q), 1e-10)
    still = 0.0 * v

    def potential(theta: Array) -> Array:
        return np.array([model.potential_energy(manifold.retract(q, theta), u=0 * u)])

    weight = model.bias(q, still)
    without = sf.compile(carried(loaded=False))
    conserved = weight - without.generalized_force(q, still, 0 * u)
    yield Cell("potential energy of forces", off(derivative(potential, still)[0], conserved), DIFFERENCED)

    def inverse(x: Array) -> Array:
        moved = manifold.retract(q, x[: model.nv])
        return np.asarray(model.inverse_dynamics(moved, v + x[model.nv :], v, u=u, t=t))

    by_q, by_v = model.inverse_dynamics_derivatives(q, v, v, u=u, t=t)
    yield Cell(
        "derivatives of applied forces",
        off(np.hstack([by_q, by_v]), derivative(inverse, np.concatenate([still, still]))),
        DIFFERENCED,
    )


def each_coordinate(_: Scene) -> Iterator[Cell]:
    """Springs, dampers, friction and stops on every coordinate of joints that have several."""
    kinds = {"universal": 2, "cylindrical": 2, "planar": 3}
    bodies, wanted = [], []
    rng = np.random.default_rng(23)
    factor = sf.formula("2*t - 0.5")
    for kind, count in kinds.items():
        numbers = rng.uniform(0.5, 3.0, (count, 6))
        elements: list[Any] = []
        for k, (stiffness, damping, force, rest, soft, wall) in enumerate(numbers):
            elements += [
                sf.Spring(stiffness, rest=rest, coordinate=k),
                sf.Damper(damping, coordinate=k),
                sf.Friction(force, viscous=soft, minimum_velocity=1e-3, coordinate=k, factor=factor),
                sf.Stop(wall, upper=-4.0, coordinate=k),
            ]
        joint = sf.Joint(kind[0], kind, elements=tuple(elements))  # type: ignore[arg-type]
        bodies.append(sf.RigidBody(kind, joint, sf.Inertia(1.0, moments=(0.1, 0.1, 0.1))))
        wanted.append(numbers)
    model = sf.compile(sf.System("several", tuple(bodies)), sf.Options(backend="interpreter"))
    q, v = rng.uniform(-1.0, 1.0, (2, model.nv))
    stiffness, damping, force, rest, soft, wall = np.concatenate(wanted).T
    efforts = -stiffness * (q - rest) - (damping + soft) * v - 0.9 * force * np.sign(v) - wall * (q + 4.0)
    yield Cell("forces on every coordinate", off(model.generalized_force(q, v, [], t=0.7), efforts), ROUNDING)


def rods(_: Scene) -> Iterator[Cell]:
    """The condition of a rod by its length; its Jacobian and bias by differences along a motion."""
    length = 0.8
    bar = sf.Rod("bar", ("world", None), ("rod", "tip"), length)
    system = replace(carried(loaded=False), constraints=(bar,))
    model, manifold = sf.compile(system), Manifold.of(assemble(system))
    q, v = model.random_state(np.random.default_rng(6))

    def phi(theta: Array) -> Array:
        p = np.asarray(model.frame_pose("tip", manifold.retract(q, theta))[0])
        return np.array([(p @ p - length**2) / (2 * length)])

    def rate(s: Array) -> Array:
        ahead = manifold.retract(q, s[0] * v)
        return np.asarray(model.constraint_jacobian(ahead) @ v)

    G, still = model.constraint_jacobian(q), np.zeros(model.nv)
    yield Cell("condition of a rod", off(model.constraint(q), phi(still)), ROUNDING)
    yield Cell("Jacobian of a rod", off(G, derivative(phi, still)), DIFFERENCED)
    yield Cell("rate of a rod", off(model.constraint_rate(q, v), G @ v), ROUNDING)
    yield Cell("bias of a rod", off(model.constraint_bias(q, v), -derivative(rate, np.zeros(1))[:, 0]), DIFFERENCED)
