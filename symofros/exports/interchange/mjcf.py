"""MJCF: the rigid tree, its loops as soft equalities, springs, dampers, armature, motors."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree as Tree

import numpy as np

from symofros.base.arrays import Array
from symofros.base.names import identifier
from symofros.base.rotations import matrix_product, matrix_quaternion
from symofros.description import Anchor, Closure, Damper, Joint, Limits, Spring, System, fresh_name
from symofros.exports.folder import Exported, write_folder
from symofros.exports.interchange.couplings import DEGREE, PolynomialCoupling, polynomial_couplings
from symofros.exports.interchange.joint_series import GatheredBody, JointPlace, gathered
from symofros.exports.interchange.rigid import RigidLink, numbers_text, rigid_links
from symofros.exports.limits import events_note, limits_note, listed, measures
from symofros.mechanics.topology import Numbers

# Of a moment of inertia, of the largest one or of 1 kg m^2; MuJoCo's own bound is 1e-14.
_LEAST = 1e-12
# What limits of a single turn or slide bound in MuJoCo, too.
_ACTING = ("travel", "effort")


def write_mjcf(system: System, name: str | None, folder: Path, generator: str) -> Exported:
    """NAME.xml; notes list what it lacks.

    Raises:
        ExportError: A joint can't be stated, or the folder is not ours.
    """
    links, lost = rigid_links(system, "MJCF")
    numbers = Numbers(system)
    root = Tree.Element("mujoco", {"model": system.name})
    Tree.SubElement(root, "compiler", {"angle": "radian", "inertiafromgeom": "false", "autolimits": "false"})
    Tree.SubElement(root, "option", {"gravity": numbers_text(numbers.values(system.gravity))})
    elements = {links[0].name: Tree.SubElement(root, "worldbody")}
    _sites(elements[links[0].name], links[0])
    notes = [*lost, *_lost(links, numbers), *events_note(system)]
    thin = [link.name for link in links if link.mass and _positive(link.inertia) is not link.inertia]
    odd = [link.name for link in links if link.mass and _impossible(_positive(link.inertia))]
    if odd:
        notes.append(
            "MuJoCo refuses inertias that no body can have (its option balanceinertia changes them): " + ", ".join(odd)
        )
    if thin:
        notes.append(f"moments of inertia near zero raised to {_LEAST:g}: " + ", ".join(thin))
    bodies = gathered(links[1:], _attached(system))
    for body in bodies:
        assert body.link.parent is not None
        elements[body.link.name] = _body(elements[body.link.parent], body, numbers)
    notes += _carrier_notes(bodies)
    notes += _free_notes([body.link for body in bodies if _is_free(body.link)], numbers)
    inner = [body.link.name for body in bodies if _is_free(body.link) and body.link.parent != links[0].name]
    if inner:
        notes.append("MuJoCo refuses free joints on bodies other than the world: " + ", ".join(inner))
    _equalities(root, system, links, numbers, notes)
    motors = [axis.name for link in links if link.joint is not None and link.joint.actuated for axis in link.axes]
    if motors:
        into = Tree.SubElement(root, "actuator")
        for motor in motors:
            Tree.SubElement(into, "motor", {"name": motor, "joint": motor, "gear": "1"})
    Tree.indent(root)
    called = identifier(name or system.name)
    text = Tree.tostring(root, encoding="unicode") + "\n"
    return write_folder(folder, "mjcf", called, {f"{called}.xml": text}, generator, tuple(notes))


def _attached(system: System) -> set[str]:
    """Bodies that constraints hold."""
    return {
        anchor[0] for item in system.constraints if isinstance(item, Closure) for anchor in (item.first, item.second)
    }


def _carrier_notes(bodies: list[GatheredBody]) -> list[str]:
    """Notes on bodies without mass: frames of those that are gathered, and those that MuJoCo refuses."""
    frames = [name for body in bodies for place in body.carriers for name, _, _ in place.link.frames]
    notes = ["frames of bodies that only carry dropped: " + ", ".join(frames)] if frames else []
    fixed = {body.link.name: body.link.parent for body in bodies if not _moves(body)}
    heavy = {body.link.name for body in bodies if body.link.mass}
    for name in [*heavy]:  # What is fixed to a body moves with it.
        while name in fixed and fixed[name] is not None:
            name = str(fixed[name])
            heavy.add(name)
    light = [body.link.name for body in bodies if _moves(body) and body.link.name not in heavy]
    if light:
        notes.append(
            "MuJoCo refuses bodies that move and have no mass (its option boundmass gives them some): "
            + ", ".join(light)
        )
    return notes


def _is_free(link: RigidLink) -> bool:
    return link.joint is not None and link.joint.kind == "free"


def _free_notes(links: Sequence[RigidLink], numbers: Numbers) -> list[str]:
    """Notes on what free joints mean otherwise in MuJoCo: their origin, and the forces of their armature."""
    stated = [(link, link.joint) for link in links if link.joint is not None]
    off = [joint.name for link, joint in stated if link.position.any() or (link.rotation != np.eye(3)).any()]
    heavy = [joint.name for _, joint in stated if numbers.value(joint.armature) != 0.0]
    notes = ["coordinates of free joints, here from the joint's frame, count from the world in MuJoCo: " + listed(off)]
    notes += ["armature of free joints, here along the body's axes, acts along the world's in MuJoCo: " + listed(heavy)]
    return [note for note, names in zip(notes, (off, heavy), strict=True) if names]


def _moves(body: GatheredBody) -> bool:
    link = body.link
    return bool(link.axes or body.carriers or (link.joint is not None and link.joint.traits.mjcf is not None))


def _lost(links: Sequence[RigidLink], numbers: Numbers) -> list[str]:
    """Notes on features that MJCF can't represent, and on limits that are only data here but act in MuJoCo."""
    losses = []
    moving = [(link, link.joint) for link in links if link.joint is not None]
    elements = [j.name for _, j in moving if any(not _kept(element) for element in j.elements)]
    if elements:
        losses.append("friction, stops, and springs and dampers that are not linear, dropped: " + ", ".join(elements))
    constant = [axis.name for link, j in moving for i, axis in enumerate(link.axes) if _pushes(j, i, numbers)]
    if constant:
        losses.append("springs whose stiffness cancels to a constant effort dropped: " + listed(constant))
    uneven = [j.name for link, j in moving if not link.axes and len(set(link.damping)) > 1]
    if uneven:
        losses.append("dampers that differ between the speeds of a ball or free joint dropped: " + ", ".join(uneven))
    driven = [j.name for link, j in moving if not link.axes and j.actuated]
    if driven:
        losses.append("actuators of ball and free joints dropped: " + ", ".join(driven))
    losses += limits_note([j for _, j in moving], lambda joint: _ACTING if _is_single(joint) else ())
    single = [j for _, j in moving if _is_single(j)]
    acting = [j.name for j in single if {*_ACTING} & {*measures(j.limits)}]
    if acting:
        losses.append(
            "limits of travel and effort, data here, act in MuJoCo, as soft stops and bounds of motors: "
            + listed(acting)
        )
    locked = [j.name for j in single if j.limits is not None and _is_locked(j.limits)]
    if locked:
        losses.append("limits of travel that leave one place, which MuJoCo refuses, dropped: " + listed(locked))
    return losses


def _is_single(joint: Joint) -> bool:
    return joint.traits.series and joint.traits.nv == 1


def _is_locked(limits: Limits) -> bool:
    return limits.lower is not None and limits.lower == limits.upper


def _kept(element: object) -> bool:
    linear = isinstance(element, Spring) and element.cubic == 0.0
    return linear or (isinstance(element, Damper) and element.quadratic == 0.0)


def _pose(position: Array, rotation: Array) -> dict[str, str]:
    return {"pos": numbers_text(position), "quat": numbers_text(np.roll(matrix_quaternion(rotation), 1))}


def _sites(into: Tree.Element, link: RigidLink) -> None:
    for name, position, rotation in link.frames:
        Tree.SubElement(into, "site", {"name": name, **_pose(position, rotation)})


def _body(into: Tree.Element, gathered_body: GatheredBody, numbers: Numbers) -> Tree.Element:
    link = gathered_body.link
    assert link.joint is not None
    body = Tree.SubElement(into, "body", {"name": link.name, **_pose(link.position, link.rotation)})
    if link.mass != 0.0 or link.inertia.any():
        inertia = _positive(link.inertia)
        moments = [*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2]]
        Tree.SubElement(
            body,
            "inertial",
            {"pos": numbers_text(link.center), "mass": numbers_text(link.mass), "fullinertia": numbers_text(moments)},
        )
    for place in gathered_body.carriers:
        _joints(body, place.link, numbers, place)
    if not link.axes and link.joint.traits.mjcf is not None:
        stated = {"name": link.joint.name, "type": link.joint.traits.mjcf}
        Tree.SubElement(body, "joint", stated | _ball_or_free_attributes(link, numbers))
    _joints(body, link, numbers, None)
    _sites(body, link)
    return body


def _joints(body: Tree.Element, link: RigidLink, numbers: Numbers, place: JointPlace | None) -> None:
    """The single joints of a link, about its own origin or about that of a body before it."""
    assert link.joint is not None
    for i, axis in enumerate(link.axes):
        direction = axis.direction if place is None else matrix_product(place.rotation, np.array(axis.direction))
        stated = {"name": axis.name, "type": "hinge" if axis.turns else "slide", "axis": numbers_text(direction)}
        if place is not None and axis.turns and place.position.any():
            stated["pos"] = numbers_text(place.position)
        Tree.SubElement(body, "joint", stated | _dynamics(link, link.joint, i, numbers))


def _positive(inertia: Array) -> Array:
    """Inertia that MuJoCo accepts: zero principal moments, of a line or a point, are raised to negligible ones."""
    sizes, axes = np.linalg.eigh(inertia)
    least = _LEAST * max(1.0, float(sizes[-1]))
    if sizes[0] >= least:
        return inertia
    return np.asarray(axes @ np.diag(np.maximum(sizes, least)) @ axes.T)


def _impossible(inertia: Array) -> bool:
    """Whether two principal moments are less than the third."""
    small, middle, large = np.linalg.eigvalsh(inertia)
    return bool(small + middle < large * (1.0 - 1e-9))


def _ball_or_free_attributes(link: RigidLink, numbers: Numbers) -> dict[str, str]:
    """Armature and damping of a ball or free joint, for which MJCF has one number each."""
    assert link.joint is not None
    stated = {"armature": numbers.value(link.joint.armature)}
    if len(set(link.damping)) == 1:
        stated["damping"] = link.damping[0]
    return {name: numbers_text(value) for name, value in stated.items() if value != 0.0}


def _dynamics(link: RigidLink, joint: Joint, index: int, numbers: Numbers) -> dict[str, str]:
    attributes = _limits(joint.limits) if len(link.axes) == 1 and joint.limits is not None else {}
    armature = numbers.value(joint.armature)
    if armature != 0.0:
        attributes["armature"] = numbers_text(armature)
    if link.damping[index] != 0.0:
        attributes["damping"] = numbers_text(link.damping[index])
    stiffness, pull = _springs(joint, index, numbers)
    if stiffness:
        attributes |= {"stiffness": numbers_text(stiffness), "springref": numbers_text(pull / stiffness)}
    return attributes


def _springs(joint: Joint, index: int, numbers: Numbers) -> tuple[float, float]:
    """Total stiffness of the linear springs on a coordinate, and their effort at zero."""
    springs = [e for e in joint.elements if isinstance(e, Spring) and e.cubic == 0.0 and e.coordinate == index]
    terms = [(numbers.value(spring.stiffness), numbers.value(spring.rest)) for spring in springs]
    return math.fsum(k for k, _ in terms), math.fsum(k * rest for k, rest in terms)


def _pushes(joint: Joint, index: int, numbers: Numbers) -> bool:
    """Whether the sum of springs pushes with the same force everywhere."""
    stiffness, pull = _springs(joint, index, numbers)
    return stiffness == 0.0 and pull != 0.0


def _limits(limits: Limits) -> dict[str, str]:
    """Attributes of limits: of travel, where a bound that is not stated is infinite, and of effort."""
    attributes: dict[str, str] = {}
    stated = measures(limits)
    if "travel" in stated and not _is_locked(limits):
        lower = -math.inf if limits.lower is None else limits.lower
        upper = math.inf if limits.upper is None else limits.upper
        attributes |= {"range": numbers_text([lower, upper]), "limited": "true"}
    if "effort" in stated and limits.effort is not None:
        bounds = numbers_text([-limits.effort, limits.effort])
        attributes |= {"actuatorfrcrange": bounds, "actuatorfrclimited": "true"}
    return attributes


def _equalities(root: Tree.Element, system: System, links: list[RigidLink], numbers: Numbers, notes: list[str]) -> None:
    if system.switches:
        notes.append("constraints hold always: " + ", ".join(switch.constraint for switch in system.switches))
    couplings = polynomial_couplings(system, links, numbers)
    names = {coupling.name for coupling in couplings}
    stated = [item for item in system.constraints if _stated(item) or item.name in names]
    dropped = [item.name for item in system.constraints if item not in stated]
    if dropped:
        notes.append("constraints dropped: " + ", ".join(dropped))
    if not stated:
        return
    into = Tree.SubElement(root, "equality")
    for closure in (item for item in stated if isinstance(item, Closure)):
        (body1, site1), (body2, site2) = (_site(anchor, links, root) for anchor in (closure.first, closure.second))
        kind = "weld" if closure.rotations else "connect"
        Tree.SubElement(into, kind, {"name": closure.name, "site1": site1, "site2": site2})
        if len(closure.translations) < 3:
            free = ", ".join(axis for axis in "xyz" if axis not in closure.translations)
            notes.append(f"closure '{closure.name}' also holds {free}, which it leaves free")
    for coupling in couplings:
        _joint_equality(into, coupling)
    notes.append("constraints are soft in MuJoCo: " + ", ".join(item.name for item in stated))


def _joint_equality(into: Tree.Element, coupling: PolynomialCoupling) -> None:
    """Joints of this file have their reference at zero, so that polycoef is the polynomial itself."""
    joints = {"joint1": coupling.follower} | ({} if coupling.leader is None else {"joint2": coupling.leader})
    coefficients = [*coupling.coefficients, *[0.0] * DEGREE][: DEGREE + 1]
    Tree.SubElement(into, "joint", {"name": coupling.name, **joints, "polycoef": numbers_text(coefficients)})


def _stated(item: object) -> bool:
    """Whether it is a closure that MuJoCo has an equality near enough for: a point, or everything."""
    return isinstance(item, Closure) and len(item.rotations) in (0, 3) and len(item.translations) >= 2


def _site(anchor: Anchor, links: list[RigidLink], root: Tree.Element) -> tuple[str, str]:
    """The site of a frame; a body frame gets one of its own."""
    body, frame = anchor
    link = next((link for link in links if link.name == body), links[0])
    if frame is not None:
        names = [name for name, _, _ in link.frames]
        return link.name, frame if frame in names else f"{link.name}.{frame}"
    owner = next((e for e in root.iter("body") if e.get("name") == link.name), root.find("worldbody"))
    assert owner is not None
    name = next((site.attrib["name"] for site in owner.findall("site") if "pos" not in site.attrib), "")
    if not name:
        name = fresh_name(f"{link.name}.origin", {site.attrib["name"] for site in root.iter("site")})
        Tree.SubElement(owner, "site", {"name": name})
    return link.name, name
