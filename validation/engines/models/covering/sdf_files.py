"""SDFormat: what each element and attribute means, alone and with another (sdformat.org/spec)."""

from __future__ import annotations

import math
from functools import cache
from xml.etree import ElementTree as XML

import numpy as np

from ...interface import ORIGIN, Array, Joint, Link, Rows, Tree, Vector, rows, vector
from ..files.readers import Reading, about, along, rpy_rotation
from .edits import Edit, Features, with_features
from .pairs import Pair

_MOMENTS = "<inertia><ixx>{}</ixx><iyy>{}</iyy><izz>{}</izz><ixy>{}</ixy><ixz>{}</ixz><iyz>{}</iyz></inertia>"
_LIMIT = "<limit><lower>-9</lower><upper>9</upper><effort>9</effort><velocity>9</velocity></limit>"
_ROUND = _MOMENTS.format(0.2, 0.3, 0.4, 0, 0, 0)
_AT_A, _AT_B = "0.1 0.2 0.3 0.3 -0.4 0.5", "0.25 -0.125 0.75 -0.2 0.1 0.6"


def _link(name: str, pose: str, at: str, mass: float) -> str:
    inertial = f"<inertial><pose>{at} 0 0 0</pose><mass>{mass}</mass>{_ROUND}</inertial>"
    return f'<link name="{name}"><pose>{pose}</pose>{inertial}</link>'


def _joined(name: str, parent: str, axis: str) -> str:
    ends = f"<parent>{parent}</parent><child>{name}</child>"
    return f'<joint name="j{name}" type="revolute">{ends}<axis><xyz>{axis}</xyz>{_LIMIT}</axis></joint>'


_PLAIN = (
    f'<sdf version="1.6"><model name="m">{_link("a", _AT_A, "0.1 -0.2 0.3", 2)}{_link("b", _AT_B, "0 0.1 0.2", 1)}'
    f"{_joined('a', 'world', '0 0 1')}{_joined('b', 'a', '0 1 0')}</model></sdf>"
)
_MODEL = "__model__"


def _text(element: XML.Element, path: str, default: str = "") -> str:
    found = element.find(path)
    return default if found is None or found.text is None else found.text


def _number(element: XML.Element, path: str, default: float = 0.0) -> float:
    return float(_text(element, path, str(default)))


def _pose(element: XML.Element | None) -> Array:
    """The displacement (4, 4) that a <pose> states; none where there is none."""
    made = np.eye(4)
    numbers = [] if element is None or element.text is None else [float(one) for one in element.text.split()]
    if element is None or not numbers:
        return made
    p, turn = numbers[:3], numbers[3:]
    if element.get("rotation_format") == "quat_xyzw":
        R = about(vector(np.array(turn[:3])), 2.0 * math.atan2(math.hypot(*turn[:3]), turn[3]))
    else:
        is_degree = element.get("degrees") == "true"
        R = rpy_rotation(*(math.radians(one) if is_degree else one for one in turn))
    made[:3, :3], made[:3, 3] = R, p
    return made


class _Model:
    """Poses in the model of what has a name."""

    def __init__(self, model: XML.Element) -> None:
        self.named: dict[str, tuple[XML.Element, str]] = {}
        for element in model:
            if element.tag in ("link", "frame", "joint", "model"):
                self.named[element.get("name", "")] = element, ""
            if element.tag == "model":
                name = element.get("name", "")
                for inner in element.findall("link"):
                    self.named[f"{name}::{inner.get('name')}"] = inner, name

    def body(self, name: str) -> str:
        """The link that a link or a frame belongs to."""
        element = self.named[name][0] if name in self.named else None
        return self.body(element.get("attached_to", "")) if element is not None and element.tag == "frame" else name

    def pose(self, name: str) -> Array:
        """Pose (4, 4) in the model; what a pose is relative to where it says nothing depends on the element."""
        if name in ("", _MODEL, "world"):
            return np.eye(4)
        element, around = self.named[name]
        stated = element.find("pose")
        beside = {"frame": element.get("attached_to", ""), "joint": _text(element, "child")}.get(element.tag, around)
        relative = beside if stated is None else stated.get("relative_to", beside)
        return np.asarray(self.pose(relative) @ _pose(stated))

    def axis(self, joint: XML.Element, number: str) -> Vector:
        """Direction of a joint's axis in the joint's frame, of unit length."""
        stated = joint.find(f"{number}/xyz")
        assert stated is not None
        x: Array = np.array([float(one) for one in (stated.text or "").split()])
        frame = stated.get("expressed_in", joint.get("name", ""))
        if _text(joint, f"{number}/use_parent_model_frame"):
            frame = _MODEL
        R = self.pose(joint.get("name", ""))[:3, :3].T @ self.pose(frame)[:3, :3]
        return vector(R @ x / np.linalg.norm(x))

    def joints(self, joint: XML.Element, whole: Array) -> tuple[Joint, ...]:
        """The placement of a joint in its parent, the joint, and its child's link in it."""
        parent, child = self.body(_text(joint, "parent")), self.body(_text(joint, "child"))
        at = whole @ self.pose(joint.get("name", ""))
        before = at if parent == "world" else np.linalg.inv(self.pose(parent)) @ self.pose(joint.get("name", ""))
        after = np.linalg.inv(at) @ whole @ self.pose(child)
        made = self._joint(joint)
        return (
            Joint("fixed", _rows(before), vector(before[:3, 3])),
            *([] if made is None else [made]),
            Joint("fixed", _rows(after), vector(after[:3, 3])),
        )

    def _joint(self, joint: XML.Element) -> Joint | None:
        kind = joint.get("type", "")
        if kind == "fixed":
            return None
        if kind == "ball":
            return Joint("ball")
        axis = self.axis(joint, "axis")
        if kind == "universal":
            return Joint("universal", axis=axis, second=self.axis(joint, "axis2"))
        is_bound = kind != "continuous"
        return Joint(
            "prismatic" if kind == "prismatic" else "revolute",
            axis=axis,
            damping=_number(joint, "axis/dynamics/damping"),
            friction=_number(joint, "axis/dynamics/friction"),
            stiffness=_number(joint, "axis/dynamics/spring_stiffness"),
            rest=_number(joint, "axis/dynamics/spring_reference"),
            limits=(_number(joint, "axis/limit/lower"), _number(joint, "axis/limit/upper")) if is_bound else (),
        )


def _rows(pose: Array) -> Rows:
    return rows(pose[:3, :3])


def _inertia(link: XML.Element) -> tuple[float, Vector, Rows]:
    """Mass, mass centre and inertia: a kilogram and a round 1 kg m^2 where nothing is stated."""
    inertial = link.find("inertial")
    if inertial is None:
        return 1.0, ORIGIN, rows(np.eye(3))
    at = _pose(inertial.find("pose"))
    names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    x, y, z, xy, xz, yz = (_number(inertial, f"inertia/{one}", float(one in names[:3])) for one in names)
    own: Rows = ((x, xy, xz), (xy, y, yz), (xz, yz, z))
    return _number(inertial, "mass", 1.0), vector(at[:3, 3]), along(_rows(at), own)


def meaning(text: str) -> Tree:
    """The tree that a file states, links depth first, what a link carries in the order of the joints."""
    found = XML.fromstring(text).find("model")
    assert found is not None
    model, whole = _Model(found), _pose(found.find("pose"))
    placed = found.get("placement_frame")
    if placed:
        whole = whole @ np.linalg.inv(model.pose(placed))
    made: list[Link] = []

    def add(name: str, place: int) -> None:
        for joint in found.findall("joint"):
            child = model.body(_text(joint, "child"))
            if model.body(_text(joint, "parent")) == name:
                inertia = _inertia(model.named[child][0])
                made.append(Link(child.rpartition("::")[2], place, model.joints(joint, whole), *inertia))
                add(child, len(made) - 1)

    add("world", -1)
    return Tree("", tuple(made))


_LA, _LB = "model/link[@name='a']", ".//link[@name='b']"
_JA, _JB = "model/joint[@name='ja']", "model/joint[@name='jb']"
_IA = f"{_LA}/inertial"
_TURNED = "0.1 -0.2 0.3 0.5 0.6 0.7"
_FRAME = '<frame name="f" attached_to="a"><pose>0 0.3 0 0.5 0.6 0.7</pose></frame>'
_FRAME_H, _FRAME_P = (_FRAME.replace('"f"', f'"{one}"') for one in "hp")
_BOX = "<geometry><box><size>0.2 0.4 0.6</size></box></geometry>"


# Frames, and poses relative to what has a name, are of later versions.
_LATE: Edit = (".", {"version": "1.9"})


def _poses(path: str, pose: str) -> list[Edit]:
    return [(f"{path}/pose", f"={pose}"), *([_LATE] if "=" in pose else [])]


def _inertial(pose: str, *moments: float) -> list[Edit]:
    return [
        (f"{_IA}/pose", f"=<pose>{pose}</pose>"),
        *([(f"{_IA}/inertia", "=" + _MOMENTS.format(*moments))] if moments else []),
    ]


def _axis(text: str) -> list[Edit]:
    return [(f"{_JB}/axis/xyz", f"={text}"), *([_LATE] if "=" in text else [])]


def _kind(path: str, kind: str, axes: str = "") -> list[Edit]:
    dropped: list[Edit] = [] if kind in ("prismatic", "continuous") else [(f"{path}/axis", f"={axes}" if axes else "-")]
    return [*dropped, (path, {"type": kind}), *([_LATE] if kind == "continuous" else [])]


def _dynamics(**stated: float) -> list[Edit]:
    inside = "".join(f"<{name}>{value}</{name}>" for name, value in stated.items())
    return [(f"{_JB}/axis", f"+<dynamics>{inside}</dynamics>")]


def _bounds(lower: float, upper: float) -> list[Edit]:
    return [(f"{_JB}/axis/limit", f"=<limit><lower>{lower}</lower><upper>{upper}</upper></limit>")]


_OBLONG = (0.21, 0.32, 0.43, 0.01, -0.02, 0.03)
FEATURES: Features = {
    "pose": {
        "pose in degrees": _poses(_LA, '<pose degrees="true">0.1 0.2 0.3 30 -20 50</pose>'),
        "pose by a quaternion": _poses(_LA, '<pose rotation_format="quat_xyzw">0.1 0.2 0.3 0.4 -0.4 0.8 0.2</pose>'),
        "pose left out": _poses(_LA, ""),
        "pose relative to its joint": [
            *_poses(_LA, '<pose relative_to="ja"/>'),
            (_JA, f'+<pose relative_to="__model__">{_AT_A}</pose>'),
        ],
        "pitch of minus a quarter turn": _poses(_LA, f"<pose>0.1 0.2 0.3 0.4 {-math.pi / 2!r} 0.3</pose>"),
        "pitch of a quarter turn": _poses(_LA, f"<pose>0.1 0.2 0.3 0.4 {math.pi / 2!r} 0.3</pose>"),
    },
    "second pose": {
        "pose relative to a link": _poses(_LB, '<pose relative_to="a">0 0 0.5 0.2 0 -0.3</pose>'),
        "pose relative to a link, empty": _poses(_LB, '<pose relative_to="a"/>'),
        "pose relative to a frame": [
            *_poses(_LB, '<pose relative_to="f">0.1 0 0.2 0 0 0.3</pose>'),
            ("model", f"+{_FRAME}"),
        ],
        "pose relative to a frame in a frame": [
            *_poses(_LB, '<pose relative_to="g"/>'),
            (
                "model",
                f'+{_FRAME}<frame name="g" attached_to="b"><pose relative_to="f">0.1 0.2 0 0 0.4 0</pose></frame>',
            ),
        ],
    },
    "inertia": {
        "inertial frame turned": _inertial(_TURNED),
        "equal moments, frame turned": _inertial(_TURNED, 0.3, 0.3, 0.3, 0, 0, 0),
        "products of inertia": _inertial("0.1 -0.2 0.3 0 0 0", *_OBLONG),
        "products of inertia, frame turned": _inertial(_TURNED, *_OBLONG),
        "inertial pose in degrees": [_LATE, (f"{_IA}/pose", '=<pose degrees="true">0.1 -0.2 0.3 30 -20 50</pose>')],
        "inertial pose left out": [(f"{_IA}/pose", "-")],
        "moments left out": [(f"{_IA}/inertia", "-")],
        "inertial left out": [(_IA, "-")],
    },
    "place of the joint": {
        "anchor of a joint": [(_JB, "+<pose>0 -0.1 0.2 0 0 0</pose>")],
        "joint's frame turned": [(_JB, "+<pose>0 0 0 0.5 0.6 0.7</pose>")],
        "joint's frame turned aside": [(_JB, "+<pose>0 -0.1 0.2 0.5 0.6 0.7</pose>")],
        "joint relative to the parent": [_LATE, (_JB, '+<pose relative_to="a">0.1 0 0.3 0.5 0 0.2</pose>')],
    },
    "place of the first joint": {
        "anchor of the first joint": [(_JA, "+<pose>0.1 -0.1 0.2 0 0 0</pose>")],
        "first joint relative to the model": [
            _LATE,
            (_JA, '+<pose relative_to="__model__">0.1 0 0.3 0.5 0 0.2</pose>'),
        ],
    },
    "axis": {
        "axis of length 2": _axis("<xyz>0 2 0</xyz>"),
        "axis oblique": _axis("<xyz>0.6 0 0.8</xyz>"),
        "axis against x": _axis("<xyz>-1 0 0</xyz>"),
        "axis along the model's": _axis('<xyz expressed_in="__model__">0.6 0 0.8</xyz>'),
        "axis along the parent model's": _axis(
            "<xyz>0.6 0 0.8</xyz><use_parent_model_frame>1</use_parent_model_frame>",
        ),
        "axis along the parent's": _axis('<xyz expressed_in="a">0.6 0 0.8</xyz>'),
        "axis along a frame's": [
            *_axis('<xyz expressed_in="h">0 1 0</xyz>'),
            ("model", "+" + _FRAME.replace('"f"', '"h"')),
        ],
    },
    "kind": {
        "prismatic": _kind(_JB, "prismatic"),
        "continuous": _kind(_JB, "continuous"),
        "ball": _kind(_JB, "ball"),
        "universal": _kind(
            _JB,
            "universal",
            "<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2>",
        ),
        "fixed link with mass": _kind(_JB, "fixed"),
    },
    "first kind": {
        "prismatic first": _kind(_JA, "prismatic"),
        "continuous first": _kind(_JA, "continuous"),
        "ball first": _kind(_JA, "ball"),
        "fixed link with mass first": _kind(_JA, "fixed"),
    },
    "losses": {
        "damping": _dynamics(damping=3.0),
        "damping and friction": _dynamics(damping=3.0, friction=0.25),
        "friction alone": _dynamics(friction=0.25),
        "spring": _dynamics(spring_stiffness=4.0, spring_reference=0.25),
    },
    "limits": {"limits": _bounds(-0.5, 1.25), "limits beyond a turn": _bounds(-7.5, 10.0)},
    "parent": {
        "a frame for parent": [
            _LATE,
            (f"{_JB}/parent", "=<parent>p</parent>"),
            ("model", "+" + _FRAME.replace('"f"', '"p"')),
        ],
        "a frame for child": [
            _LATE,
            (f"{_JB}/child", "=<child>c</child>"),
            ("model", '+<frame name="c" attached_to="b"><pose>0.1 0.2 -0.1 0.3 0 0.2</pose></frame>'),
        ],
    },
    "model": {
        "pose of the model": [("model", "<pose>1 2 3 0.2 -0.3 0.4</pose>")],
        "placement frame": [_LATE, ("model", {"placement_frame": "a"}), ("model", "<pose>1 2 3 0.2 -0.3 0.4</pose>")],
    },
    "besides": {
        "shapes beside inertia": [
            (_LA, f'+<visual name="v">{_BOX}</visual><collision name="c"><pose>1 2 3 0 0 0</pose>{_BOX}</collision>'),
        ],
    },
    "order": {"children before parents": [("model", "~")]},
}
_TURNED_JOINTS = (
    "joint's frame turned",
    "joint's frame turned aside",
    "joint relative to the parent",
    "a frame for child",
)
# What means nothing, or what no page states.
NEVER: tuple[Pair, ...] = tuple(
    frozenset(pair)
    for pair in (
        *((one, other) for one in ("ball", "fixed link with mass") for other in ("axis", "losses", "limits")),
        *(("universal", factor) for factor in ("losses", "limits", "axis")),
        ("continuous", "limits"),
        # Along which axes a ball's coordinates are.
        *(("ball", one) for one in _TURNED_JOINTS),
        *(("axis along the parent model's", factor) for factor in FEATURES),
        ("pose relative to its joint", "place of the first joint"),
        ("pose relative to its joint", "first kind"),
        ("ball first", "first joint relative to the model"),
    )
)


@cache
def files() -> dict[str, Reading]:
    """All of them, by name."""
    return with_features("sdf", _PLAIN, FEATURES, meaning, 140, NEVER)
