"""A description as numbered rigid bodies, for formats that hold no formulas; and what that leaves out."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.base.rotations import matrix_product, skew
from symofros.description import PRE_STRAINS, STATION, WORLD, Beam, Body, Damper, Inertia, Joint, RigidBody, System
from symofros.errors import ExportError
from symofros.exports.limits import listed
from symofros.mechanics.topology import Numbers, coordinate_names, full_names, public_names

# Enough for the sixth power of x in each of so many pieces: sections are polynomials of low degree, or smooth.
_PIECES, _NODES = 16, 8


@dataclass(frozen=True)
class Axis:
    """One single joint of a chain that makes up a joint.

    Attributes:
        name: Name of the coordinate.
        turns: Whether it turns rather than slides.
        direction: Unit vector in the frame at zero.
    """

    name: str
    turns: bool
    direction: tuple[float, float, float]


@dataclass(frozen=True)
class RigidLink:
    """A body in numbers.

    Attributes:
        name: Name of the body.
        parent: Name of the parent; None for the base.
        joint: Joint that carries the body; None for the base.
        axes: The single joints that `joint` is made of; empty for fixed, ball and free ones.
        position: Position of the body's frame in the parent's at zero coordinates (3) [m].
        rotation: R (3, 3).
        mass: Mass [kg].
        center: Mass centre in the body's frame (3) [m].
        inertia: About the centre, along the body's axes (3, 3) [kg m^2].
        frames: Name, position, rotation of each extremity frame.
        damping: Viscous, of each speed; linear dampers alone.
    """

    name: str
    parent: str | None
    joint: Joint | None
    axes: tuple[Axis, ...]
    position: Array
    rotation: Array
    mass: float
    center: Array
    inertia: Array
    frames: tuple[tuple[str, Array, Array], ...]
    damping: tuple[float, ...] = ()


def rigid_links(system: System, form: Literal["URDF", "MJCF"] | None) -> tuple[list[RigidLink], list[str]]:
    """The bodies, parents first, and what was left out of them.

    Args:
        system: Checked.
        form: The format; None for none, which holds every joint but general and prescribed ones.

    Raises:
        ExportError: Joints that the format can't hold; all are named.
    """
    numbers = Numbers(system)
    beyond = [body.joint for body in system.bodies if body.joint is not None and not _representable(body.joint, form)]
    if beyond:
        listed = ", ".join(f"'{joint.name}' ({'prescribed' if joint.prescribed else joint.kind})" for joint in beyond)
        raise ExportError(
            f"system '{system.name}': joints that {form} can't hold",
            listed,
            "a file without formulas holds turns and slides, and joints made of them",
            "export the model as an FMU, or replace these joints",
        )
    curved = [body.name for body in system.beams if any(getattr(body, label) != 0.0 for label in PRE_STRAINS)]
    if curved:
        raise ExportError(
            f"system '{system.name}': rods that {form} can't hold",
            ", ".join(curved),
            "a beam becomes a straight rigid body; a rod with curvature or twist without stress is not straight",
            "export the model as an FMU, or replace these rods by rigid bodies",
        )
    bodies = system.bodies
    if all(body.joint is not None for body in bodies):
        bodies = (RigidBody(WORLD), *bodies)
    stated = [one for body in bodies for one in full_names(body)]
    names = {full: public for (_, full), public in zip(stated, public_names(stated), strict=True)}
    base = {body.name for body in system.bodies if body.joint is None} | {WORLD}
    root = next(body.name for body in bodies if body.joint is None)
    rigid = []
    for body in bodies:
        parent = None if body.joint is None else root if body.joint.parent in base else body.joint.parent
        rigid.append(_link(body, parent, system, numbers, names))
    return _parents_first(rigid), list(_lost(system))


def _parents_first(links: list[RigidLink]) -> list[RigidLink]:
    """Links in an order in which none comes before its parent: their own, where that is one."""
    ordered: list[RigidLink] = []
    waiting: dict[str | None, list[RigidLink]] = {}
    known: set[str | None] = {None}
    for link in links:
        if link.parent not in known:
            waiting.setdefault(link.parent, []).append(link)
            continue
        ready = [link]
        while ready:
            ordered.append(ready.pop(0))
            known.add(ordered[-1].name)
            ready = waiting.pop(ordered[-1].name, []) + ready
    return ordered


def _representable(joint: Joint, form: Literal["URDF", "MJCF"] | None) -> bool:
    """Whether a format holds a joint, as one of its own or as a series of turns and slides."""
    if form is None:
        return not joint.prescribed and not joint.traits.user_defined
    own = {"URDF": joint.traits.urdf, "MJCF": joint.traits.mjcf}[form]
    return not joint.prescribed and (joint.traits.series or own is not None)


def _link(body: Body, parent: str | None, system: System, numbers: Numbers, names: Mapping[str, str]) -> RigidLink:
    mass, center, inertia = _beam_inertia(body, numbers) if isinstance(body, Beam) else _inertia(body.inertia, numbers)
    position, rotation = np.zeros(3), np.eye(3)
    if body.joint is not None:
        position, rotation = _placed(body.joint, system, numbers)
    frames = []
    for frame in body.frames:
        at, turned = numbers.values(frame.position), numbers.rotation(frame.rotation)
        if isinstance(body, Beam):
            at, turned = np.array([frame.station * numbers.value(body.length), 0.0, 0.0]), np.eye(3)
        frames.append((names[f"{body.name}.{frame.name}"], at, turned))
    axes = () if body.joint is None else _axes(body.joint, numbers)
    damping = () if body.joint is None else _damping(body.joint, numbers)
    return RigidLink(
        body.name, parent, body.joint, axes, position, rotation, mass, center, inertia, tuple(frames), damping
    )


def _placed(joint: Joint, system: System, numbers: Numbers) -> tuple[Array, Array]:
    """Position and rotation of a joint's frame in the parent's body frame."""
    position, rotation = np.zeros(3), np.eye(3)
    parent = next((body for body in system.bodies if body.name == joint.parent), None)
    if parent is None and joint.frame is not None:  # A frame of a base that goes by another name than "world".
        parent = next(body for body in system.bodies if body.joint is None)
    if parent is not None and joint.frame is not None:
        frame = next(frame for frame in parent.frames if frame.name == joint.frame)
        position, rotation = numbers.values(frame.position), numbers.rotation(frame.rotation)
        if isinstance(parent, Beam):
            position = np.array([frame.station * numbers.value(parent.length), 0.0, 0.0])
    offset = matrix_product(rotation, numbers.values(joint.position))
    return position + offset, matrix_product(rotation, numbers.rotation(joint.rotation))


def _axes(joint: Joint, numbers: Numbers) -> tuple[Axis, ...]:
    def axis(name: str, turns: bool, direction: Array) -> Axis:
        x, y, z = (direction / math.hypot(*direction)).tolist()
        return Axis(name, turns, (x, y, z))

    if not joint.traits.series:
        return ()
    directions = dict(zip("xyz", np.eye(3), strict=True))
    directions |= {"axis": numbers.values(joint.axis), "axis2": numbers.values(joint.axis2)}
    return tuple(
        axis(name, coordinate.measure == "angle", directions[coordinate.axis])
        for name, coordinate in zip(coordinate_names(joint), joint.traits.coordinates, strict=True)
        if coordinate.axis is not None
    )


def _damping(joint: Joint, numbers: Numbers) -> tuple[float, ...]:
    total = [0.0] * joint.traits.nv
    for element in joint.elements:
        if isinstance(element, Damper):
            total[element.coordinate] += numbers.value(element.coefficient)
    return tuple(total)


def _inertia(inertia: Inertia | None, numbers: Numbers) -> tuple[float, Array, Array]:
    if inertia is None:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    mass, center = numbers.value(inertia.mass), numbers.values(inertia.center_of_mass)
    xx, yy, zz, xy, xz, yz = numbers.values(inertia.moments)
    I = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])  # noqa: E741
    if inertia.about == "body":
        return mass, center, I + mass * matrix_product(skew(center), skew(center))
    R = numbers.rotation(inertia.rotation)
    return mass, center, matrix_product(matrix_product(R, I), R.T)


def _beam_inertia(beam: Beam, numbers: Numbers) -> tuple[float, Array, Array]:
    """Mass, mass centre and inertia about it (3, 3) of the undeformed beam."""
    length = numbers.value(beam.length)
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    edges = np.linspace(0.0, length, _PIECES + 1)
    x = np.concatenate([(a + b) / 2 + (b - a) / 2 * nodes for a, b in zip(edges, edges[1:], strict=False)])
    w = np.tile(length / _PIECES / 2 * weights, _PIECES)
    at = [numbers.extended({STATION: float(station)}) for station in x]
    about = ("rhoI_y", "rhoI_z", "rhoI_yz") if beam.rotary_inertia else ()
    rhoA, *moments = (
        w * np.array([values.value(getattr(beam, label)) for values in at]) for label in ("rhoA", "rhoJ", *about)
    )
    places = np.column_stack([x, np.array([values.values(beam.mass_center) for values in at])])
    mass = math.fsum(rhoA)
    center = np.array([math.fsum(rhoA * column) / mass if mass else 0.0 for column in places.T])
    second = np.array([[math.fsum(rhoA * a * b) for b in (places - center).T] for a in (places - center).T])
    inertia = np.trace(second) * np.eye(3) - second
    for (i, j, sign), moment in zip(((0, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0), (1, 2, -1.0)), moments, strict=False):
        inertia[i, j] += sign * math.fsum(moment)
    inertia[2, 1] = inertia[1, 2]
    return mass, center, inertia


def _lost(system: System) -> Iterator[str]:
    """Notes on features that formats without formulas can't represent: dropped, made rigid, or fixed to numbers."""
    beams = [body.name for body in system.beams if body.modes]
    if beams:
        yield f"beams as rigid bodies, without their elastic coordinates: {listed(beams)}"
    if system.parameters:
        yield f"parameters as the numbers they have: {listed([p.name for p in system.parameters])}"
    joints = [body.joint for body in system.bodies if body.joint is not None]
    for what, names in (
        ("efforts by formula", [j.name for j in joints if j.effort and any(e != 0.0 for e in j.effort)]),
        ("rotors", [j.name for j in joints if j.rotors]),
        ("loads", [b.name for b in system.bodies if b.loads]),
        ("connections", [c.name for c in system.springs]),
        ("contacts", [c.name for c in system.contacts]),
        ("virtual power", [p.name for p in system.virtual_power]),
        ("potentials", [p.name for p in system.potentials]),
        ("states of forces", [s.name for s in system.states]),
        ("inputs of formulas", [i.name for i in system.inputs]),
    ):
        if names:
            yield f"{what} dropped: {listed(names)}"


def numbers_text(values: npt.ArrayLike) -> str:
    """Numbers of an attribute, to the last digit."""
    return " ".join(repr(float(value) + 0.0) for value in np.asarray(values, dtype=np.float64).ravel())
