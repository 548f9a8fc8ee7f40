"""Wrenches of constraints and efforts of drives, by the power that they have to have.

Models are interpreted: what is compared here is how reactions are formed; how C is written shows in other functions.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

import symofros as sf
from validation.mechanics.assembly import Assembly, anchor_name, assemble
from validation.mechanics.geometry import Array
from validation.procedures.scene import Cell, Scene, derivative, off

ROUNDING, DIFFERENCED = 1e-11, 1e-8
SEED = 6


def of_constraints(scene: Scene) -> Iterator[Cell]:
    """Wrenches on both sides of every constraint: by virtual power they are G^T lam."""
    functions = ("closure_wrenches", "constraint_jacobian", "frame_jacobian")
    model = sf.compile(scene.system, sf.Options(functions, backend="interpreter"))
    assembly = assemble(scene.system)
    lam = np.random.default_rng(SEED).standard_normal(model.nc)
    forces = np.zeros(model.nv)
    for item in scene.system.constraints:
        for side, frame in _sides(item, assembly):
            if frame:
                wrench = model.closure_wrench(item.name, scene.q, lam, on=side)  # type: ignore[arg-type]
                forces += model.frame_jacobian(frame, scene.q).T @ wrench
    yield Cell("wrenches of constraints", off(forces, model.constraint_jacobian(scene.q).T @ lam), ROUNDING)


def _sides(item: sf.Constraint, assembly: Assembly) -> Iterator[tuple[str, str]]:
    """Side and name of the frame that a constraint acts on, "" for the world's own; none of conditions by formula."""
    if isinstance(item, sf.Closure | sf.Rod):
        yield "first", anchor_name(assembly, item.first)
        yield "second", anchor_name(assembly, item.second)
    elif isinstance(item, sf.KnifeEdge | sf.Rolling):
        yield "second", anchor_name(assembly, item.anchor)


def carried_arm() -> sf.System:
    """An arm between two prescribed joints, with rotors, a spring, a damper, a connection and a potential."""
    cart = sf.RigidBody(
        "cart",
        sf.Joint("q1", "prismatic", axis=(0.8, 0.6, 0.0), prescribed=True, armature=0.3),
        sf.Inertia(2.0, (0.1, 0.0, 0.2), (0.1, 0.2, 0.3)),
        (sf.Frame("hook", (0.1, 0.2, 0.5)),),
    )
    elements = (sf.Spring(3.0, 0.1), sf.Damper(0.7))
    arm = sf.RigidBody(
        "arm",
        sf.Joint(
            "q2",
            "revolute",
            "cart",
            position=(0.0, 0.1, 0.0),
            axis=(0.0, 0.8, 0.6),
            actuated=True,
            elements=elements,
            rotors=(sf.Rotor(0.02, 5.0),),
        ),
        sf.Inertia(1.0, (0.2, 0.1, 0.0), (0.1, 0.1, 0.1)),
    )
    head = replace(
        arm,
        name="head",
        joint=sf.Joint(
            "q3",
            "revolute",
            "arm",
            position=(0.4, 0.0, 0.1),
            axis=(1.0, 0.0, 0.0),
            prescribed=True,
            rotors=(sf.Rotor(0.01, 7.0),),
        ),
        inertia=sf.Inertia(0.5, (0.0, 0.1, 0.1), (0.02, 0.03, 0.04)),
        frames=(sf.Frame("eye", (0.0, 0.3, 0.0)),),
    )
    spring = sf.Connection("spring", ("cart", "hook"), ("head", "eye"), 12.0, 0.2)
    magnet = sf.Potential("magnet", sf.formula("2*cos(q1)*sin(q3) + 0.5*q2^2*q1"))
    return sf.System("carried_arm", (cart, arm, head), connections=(spring,), potentials=(magnet,))


def of_drives(_: Scene) -> Iterator[Cell]:
    """d(T + V)/dt is the power of drives, actuator and damper; T + V is differentiated along the motion."""
    model = sf.compile(carried_arm(), sf.Options(backend="interpreter"))
    rng = np.random.default_rng(SEED)
    q, v = rng.standard_normal((2, 1))
    motion, effort = rng.standard_normal((2, 3)), 1.3

    def inputs(s: float) -> Array:
        moved = [[x + s * rate + 0.5 * s * s * a, rate + s * a, a] for x, rate, a in motion]
        return np.concatenate([[effort], *moved])

    a = np.asarray(model.forward_dynamics(q, v, inputs(0.0)))

    def energy(s: Array) -> Array:
        moved, ahead, u = q + s * v + 0.5 * s * s * a, v + s * a, inputs(float(s[0]))
        return np.array([model.kinetic_energy(moved, ahead, u=u) + model.potential_energy(moved, u=u)])

    drives = np.asarray(model.prescribed_efforts(q, v, a, inputs(0.0)))
    power = drives @ motion[:, 1] + effort * v[0] - 0.7 * v[0] ** 2
    yield Cell("power of drives", off(np.array([power]), derivative(energy, np.zeros(1))[0]), DIFFERENCED)
