"""Descriptions that state the same mechanism otherwise, so that what one says follows from what the other does.

Each restatement is of the description alone: no equation of motion enters, and no reference is asked.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, cast

import numpy as np

import symofros as sf

from ..contract.interface import Unsupported
from ..mechanics.assembly import assemble
from ..mechanics.geometry import Array, Placement, quaternion_matrix, rotation_matrix
from .units import BY_FORMULA, Rescaled, Units, numbers_of

WORLD = "world"
# Factors of other units: no powers of two, so that every product is rounded anew.
LENGTH, MASS, TIME = 3.1, 0.37, 1.7


@dataclass(frozen=True)
class Restated:
    """The same mechanism, stated otherwise.

    Attributes:
        system: Description.
        names: Name of a frame in the original -> its name here, where they differ.
        same_order: Whether coordinates, speeds and inputs come in the same order; else they are found by their names.
        world: Placement of the original's world in this one.
        units: Units of this one.
        forces: Whether it states the forces and frames, too; else inertia alone.
        margin: Factor of the tolerances, for numbers that it states with roundings of their own.
    """

    system: sf.System
    names: Mapping[str, str] = field(default_factory=dict)
    same_order: bool = False
    world: Placement = field(default_factory=Placement.identity)
    units: Units = field(default_factory=Units)
    forces: bool = True
    margin: float = 1.0


Answer = Restated | Unsupported
Restatement = Callable[[sf.System, np.random.Generator], Answer]


def turned(stated: sf.System, rng: np.random.Generator) -> Answer:
    """All of it in another place, gravity included: it hangs on a body that is fixed to the world elsewhere."""
    rolling = [item for item in stated.constraints if isinstance(item, sf.Rolling)]
    if rolling:
        return Unsupported(f"constraint '{rolling[0].name}' rolls on a level plane of the world")
    quaternion = rng.standard_normal(4)
    quaternion /= np.linalg.norm(quaternion)
    world = Placement(quaternion_matrix(quaternion), rng.uniform(-5.0, 5.0, 3))
    elsewhere = _free_name(stated, "elsewhere")
    placed = sf.Joint(f"{elsewhere} placed", "fixed", position=_vector(world.p), rotation=_rotation(world.R))
    ground = next((body.frames for body in stated.bodies if body.name == WORLD), ())
    bodies: list[Any] = [sf.RigidBody(elsewhere, placed, frames=ground)]
    for body in stated.bodies:
        if body.name == WORLD:
            continue
        joint = body.joint or sf.Joint(f"{body.name} held", "fixed")
        loads = [_turned_load(load, world.R) for load in body.loads]
        if None in loads:
            return Unsupported(f"body '{body.name}': a load along axes of the world, by formula")
        carried = replace(joint, parent=elsewhere) if joint.parent == WORLD else joint
        bodies.append(replace(cast(Any, body), joint=carried, loads=tuple(loads)))
    gravity = _vector(world.R @ assemble(stated).gravity)

    def anchored(item: Any) -> Any:
        ends = {name: getattr(item, name, None) for name in ("first", "second", "anchor")}
        return replace(item, **{n: (elsewhere, end[1]) for n, end in ends.items() if end and end[0] == WORLD})

    connections, constraints = (tuple(map(anchored, items)) for items in (stated.connections, stated.constraints))
    moved = replace(stated, bodies=tuple(bodies), gravity=gravity, connections=connections, constraints=constraints)
    return Restated(moved, world=world)


def _turned_load(load: Any, R: Array) -> Any:
    """A load in the turned world; None where its components along world axes are formulas."""
    if load.axes != WORLD:
        return load
    if not all(isinstance(x, float) for x in (*load.force, *load.torque)):
        return None
    return replace(load, force=_vector(R @ load.force), torque=_vector(R @ load.torque))


def permuted(stated: sf.System, rng: np.random.Generator) -> Answer:
    """A system with its bodies in another order, siblings among them; what is named is found by its name."""
    if len(stated.bodies) < 2:
        return Unsupported("one body has no order")
    order = rng.permutation(len(stated.bodies))
    if np.all(np.diff(order) > 0):
        order = order[::-1]
    return Restated(replace(stated, bodies=tuple(stated.bodies[i] for i in order)))


def divided(stated: sf.System, rng: np.random.Generator) -> Answer:
    """A part of each rigid body as one of its own, welded to it somewhere and turned."""
    bodies, parameters = list(stated.bodies), stated.parameter_values()
    for k, body in enumerate(stated.bodies):
        inertia = body.inertia if isinstance(body, sf.RigidBody) else None
        if inertia is None:
            continue
        numbers = numbers_of((inertia.mass, *inertia.center_of_mass, *inertia.moments), parameters)
        turn = numbers_of(inertia.rotation.values, parameters)
        if numbers is None or turn is None or not numbers[0] > 0.0:
            continue
        R_BC, center, share = rotation_matrix(inertia.rotation.kind, turn), numbers[1:4], float(rng.uniform(0.2, 0.8))
        quaternion = rng.standard_normal(4)
        weld = Placement(quaternion_matrix(quaternion / np.linalg.norm(quaternion)), rng.uniform(-0.5, 0.5, 3))
        mass, moments = numbers[0], numbers[4:]
        if inertia.about == "body":  # About Bo, and so is what is left.
            moments = _moments(_matrix(moments) + mass * (np.outer(center, center) - center @ center * np.eye(3)))
        rest = sf.Inertia(
            (1.0 - share) * mass, _vector(center), tuple((1.0 - share) * moments), rotation=_rotation(R_BC)
        )
        part = sf.Inertia(
            share * mass,
            _vector(weld.R.T @ (center - weld.p)),
            tuple(share * moments),
            rotation=_rotation(weld.R.T @ R_BC),
        )
        name = _free_name(stated, f"{body.name} part")
        joint = sf.Joint(f"{name} weld", "fixed", body.name, None, _vector(weld.p), _rotation(weld.R))
        bodies[k] = replace(cast(sf.RigidBody, body), inertia=rest)
        bodies.append(sf.RigidBody(name, joint, part, waive=body.waive))
    if len(bodies) == len(stated.bodies):
        return Unsupported("no rigid body has a mass by numbers")
    return Restated(replace(stated, bodies=tuple(bodies)))


def seated(stated: sf.System, rng: np.random.Generator) -> Answer:
    """Each joint on a link of its own without mass, which is welded where the joint was."""
    del rng
    bodies: list[Any] = []
    for body in stated.bodies:
        if body.joint is not None and body.joint.kind != "fixed":
            joint, name = body.joint, _free_name(stated, f"{body.name} seat")
            seat = sf.Joint(f"{name} weld", "fixed", joint.parent, joint.frame, joint.position, joint.rotation)
            bodies.append(sf.RigidBody(name, seat))
            rotors = tuple(_carried(one, joint.parent) for one in joint.rotors)
            origin = {"frame": None, "position": (0.0, 0.0, 0.0), "rotation": sf.Rotation()}
            body = replace(body, joint=replace(cast(Any, joint), parent=name, rotors=rotors, **origin))
        bodies.append(body)
    if len(bodies) == len(stated.bodies):
        return Unsupported("no joint moves")
    return Restated(replace(stated, bodies=tuple(bodies)))


def _carried(rotor: sf.Rotor, parent: str) -> sf.Rotor:
    """A rotor on the link that it was on; without an axis it spins about its joint's, which stands as it did."""
    return rotor if rotor.axis is None else replace(rotor, carrier=rotor.carrier or parent)


def renamed(stated: sf.System, rng: np.random.Generator) -> Answer:
    """Bodies, frames, connections and constraints by names whose order is another; coordinates keep theirs."""
    bodies = [body.name for body in stated.bodies]
    new = {name: f"n{k}" for name, k in zip(bodies, rng.permutation(len(bodies)), strict=True)}
    own = {
        (body.name, frame.name): f"f{len(body.frames) - k}"
        for body in stated.bodies
        for k, frame in enumerate(body.frames)
    }

    def anchor(end: Any) -> Any:
        return end and (new.get(end[0], end[0]), own.get((end[0], end[1]), end[1]))

    def placed(item: Any, number: int) -> Any:
        ends = {name: anchor(getattr(item, name)) for name in ("first", "second", "anchor") if hasattr(item, name)}
        return replace(item, **ends, name=f"c{number}")

    changed = []
    for body in stated.bodies:
        joint = body.joint
        if joint is not None:
            rotors = tuple(replace(one, carrier=new.get(one.carrier or "", one.carrier)) for one in joint.rotors)
            frame = own.get((joint.parent, joint.frame or ""), joint.frame)
            joint = replace(joint, parent=new.get(joint.parent, joint.parent), frame=frame, rotors=rotors)
        frames = tuple(replace(frame, name=own[body.name, frame.name]) for frame in body.frames)
        loads = tuple(
            replace(load, at=own.get((body.name, load.at), load.at)) if isinstance(load, sf.Load) else load
            for load in body.loads
        )
        changed.append(replace(cast(Any, body), name=new[body.name], joint=joint, frames=frames, loads=loads))
    connections = tuple(placed(item, k) for k, item in enumerate(stated.connections))
    constraints = tuple(
        placed(item, 100 + k) if hasattr(item, "first") or hasattr(item, "anchor") else item
        for k, item in enumerate(stated.constraints)
    )
    known = {item.name: other.name for item, other in zip(stated.constraints, constraints, strict=True)}
    switches = tuple(replace(one, constraint=known[one.constraint]) for one in stated.switches)
    system = replace(
        stated, bodies=tuple(changed), connections=connections, constraints=constraints, switches=switches, visuals={}
    )
    return Restated(system, _frames_renamed(stated, system), True)


def _frames_renamed(stated: sf.System, other: sf.System) -> dict[str, str]:
    """Public names of the frames of two systems that state the same ones in the same order."""
    before, after = assemble(stated).frames, assemble(other).frames
    return dict(zip(before, after, strict=True))


def in_other_units(stated: sf.System, rng: np.random.Generator) -> Answer:
    """A system with its numbers in units of other length, mass and time; parameters' values as numbers."""
    del rng
    refused: list[Any] = [*stated.potentials, *stated.virtual_power]
    refused += [item for item in stated.constraints if isinstance(item, sf.Coupling | sf.Nonholonomic)]
    if refused:
        return Unsupported(f"'{refused[0].name}': {BY_FORMULA}")
    if stated.beams:
        return Unsupported("elastic coordinates have the units of their shape functions")
    if any(body.joint is not None and body.joint.kind == "general" for body in stated.bodies):
        return Unsupported(f"a general joint: {BY_FORMULA}")
    units = Units(LENGTH, MASS, TIME)
    try:
        system = Rescaled(stated, units).system()
    except ValueError as error:
        return Unsupported(str(error))
    return Restated(system, units=units)


RESTATEMENTS: Mapping[str, Restatement] = {
    "the world turned and shifted": turned,
    "bodies in another order": permuted,
    "bodies divided into welded parts": divided,
    "links without mass before the joints": seated,
    "other names": renamed,
    "other units": in_other_units,
}


def _matrix(moments: Array) -> Array:
    xx, yy, zz, xy, xz, yz = moments
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _moments(J: Array) -> Array:
    return np.array([J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]])


def _vector(x: Any) -> tuple[float, float, float]:
    a, b, c = map(float, x)
    return a, b, c


def _rotation(R: Array) -> sf.Rotation:
    return sf.Rotation.matrix(R.tolist())


def _free_name(stated: sf.System, wished: str) -> str:
    """A name that no body, frame or joint has."""
    taken = {body.name for body in stated.bodies} | {frame.name for body in stated.bodies for frame in body.frames}
    while wished in taken:
        wished += "_"
    return wished
