"""URDF: the rigid tree of a description."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree as Tree

import numpy as np

from symofros.base.arrays import Array
from symofros.base.names import identifier
from symofros.description import Damper, Joint, JointElement, Limits, System, fresh_name
from symofros.exports.folder import Exported, write_folder
from symofros.exports.interchange.couplings import PolynomialCoupling, polynomial_couplings
from symofros.exports.interchange.rigid import Axis, RigidLink, numbers_text, rigid_links
from symofros.exports.limits import MEASURES, events_note, limits_note, listed, measures
from symofros.mechanics.topology import Numbers

# URDF wants both bounds of a slide, effort and speed wherever one of them is stated; these bind nothing.
_FAR = 1e9


def write_urdf(system: System, name: str | None, folder: Path, generator: str) -> Exported:
    """NAME.urdf; notes list what it lacks.

    Raises:
        ExportError: A joint can't be stated, or the folder is not ours.
    """
    links, lost = rigid_links(system, "URDF")
    root = Tree.Element("robot", {"name": system.name})
    names = _Names(links)
    for link in links:
        _link(root, link, names)
    mimics = _mimics(system, links)
    for link in links:
        if link.parent is not None:
            _joints(root, link, mimics, names)
    Tree.indent(root)
    text = f'<?xml version="1.0"?>\n{Tree.tostring(root, encoding="unicode")}\n'
    called = identifier(name or system.name)
    notes = (*lost, *_lost(system, {mimic.name for mimic in mimics.values()}), *events_note(system))
    return write_folder(folder, "urdf", called, {f"{called}.urdf": text}, generator, notes)


class _Names:
    """Names of links and joints of the file; those that it adds are other ones.

    Attributes:
        links: Those of bodies and frames, and of links added.
        joints: Those of the joints, and of joints added.
    """

    def __init__(self, links: list[RigidLink]) -> None:
        self.links = {link.name for link in links} | {frame[0] for link in links for frame in link.frames}
        self.joints = {axis.name for link in links for axis in link.axes}
        self.joints |= {link.joint.name for link in links if link.joint is not None and not link.axes}


def _mimics(system: System, links: list[RigidLink]) -> dict[str, PolynomialCoupling]:
    """Couplings that are straight lines, by the joint that follows; one that leads or follows does not follow again."""
    mimics: dict[str, PolynomialCoupling] = {}
    for line in polynomial_couplings(system, links, Numbers(system)):
        if line.leader is None or len(line.coefficients) > 2:
            continue
        leaders = {mimic.leader for mimic in mimics.values()}
        if line.leader not in mimics and line.follower not in mimics and line.follower not in leaders:
            mimics[line.follower] = line
    return mimics


def _lost(system: System, kept: set[str]) -> list[str]:
    losses = []
    joints = [body.joint for body in system.bodies if body.joint is not None]
    dropped = [item.name for item in system.constraints if item.name not in kept]
    if dropped:
        losses.append("constraints dropped, loops are open: " + ", ".join(dropped))
    if kept:
        losses.append("couplings as <mimic>, which many readers ignore unless asked: " + ", ".join(sorted(kept)))
    if system.gravity != (0.0, 0.0, -9.81):
        losses.append(f"gravity is not part of URDF: ({', '.join(map(str, system.gravity))})")
    elements = [joint.name for joint in joints if any(not isinstance(e, Damper) for e in joint.elements)]
    if elements:
        losses.append("springs, stops and friction of joints dropped: " + ", ".join(elements))
    dampers = [joint.name for joint in joints if any(not _kept(joint, e) for e in joint.elements)]
    if dampers:
        losses.append("dampers that are not linear or of no turn or slide dropped: " + ", ".join(dampers))
    losses += limits_note(joints, lambda joint: MEASURES if joint.traits.series and joint.traits.nv == 1 else ())
    passive = [joint.name for joint in joints if joint.traits.series and joint.traits.nv and not joint.actuated]
    if passive and any(joint.actuated for joint in joints):
        losses.append("which joints are driven is not part of URDF; these are not: " + listed(passive))
    armed = [joint.name for joint in joints if joint.armature != 0.0]
    if armed:
        losses.append("armature dropped: " + ", ".join(armed))
    return losses


def _kept(joint: Joint, element: JointElement) -> bool:
    """Whether a damper is written; of others there is another note."""
    return not isinstance(element, Damper) or (element.quadratic == 0.0 and joint.traits.series)


def _origin(into: Tree.Element, position: Array, rotation: Array) -> None:
    Tree.SubElement(into, "origin", {"xyz": numbers_text(position), "rpy": numbers_text(_rpy(rotation))})


def _rpy(R: Array) -> tuple[float, float, float]:
    """Roll, pitch, yaw of Rz(y) Ry(p) Rx(r).

    Where the pitch is nearly a right angle, the yaw comes from entries that are noise: roll and pitch are read off what
    the yaw leaves of R, so that the product is R to rounding.
    """
    yaw = math.atan2(R[1, 0], R[0, 0]) if math.hypot(R[0, 0], R[1, 0]) > _ALIGNED else 0.0
    cosine, sine = math.cos(yaw), math.sin(yaw)
    left, up = cosine * R[1] - sine * R[0], cosine * R[0, 0] + sine * R[1, 0]
    return math.atan2(-left[2], left[1]), math.atan2(-R[2, 0], up), yaw


# Below this, the axes of roll and yaw are one but for rounding: all of the turn is written as roll.
_ALIGNED = 1e-15


def _link(root: Tree.Element, link: RigidLink, names: _Names) -> None:
    into = Tree.SubElement(root, "link", {"name": link.name})
    if link.mass != 0.0 or link.inertia.any():
        inertial = Tree.SubElement(into, "inertial")
        _origin(inertial, link.center, np.eye(3))
        Tree.SubElement(inertial, "mass", {"value": numbers_text(link.mass)})
        moments = {
            f"i{a}{b}": numbers_text(link.inertia[i, j])
            for i, a in enumerate("xyz")
            for j, b in enumerate("xyz")
            if i <= j
        }
        Tree.SubElement(inertial, "inertia", moments)
    for name, position, rotation in link.frames:
        Tree.SubElement(root, "link", {"name": name})
        _joint(root, fresh_name(f"{name}_fixed", names.joints), "fixed", link.name, name, position, rotation)


def _joint(
    root: Tree.Element, name: str, kind: str, parent: str, child: str, position: Array, rotation: Array
) -> Tree.Element:
    into = Tree.SubElement(root, "joint", {"name": name, "type": kind})
    Tree.SubElement(into, "parent", {"link": parent})
    Tree.SubElement(into, "child", {"link": child})
    _origin(into, position, rotation)
    return into


def _joints(root: Tree.Element, link: RigidLink, mimics: Mapping[str, PolynomialCoupling], names: _Names) -> None:
    assert link.joint is not None and link.parent is not None
    if not link.axes:
        kind = link.joint.traits.urdf
        assert kind is not None
        _joint(root, link.joint.name, kind, link.parent, link.name, link.position, link.rotation)
        return
    parent, position, rotation = link.parent, link.position, link.rotation
    for i, axis in enumerate(link.axes):
        last = i == len(link.axes) - 1
        child = link.name if last else fresh_name(f"{link.name}[{i}]", names.links)
        if not last:
            Tree.SubElement(root, "link", {"name": child})
        _single(root, link, axis, i, parent, child, position, rotation, mimics.get(axis.name))
        parent, position, rotation = child, np.zeros(3), np.eye(3)


def _limit(limits: Limits, bounded: bool) -> dict[str, str]:
    """Attributes of <limit>, which lacks none that readers ask for; those of travel only where the joint is bounded."""
    stated = {"lower": limits.lower, "upper": limits.upper} if bounded else {}
    stated |= {"effort": limits.effort, "velocity": limits.velocity}
    bounds = {name: (-_FAR if name == "lower" else _FAR) if x is None else x for name, x in stated.items()}
    return {name: numbers_text(bound) for name, bound in bounds.items()}


def _single(
    root: Tree.Element,
    link: RigidLink,
    axis: Axis,
    index: int,
    parent: str,
    child: str,
    position: Array,
    rotation: Array,
    mimic: PolynomialCoupling | None,
) -> None:
    assert link.joint is not None
    limits = link.joint.limits if len(link.axes) == 1 else None
    stated = measures(limits)
    kind = "prismatic" if not axis.turns else "revolute" if "travel" in stated else "continuous"
    into = _joint(root, axis.name, kind, parent, child, position, rotation)
    Tree.SubElement(into, "axis", {"xyz": numbers_text(axis.direction)})
    if kind != "continuous" or stated:
        Tree.SubElement(into, "limit", _limit(limits or Limits(), kind != "continuous"))
    if link.damping[index] != 0.0:
        Tree.SubElement(into, "dynamics", {"damping": numbers_text(link.damping[index])})
    if mimic is not None:
        assert mimic.leader is not None
        offset, multiplier = mimic.coefficients
        law = {"multiplier": numbers_text(multiplier), "offset": numbers_text(offset)}
        Tree.SubElement(into, "mimic", {"joint": mimic.leader, **law})
