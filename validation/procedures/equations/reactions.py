"""Wrenches of constraints and efforts of drives, by the power that they have to have.

Models are interpreted: what is compared here is how reactions are formed; how C is written shows in other functions.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

import symofros as sf

from ...mechanics.assembly import Assembly, anchor_name, assemble
from ...mechanics.elastic import POINTS, ElasticBeam
from ...mechanics.geometry import Array
from ...mechanics.quadrature import gauss_stations
from ..scene import Cell, Scene, derivative, off

ROUNDING, DIFFERENCED = 1e-11, 1e-8
# Step of second differences of fourth order in time [s]; they leave 2e-9 of the force, and more than 1e-8 at a third
# of the step and at three times of it.
STEP, TWICE_DIFFERENCED = 3e-4, 1e-7
SEED = 6
IN_PLANE = ("N", "Vz", "My")  # What a beam that bends along z carries.


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


def of_sections(scene: Scene) -> Iterator[Cell]:
    """Forces inside the one beam of a pendulum: at the root by its momentum's rate and its weight; none at the end."""
    run = sf.simulate(scene.model, scene.q, scene.v, 0.02, method="rodas4", rtol=1e-5, atol=1e-8, output=0.005)
    forces = run.section_forces(scene.system.bodies[0].name)
    states = zip(run.q, run.v, run.a, strict=True)
    carried = np.array([_carried(scene, *state) for state in states])
    size = float(np.abs(carried).max())
    yield Cell("section forces at the root", off(forces.values[:, 0, :3], -carried), TWICE_DIFFERENCED)
    yield Cell("section forces at the free end", float(np.abs(forces.values[:, -1]).max()) / size, ROUNDING)
    between = 0.25 * forces.values[1] + 0.75 * forces.values[2]
    error = off(forces.at(0.25 * run.t[1] + 0.75 * run.t[2]), between)
    yield Cell("section forces between records", error + float(forces.present != IN_PLANE), ROUNDING)


def _carried(scene: Scene, q: Array, v: Array, a: Array) -> Array:
    """Force (3,) on the root of a beam on a hinge in the world, in its axes, by the harness's own shape functions."""
    (described,) = scene.system.bodies
    assert isinstance(described, sf.Beam)
    beam = ElasticBeam(described, scene.system.parameter_values())
    x, weights = gauss_stations(beam.knots, POINTS)
    axis = np.array(described.joint.axis, dtype=float)

    def turned(angle: float) -> Array:
        return np.asarray(Rotation.from_rotvec(angle * axis).as_matrix())

    def momentum_place(s: float) -> Array:
        moved = q + s * v + 0.5 * s * s * a
        places = beam.axis(x, moved[None, 1:], 0.0 * moved[None, 1:]).value[0]
        return np.asarray(turned(moved[0]) @ (weights * beam.section("rhoA", x) @ places))

    near, far = (momentum_place(s) + momentum_place(-s) for s in (STEP, 2 * STEP))
    rate = (16 * near - far - 30 * momentum_place(0.0)) / (12 * STEP**2)
    mass = float(weights @ beam.section("rhoA", x))
    return np.asarray(turned(q[0]).T @ (rate - mass * np.array(scene.system.gravity, dtype=float)))
