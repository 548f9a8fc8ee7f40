"""URDF: what each element and attribute means, alone and with another (wiki.ros.org/urdf/XML)."""

from __future__ import annotations

import math
from functools import cache
from xml.etree import ElementTree as XML

import numpy as np

from ...interface import IDENTITY, ORIGIN, Joint, Link, Rows, Tree, Vector, rows, vector
from ..files.readers import Reading, along, rpy_rotation
from .edits import Edit, Features, with_features
from .pairs import Pair

_KINDS = {"continuous": "revolute", "floating": "free"}
_MOMENTS = '<inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/>'
_LINK = '<link name="{}"><inertial><origin xyz="{}"/><mass value="{}"/>' + _MOMENTS + "</inertial></link>"
_LIMIT = '<limit lower="-9" upper="9" effort="9" velocity="9"/>'
_AT_A, _AT_B = '<origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5"/>', '<origin xyz="0 0 0.5"/>'
_JOINT = (
    '<joint name="joint_{0}" type="{2}"><parent link="{1}"/><child link="{0}"/>{3}<axis xyz="{4}"/>'
    + _LIMIT
    + "</joint>"
)
_PLAIN = "".join(
    (
        '<robot name="r"><link name="world"/>',
        _LINK.format("a", "0.1 -0.2 0.3", 2),
        _LINK.format("b", "0 0.1 0.2", 1),
        _JOINT.format("a", "world", "revolute", _AT_A, "0 0 1"),
        _JOINT.format("b", "a", "revolute", _AT_B, "0 1 0"),
        "</robot>",
    )
)


def _numbers(element: XML.Element | None, name: str, default: str) -> list[float]:
    return [float(one) for one in (default if element is None else element.get(name, default)).split()]


def _vector(element: XML.Element | None, name: str, default: str = "0 0 0") -> Vector:
    return vector(np.array(_numbers(element, name, default)))


def _number(element: XML.Element | None, name: str, default: float = 0.0) -> float:
    return default if element is None else float(element.get(name, default))


def _placed(element: XML.Element) -> tuple[Rows, Vector]:
    origin = element.find("origin")
    return rpy_rotation(*_vector(origin, "rpy")), _vector(origin, "xyz")


def _joint(element: XML.Element) -> Joint:
    """The joint; a bound, an angle or a number that is left out is zero, an axis is x, what mimics has the ratio 1."""
    kind = element.get("type", "")
    R, p = _placed(element)
    axis: np.ndarray = np.array(_vector(element.find("axis"), "xyz", "1 0 0"))
    made = Joint(_KINDS.get(kind, kind), R, p)
    if kind in ("fixed", "floating", "planar"):
        return made
    limit, dynamics, mimic = (element.find(one) for one in ("limit", "dynamics", "mimic"))
    return Joint(
        made.kind,
        R,
        p,
        vector(axis / np.linalg.norm(axis)),
        form="unbounded" if kind == "continuous" else "",
        damping=_number(dynamics, "damping"),
        friction=_number(dynamics, "friction"),
        limits=() if kind == "continuous" else (_number(limit, "lower"), _number(limit, "upper")),
        bounds=() if limit is None else (_number(limit, "velocity"), _number(limit, "effort")),
        mimics="" if mimic is None else mimic.get("joint", "").removeprefix("joint_"),
        ratio=_number(mimic, "multiplier", 1.0),
        offset=_number(mimic, "offset"),
    )


def _link(element: XML.Element, parent: int, joint: Joint) -> Link:
    """The link; without inertia it has no mass, and what it collides by and looks like has none."""
    inertial, name = element.find("inertial"), element.get("name", "")
    if inertial is None:
        return Link(name, parent, (joint,), 0.0, ORIGIN, rows(np.zeros((3, 3))))
    R, com = _placed(inertial)
    x, y, z, xy, xz, yz = (_number(inertial.find("inertia"), one) for one in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"))
    inertia = ((x, xy, xz), (xy, y, yz), (xz, yz, z))
    return Link(
        name,
        parent,
        (joint,),
        _number(inertial.find("mass"), "value"),
        com,
        inertia if R == IDENTITY else along(R, inertia),
    )


def meaning(text: str) -> Tree:
    """The tree that a file states, links depth first, what a link carries in the order of the joints."""
    root = XML.fromstring(text)
    links = {one.get("name"): one for one in root.iter("link")}
    joints = {one.find("child").get("link"): one for one in root.findall("joint")}  # type: ignore[union-attr]
    made: list[Link] = []

    def add(name: str | None, place: int) -> None:
        for child, joint in joints.items():
            if joint.find("parent").get("link") == name:  # type: ignore[union-attr]
                made.append(_link(links[child], place, _joint(joint)))
                add(child, len(made) - 1)

    add(next(name for name in links if name not in joints), -1)
    return Tree("", tuple(made))


_A, _B = "link[@name='a']", "link[@name='b']"
_JA, _JB = "joint[@name='joint_a']", "joint[@name='joint_b']"
_OBLONG = {"ixx": "0.21", "iyy": "0.32", "izz": "0.43", "ixy": "0.01", "ixz": "-0.02", "iyz": "0.03"}
_EQUAL = {"ixx": "0.3", "izz": "0.3"}
_TURN: Edit = (f"{_A}/inertial/origin", {"rpy": "0.5 0.6 0.7"})
_MOMENTS_OF_A = f"{_A}/inertial/inertia"
_BOX = '<geometry><box size="0.4 0.6 1.2"/></geometry>'
_SHAPES = (
    f'<visual><origin xyz="1 2 3"/>{_BOX}<material name="red"><color rgba="1 0 0 1"/></material></visual>'
    f'<collision name="shape"><origin xyz="0.1 -0.2 0.3" rpy="0.1 0.2 0.3"/>{_BOX}</collision>'
    '<collision><geometry><cylinder radius="0.2" length="0.7"/></geometry></collision>'
)
_EMPTY, _HEAVY = '<link name="m"/>', _LINK.format("m", "0 0.1 0.2", 1)
_FIXED = _JOINT.format("m", "a", "fixed", _AT_B, "1 0 0").replace(_LIMIT, "")
_OTHERS = (
    '<gazebo reference="a"><mass>7</mass><gravity>0</gravity></gazebo>'
    '<material name="red"><color rgba="1 0 0 1"/></material>'
    '<transmission name="t"><type>transmission_interface/SimpleTransmission</type><joint name="joint_a">'
    "<hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface></joint>"
    '<actuator name="m"><mechanicalReduction>50</mechanicalReduction></actuator></transmission><!-- end -->'
)


def _limits(**bounds: str) -> list[Edit]:
    stated = {"lower": None, "upper": None, "effort": "7", "velocity": "3", **bounds}
    return [(f"{_JB}/limit", stated)]


def _origin(path: str, xyz: str | None, *angles: float) -> list[Edit]:
    return [(f"{path}/origin", {"xyz": xyz, "rpy": " ".join(map(repr, angles)) or None})]


def _axis(path: str, axis: str) -> list[Edit]:
    return [(f"{path}/axis", {"xyz": axis} if axis else "-")]


def _mimic(**stated: str) -> list[Edit]:
    attributes = "".join(f' {name}="{value}"' for name, value in stated.items())
    return [(_JB, f'+<mimic joint="joint_a"{attributes}/>')]


def _fixed_between(link: str) -> list[Edit]:
    return [(".", f"+{link}{_FIXED}"), (f"{_JB}/parent", {"link": "m"})]


_PLACE = "0.1 0.2 0.3"
FEATURES: Features = {
    "inertia": {
        "inertial frame turned": [_TURN],
        "equal moments, frame turned": [_TURN, (_MOMENTS_OF_A, _EQUAL)],
        "two equal moments, frame turned": [_TURN, (_MOMENTS_OF_A, {"ixx": "0.3"})],
        "products of inertia": [(_MOMENTS_OF_A, _OBLONG)],
        "products of inertia, frame turned": [_TURN, (_MOMENTS_OF_A, _OBLONG)],
        "inertial origin left out": [(f"{_A}/inertial/origin", "-")],
        "inertial frame turned, xyz left out": [_TURN, (f"{_A}/inertial/origin", {"xyz": None})],
        "elements in another order": [
            (f"{_A}/inertial/origin", "-"),
            (f"{_A}/inertial", '+<origin xyz="0.1 -0.2 0.3"/>'),
        ],
    },
    "inertia of the last link": {
        "products of inertia, last link turned": [
            (f"{_B}/inertial/origin", {"rpy": "0.5 0.6 0.7"}),
            (f"{_B}/inertial/inertia", _OBLONG),
        ],
        "heavy last link": [(f"{_B}/inertial/mass", {"value": "2e3"})],
    },
    "placement": {
        "rpy left out": _origin(_JA, _PLACE),
        "xyz left out": _origin(_JA, None, 0.3, -0.4, 0.5),
        "joint origin left out": [(f"{_JA}/origin", "-")],
        "pitch of a quarter turn": _origin(_JA, _PLACE, 0.4, math.pi / 2, 0.3),
        "pitch of minus a quarter turn": _origin(_JA, _PLACE, 0.4, -math.pi / 2, 0.3),
        "roll of a half turn": _origin(_JA, _PLACE, math.pi, 0.2, -0.3),
        "yaw of a half turn": _origin(_JA, _PLACE, 0.2, -0.3, math.pi),
        "angles beyond a half turn": _origin(_JA, _PLACE, 4.0, 2.5, -5.0),
        "numbers in other spellings": [
            (f"{_JA}/origin", {"xyz": " 1e-1 2.0E-1 +.3 ", "rpy": "3e-1  -.4 +0.50"}),
        ],
    },
    "placement of the second joint": {
        "second joint turned": _origin(_JB, "0 0 0.5", 0.2, 0.3, -0.4),
        "second joint's origin left out": [(f"{_JB}/origin", "-")],
    },
    "axis": {
        "axis left out": _axis(_JB, ""),
        "axis against z": _axis(_JB, "0 0 -1"),
        "axis against x": _axis(_JB, "-1 0 0"),
        "axis almost x": _axis(_JB, "0.99999999995 0.00001 0"),
        "axis of length 2": _axis(_JB, "0 2 0"),
        "axis oblique": _axis(_JB, "0.6 0 0.8"),
    },
    "kind": {
        "continuous": [(_JB, {"type": "continuous"}), (f"{_JB}/limit", "-")],
        "continuous with limits": [(_JB, {"type": "continuous"})],
        "prismatic": [(_JB, {"type": "prismatic"})],
        "fixed link with mass": [(_JB, {"type": "fixed"}), (f"{_JB}/limit", "-")],
    },
    "first kind": {
        "continuous first": [(_JA, {"type": "continuous"}), (f"{_JA}/limit", "-")],
        "prismatic first": [(_JA, {"type": "prismatic"})],
        "fixed link with mass first": [(_JA, {"type": "fixed"}), (f"{_JA}/limit", "-")],
        "floating": [(_JA, {"type": "floating"}), (f"{_JA}/limit", "-"), (f"{_JA}/origin", "-")],
        "planar": [(_JA, {"type": "planar"}), (f"{_JA}/limit", "-")],
    },
    "first axis": {
        "first axis left out": _axis(_JA, ""),
        "first axis oblique": _axis(_JA, "0.6 0 0.8"),
        "first axis against y": _axis(_JA, "0 -1 0"),
    },
    "losses": {
        "damping and friction": [(_JB, '+<dynamics damping="0.7" friction="0.3"/>')],
        "friction alone": [(_JB, '+<dynamics friction="0.3"/>')],
        "damping alone": [(_JB, '+<dynamics damping="0.7"/>')],
        "losses left out": [(_JB, "+<dynamics/>")],
    },
    "losses of the first joint": {"losses first": [(_JA, '+<dynamics damping="0.5" friction="0.2"/>')]},
    "limits": {
        "limits of a hinge": _limits(lower="-0.5", upper="1.25"),
        "limits above zero": _limits(lower="0.5", upper="1.25"),
        "limits beyond a turn": _limits(lower="-7.5", upper="10"),
        "lower limit left out": _limits(upper="1.25"),
        "upper limit left out": _limits(lower="-0.5"),
        "limits beside soft ones": [
            *_limits(lower="-0.5", upper="1.25"),
            (_JB, '+<safety_controller k_velocity="3" soft_lower_limit="-0.25" soft_upper_limit="0.5"/>'),
        ],
    },
    "mimic": {
        "mimic": _mimic(multiplier="2", offset="0.5"),
        "mimic with its defaults": _mimic(),
        "mimic, multiplier left out": _mimic(offset="-0.75"),
        "mimic, offset left out": _mimic(multiplier="-1.5"),
    },
    "links": {
        "fixed link with mass amid": _fixed_between(_HEAVY),
        "fixed link without inertia amid": _fixed_between(_EMPTY),
        "fixed link with mass beside": [(".", f"+{_HEAVY}{_FIXED}")],
        "fixed link without inertia beside": [(".", f"+{_EMPTY}{_FIXED}")],
        "shapes without inertia": [(".", f'+<link name="m">{_SHAPES}</link>{_FIXED}')],
        "fixed link without inertia last": [
            (".", f"+{_EMPTY}{_FIXED}"),
            ("joint[@name='joint_m']/parent", {"link": "b"}),
        ],
        "moving link without inertia amid": [
            (".", "+" + _EMPTY + _JOINT.format("m", "a", "revolute", _AT_B, "1 0 0")),
            (f"{_JB}/parent", {"link": "m"}),
        ],
        "mimic beyond a joint": [
            (".", "+" + _HEAVY + _JOINT.format("m", "b", "revolute", _AT_B, "0 1 0")),
            ("joint[@name='joint_m']", '+<mimic joint="joint_a" multiplier="2" offset="0.5"/>'),
        ],
        "a hinge beside": [(".", "+" + _HEAVY + _JOINT.format("m", "a", "revolute", _AT_A, "1 0 0"))],
    },
    "base": {
        "base link of another name": [
            ("link[@name='world']", {"name": "ground"}),
            (f"{_JA}/parent", {"link": "ground"}),
        ],
        "base link with mass": [("link[@name='world']", "=" + _HEAVY.replace('"m"', '"world"'))],
    },
    "shapes": {"shapes beside inertia": [(_A, f"+{_SHAPES}")]},
    "besides": {
        "elements of other programs": [(".", f"+{_OTHERS}")],
        "safety controller": [(_JB, '+<safety_controller k_velocity="3"/><calibration rising="0.4"/>')],
    },
    # Names of joints last: other edits find them by these.
    "order": {
        "children before parents": [(".", "~")],
        "joints named as their links": [(_JA, {"name": "a"}), (_JB, {"name": "b"})],
    },
}
# What the format leaves open, or has no meaning: limits and losses of what is fixed, a plane along another axis.
NEVER: tuple[Pair, ...] = tuple(
    frozenset(pair)
    for pair in (
        *(("fixed link with mass", factor) for factor in ("losses", "limits", "mimic", "axis", "besides")),
        *(
            (one, factor)
            for one in ("planar", "floating", "fixed link with mass first")
            for factor in ("first axis", "losses of the first joint", "mimic")
        ),
        ("floating", "placement"),
        ("continuous", "limits"),
        ("mimic", "losses"),
        ("mimic", "limits"),
        ("joints named as their links", "mimic"),
        ("joints named as their links", "mimic beyond a joint"),
        ("joints named as their links", "besides"),
    )
)


@cache
def files() -> dict[str, Reading]:
    """All of them, by name."""
    return with_features("urdf", _PLAIN, FEATURES, meaning, 120, NEVER)
