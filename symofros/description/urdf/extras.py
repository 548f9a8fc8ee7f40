"""What a URDF states beside links and joints, for other programs: remarks that name what of it is mechanics.

Nothing here is read. A joint inside of <gazebo> closes a loop, a transmission has a reduction and may have the inertia
of a rotor, a plug-in may couple joints: who reads a note is to learn what the model lacks.
"""

from __future__ import annotations

from collections.abc import Iterator

from symofros.description.remarks import Remarks, remark_unread
from symofros.description.xml_nodes import Element

_USED = frozenset({"link", "joint", "material"})
# Elements of links and joints that are read, or that a remark of their own tells of.
_READ_IN = {
    "link": frozenset({"inertial", "visual", "collision"}),
    "joint": frozenset({"origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "calibration"}),
}
# Attributes of links, joints and what is read inside them; <dynamics> has a remark of its own.
_ATTRIBUTES: dict[str, tuple[str, ...]] = {
    "link": ("name", "type"),
    "joint": ("name", "type"),
    "origin": ("xyz", "rpy", "quat_xyzw"),
    "mass": ("value",),
    "inertia": ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"),
    "parent": ("link",),
    "child": ("link",),
    "axis": ("xyz",),
    "limit": ("lower", "upper", "velocity", "effort"),
    "mimic": ("joint", "multiplier", "offset"),
}
_SEVERAL = frozenset({"visual", "collision"})
# Entries of <gazebo> that change how a link or joint moves; others are looks, contacts and sensors.
_MECHANICS = frozenset(
    {"turnGravityOff", "gravity", "springStiffness", "springReference", "implicitSpringDamper", "stopCfm", "stopErp"}
    | {"dampingFactor", "static", "mimic", "mimicJoint", "gearbox_ratio", "initial_joint_position", "plugin"}
)
OPEN_LOOP = "the loop that it closes stays open (sf.Closure closes one)"


def remark_extras(robot: Element, remarks: Remarks) -> None:
    """Remark on the elements that mean nothing here, in the robot, its links and its joints."""
    for element in robot.children:
        if element.tag in _READ_IN:
            _remark_inside(element, remarks, (element.tag, _name(element)))
        for child in element.children if element.tag in _READ_IN else ():
            if child.tag not in _READ_IN[element.tag]:
                remarks.add(f"<{child.tag:.60}> of <{element.tag}> ignored", element.tag, _name(element))
        if element.tag in _USED:
            continue
        if element.tag == "transmission":
            _remark_transmission(element, remarks)
        elif element.tag == "gazebo":
            _remark_gazebo(element, remarks)
        elif "joint" in element.tag or "constraint" in element.tag:
            remarks.add(f"<{element.tag:.60}> ignored, {OPEN_LOOP}", "element", _name(element))
        else:
            remarks.add(f"<{element.tag:.60}> ignored", "element", _name(element))


def _remark_inside(element: Element, remarks: Remarks, thing: tuple[str, str]) -> None:
    """Remark on attributes and repeated elements in a link or joint that nothing reads."""
    remark_unread(remarks, element, _ATTRIBUTES, _SEVERAL, thing)
    for child in element.children:
        if child.tag in _ATTRIBUTES or child.tag == "inertial":
            _remark_inside(child, remarks, thing)


def _remark_gazebo(element: Element, remarks: Remarks) -> None:
    plain = True
    for inner in _inside(element):
        if inner.tag == "joint":
            remarks.add(f"joints in <gazebo> ignored, {OPEN_LOOP}", "joint", _name(inner))
        elif inner.tag in ("link", "model"):
            remarks.add(f"<{inner.tag}> in <gazebo> ignored", inner.tag, _name(inner))
        elif inner.tag in _MECHANICS:
            name = inner.attributes.get("name") or _name(element)
            remarks.add(f"<{inner.tag}> of <gazebo> ignored", "element", name)
        else:
            continue
        plain = False
    if plain:
        remarks.add("<gazebo> ignored", "element", _name(element))


def _remark_transmission(element: Element, remarks: Remarks) -> None:
    """A transmission's actuator is not modelled: efforts act on joints."""
    joints = [joint.attributes.get("name", "?") for joint in _inside(element) if joint.tag.endswith("joint")]
    name = ", ".join(dict.fromkeys(joints)) or _name(element)
    remarks.add("<transmission> ignored: efforts are those of joints", "joint", name)
    for inner in _inside(element):
        tag = inner.tag.rpartition(":")[2]
        stated = inner.text or inner.attributes.get("value", "") or inner.attributes.get("mechanicalReduction", "")
        if "inertia" in tag.lower():
            remarks.add("inertia of rotors in <transmission> ignored (armature of a Joint)", "joint", name)
        elif tag in ("mechanicalReduction", "gear_ratio") and not _is_one(stated):
            remarks.add("reduction of <transmission> ignored", "joint", name)
        elif tag in ("compensator", "flexJoint", "rollJoint", "gap_joint", "passive_joint"):
            remarks.add(f"<{tag}> of <transmission> ignored", "joint", name)


def _inside(element: Element) -> Iterator[Element]:
    """The elements inside one at any depth, except those inside plug-ins and sensors."""
    pending = list(reversed(element.children))
    while pending:
        inner = pending.pop()
        yield inner
        if inner.tag not in ("plugin", "sensor"):
            pending += reversed(inner.children)


def _name(element: Element) -> str:
    return element.attributes.get("name") or element.attributes.get("reference") or f"line {element.line}"


def _is_one(text: str) -> bool:
    try:
        return float(text) == 1.0
    except ValueError:
        return not text
