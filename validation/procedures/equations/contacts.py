"""Compliant contact by its definition: distances from solids, Hunt and Crossley's push, friction, momentum, power.

Formulas are those of docs/theory/rigid.md, 10.2, worked out by NumPy from the frames' poses and velocities.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

import symofros as sf

from ...contract.quantities import ROUNDING
from ...mechanics.assembly import assemble
from ...mechanics.geometry import Array
from ..scene import Cell, Manifold, Scene, derivative, off
from .analyses import DIFFERENCED

RADIUS, STIFFNESS, LOSS, GRIP, SLOW = 0.1, 1e3, 0.4, 0.6, 0.05
POINTS = ((0.2, 0.1, -0.1), (-0.1, 0.0, 0.15))
# Surface -> what it states, and half height or half edges.
SURFACES: dict[str, dict[str, Any]] = {
    "plane": {},
    "sphere": {"surface_radius": 0.5},
    "cylinder": {"surface_radius": 0.5},
    "capsule": {"surface_radius": 0.3, "length": 0.8},
    "box": {"size": (0.8, 1.0, 0.6)},
    "within a sphere": {"surface": "sphere", "surface_radius": 0.9, "inside": True},
    "within a cylinder": {"surface": "cylinder", "surface_radius": 0.9, "inside": True},
}
EXPONENTS = {"sphere": 2.0, "box": 1.0}
_STATES = 40


def contacts(_: Scene) -> Iterator[Cell]:
    """Two free bodies that touch, by each surface: at random states about the same place."""
    for name in SURFACES:
        exponent = EXPONENTS.get(name, 1.5)
        system = _pair(name, exponent)
        model = sf.compile(system, sf.Options(backend="interpreter"))
        rng = np.random.default_rng(7)
        worst = {"gaps": 0.0, "forces": 0.0, "efforts": 0.0, "momentum": 0.0}
        touched = 0
        for _k in range(_STATES):
            q, v = model.random_state(rng)
            q[:3], q[7:10] = 0.5 * q[:3], 0.5 * q[7:10]
            gaps, balls, efforts = _by_definition(name, exponent, model, q, v)
            found = model.contact_forces(q, v)
            Q = np.asarray(model.generalized_force(q, v, []))
            touched += int(np.any(gaps < 0.0))
            worst["gaps"] = max(worst["gaps"], off(found.gap, gaps))
            answers = np.c_[found.force, found.push, found.point, found.share]
            worst["forces"] = max(worst["forces"], *map(off, answers.T, balls.T))
            worst["efforts"] = max(worst["efforts"], off(Q, efforts))
            worst["momentum"] = max(worst["momentum"], _unbalanced(model, q, Q))
        for what, error in worst.items():
            yield Cell(f"contact with {name}: {what}", error + float(touched < 5), ROUNDING, f"{touched} touch")
    yield from _stored()


def _pair(name: str, exponent: float, lossy: bool = True) -> sf.System:
    """Two free bodies, with frames that are neither at their origins nor along their axes."""
    frames = {
        "one": sf.Frame("skew", (0.05, 0.1, 0.0), sf.Rotation.rpy(0.3, -0.2, 0.4)),
        "two": sf.Frame("bent", (0.0, 0.1, 0.0), sf.Rotation.rpy(0.1, 1.0, 0.0)),
    }
    solid = sf.Inertia(2.0, (0.1, -0.05, 0.02), (0.3, 0.4, 0.35, 0.01, -0.02, 0.03))
    bodies = tuple(sf.RigidBody(one, sf.Joint(f"j{one}", "free"), solid, (frame,)) for one, frame in frames.items())
    losses = {"dissipation": LOSS, "friction": GRIP, "minimum_velocity": SLOW} if lossy else {}
    stated: dict[str, Any] = {"surface": name, "radius": RADIUS, "points": POINTS} | SURFACES[name] | losses
    touch = sf.Contact("touch", ("one", "skew"), ("two", "bent"), STIFFNESS, exponent=exponent, **stated)
    return sf.System("pair", bodies, gravity=(0.0, 0.0, 0.0), connections=(touch,))


def _by_definition(name: str, exponent: float, model: sf.Model, q: Array, v: Array) -> tuple[Array, Array, Array]:
    """Gaps (2); of the balls force in world axes, push, point, and depth as a share of the radius (2, 8); Q (12)."""
    poses = [model.frame_pose(frame, q) for frame in ("skew", "bent")]
    velocities = [model.frame_velocity(frame, q, v) for frame in ("skew", "bent")]
    (_, R), (p_S, R_S) = poses
    J, J_S = (np.asarray(model.frame_jacobian(frame, q)) for frame in ("skew", "bent"))
    gaps, balls, Q = [], [], np.zeros(model.nv)
    for point in POINTS:
        C = poses[0][0] + R @ point
        D, n = _distance(name, R_S.T @ (C - p_S))
        n = R_S @ n
        P = C - D * n
        u = _at(velocities[0], P - poses[0][0]) - _at(velocities[1], P - p_S)
        depth, closing = max(0.0, RADIUS - D), -float(n @ u)
        push = STIFFNESS * depth**exponent * max(0.0, 1.0 + LOSS * closing)
        slip = u + n * closing
        xi = slip / max(float(np.linalg.norm(slip)), 15 / 8 * SLOW)
        square = float(xi @ xi)
        force = push * n - GRIP * push * xi * (15.0 - 10.0 * square + 3.0 * square**2) / 8.0
        Q += J.T @ np.r_[force, np.cross(P - poses[0][0], force)] - J_S.T @ np.r_[force, np.cross(P - p_S, force)]
        gaps.append(D - RADIUS)
        balls.append([*force, push, *P, depth / RADIUS])
    return np.array(gaps), np.array(balls), Q


def _at(velocity: Array, arm: Array) -> Array:
    return np.asarray(velocity[:3] + np.cross(velocity[3:], arm))


def _distance(name: str, x: Array) -> tuple[float, Array]:
    """Signed distance of a point from a solid and its gradient, (60) and (61)."""
    stated = SURFACES[name]
    if "size" in stated:
        beyond = np.abs(x) - np.array(stated["size"]) / 2
        outside = np.maximum(beyond, 0.0)
        deepest = float(beyond.max())
        if deepest > 0.0:
            return float(np.linalg.norm(outside)), np.sign(x) * outside / np.linalg.norm(outside)
        return deepest, np.sign(x) * (beyond == deepest)
    if name == "plane":
        return float(x[2]), np.array([0.0, 0.0, 1.0])
    half = np.inf if "cylinder" in name else stated.get("length", 0.0) / 2
    arm = x - np.array([0.0, 0.0, np.clip(x[2], -half, half)])
    rho, sign = float(np.linalg.norm(arm)), -1.0 if stated.get("inside") else 1.0
    return sign * (rho - stated["surface_radius"]), sign * arm / rho


def _unbalanced(model: sf.Model, q: Array, Q: Array) -> float:
    """Force and moment about the world's origin that both bodies take together, of those that one takes."""
    total = np.zeros(6)
    sizes = []
    for k, body in enumerate(("one", "two")):
        p, R = model.frame_pose(body, q)
        force, moment = R @ Q[6 * k : 6 * k + 3], R @ Q[6 * k + 3 : 6 * k + 6]
        wrench = np.r_[force, moment + np.cross(p, force)]
        total += wrench
        sizes.append(float(np.abs(wrench).max()))
    return float(np.abs(total).max()) / (max(sizes) or 1.0)


def _energy(model: sf.Model, manifold: Manifold, q: Array, theta: Array) -> Array:
    return np.array([model.potential_energy(manifold.retract(q, theta))])


def _stored() -> Iterator[Cell]:
    """What a contact without losses stores is what its force does not give back: the force is the slope of V."""
    for name in ("plane", "capsule", "within a sphere"):
        system = _pair(name, 1.5, lossy=False)
        model, manifold = sf.compile(system, sf.Options(backend="interpreter")), Manifold.of(assemble(system))
        rng, worst = np.random.default_rng(8), 0.0
        for _k in range(8):
            q, v = model.random_state(rng)
            q[:3], q[7:10] = 0.3 * q[:3], 0.3 * q[7:10]

            slope = derivative(partial(_energy, model, manifold, q), 0.0 * v, 1e-4)[0]
            Q = np.asarray(model.generalized_force(q, 0.0 * v, []))
            worst = max(worst, float(np.abs(Q + slope).max()) / max(float(np.abs(Q).max()), STIFFNESS * 1e-3))
        yield Cell(f"contact with {name}: energy", worst, 10.0 * DIFFERENCED)
