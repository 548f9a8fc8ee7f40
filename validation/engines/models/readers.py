"""Files whose meaning their formats state, and the trees that they mean: for engines' own parsers."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ..interface import Joint, Link, Rows, Tree, rows


@dataclass(frozen=True)
class Reading:
    """A file and the tree that it states.

    Attributes:
        form: Format: "urdf", "mjcf" or "sdf".
        text: The file; its links are named as the tree's.
        tree: The tree.
    """

    form: str
    text: str
    tree: Tree


def rpy_rotation(roll: float, pitch: float, yaw: float) -> Rows:
    """Rz(yaw) Ry(pitch) Rx(roll)."""
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(angle), math.sin(angle)) for angle in (roll, pitch, yaw))
    Rx, Ry = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]]), np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    return rows(np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]]) @ Ry @ Rx)


_PRINCIPAL: Rows = ((0.2, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, 0.0, 0.4))
_PLACED = Joint("revolute", R=rpy_rotation(0.3, -0.4, 0.5), p=(0.1, 0.2, 0.3), axis=(0.6, 0.0, 0.8))
_BODY = Link("a", -1, (_PLACED,), 2.0, (0.1, -0.2, 0.3), _PRINCIPAL)
_NEXT = Link("b", 0, (Joint("revolute", p=(0.0, 0.0, 0.5), axis=(0.0, 1.0, 0.0)),), 1.0, (0.0, 0.1, 0.2), _PRINCIPAL)

_INERTIA = '<inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4"/>'
_A = f'<link name="a"><inertial><origin xyz="0.1 -0.2 0.3"/><mass value="2"/>{_INERTIA}</inertial></link>'
_B = f'<link name="b"><inertial><origin xyz="0 0.1 0.2"/><mass value="1"/>{_INERTIA}</inertial></link>'
_LIMIT = '<limit lower="-9" upper="9" effort="9" velocity="9"/>'
_AT = '<origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5"/>'


def _urdf(first: str, second: str, a: str = _A, b: str = _B) -> str:
    def joint(name: str, parent: str, inside: str) -> str:
        kind, _, rest = inside.partition("|")
        ends = f'<parent link="{parent}"/><child link="{name}"/>'
        return f'<joint name="joint_{name}" type="{kind}">{ends}{rest}</joint>'

    return f'<robot name="r"><link name="w"/>{a}{b}{joint("a", "w", first)}{joint("b", "a", second)}</robot>'


_FIRST = f'revolute|{_AT}<axis xyz="0.6 0 0.8"/>{_LIMIT}'
_SECOND = f'revolute|<origin xyz="0 0 0.5"/><axis xyz="0 1 0"/>{_LIMIT}'
_TURNED_A = _A.replace('xyz="0.1 -0.2 0.3"', 'xyz="0.1 -0.2 0.3" rpy="0.5 0.6 0.7"')


def _mjcf(a: str, b: str, options: str = '<compiler angle="radian"/>') -> str:
    return (
        f'<mujoco model="r">{options}<worldbody><body name="a" {a}<body name="b" {b}</body></body></worldbody></mujoco>'
    )


_MA = '<inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/>'
_MB = '<inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/>'
_HINGE_A = f'pos="0.1 0.2 0.3"><joint axis="0.6 0 0.8"/>{_MA}'
_HINGE_B = f'pos="0 0 0.5"><joint axis="0 1 0"/>{_MB}'
_UNTURNED = replace(_BODY, joints=(replace(_PLACED, R=rpy_rotation(0, 0, 0)),))


def _tree(name: str, a: Link, b: Link) -> Tree:
    return Tree(name, (a, b))


def _with(link: Link, **changes: object) -> Link:
    """A link with another joint."""
    return replace(link, joints=(replace(link.joints[0], **changes),))  # type: ignore[arg-type]


def _turned_inertia() -> Link:
    R = np.array(rpy_rotation(0.5, 0.6, 0.7))
    return replace(_BODY, inertia=rows(R @ np.array(_PRINCIPAL) @ R.T))


def readings() -> dict[str, Reading]:
    """All files, by name."""
    made = [("urdf", *row) for row in _urdf_files()] + [("mjcf", *row) for row in _mjcf_files()]
    return {name: Reading(form, text, _tree(name, a, b)) for form, name, text, a, b in made}


def _urdf_files() -> list[tuple[str, str, Link, Link]]:
    """URDF files: name, text, the two links that it states."""
    return [
        ("urdf: plain", _urdf(_FIRST, _SECOND), _BODY, _NEXT),
        ("urdf: inertial frame turned", _urdf(_FIRST, _SECOND, _TURNED_A), _turned_inertia(), _NEXT),
        (
            "urdf: continuous",
            _urdf(_FIRST, _SECOND.replace("revolute", "continuous")),
            _BODY,
            _with(_NEXT, form="unbounded"),
        ),
        (
            "urdf: continuous, oblique",
            _urdf(_FIRST.replace("revolute", "continuous"), _SECOND),
            _with(_BODY, form="unbounded"),
            _NEXT,
        ),
        (
            "urdf: axis left out",
            _urdf(_FIRST, _SECOND.replace('<axis xyz="0 1 0"/>', "")),
            _BODY,
            _with(_NEXT, axis=(1.0, 0.0, 0.0)),
        ),
        ("urdf: axis of length 2", _urdf(_FIRST.replace("0.6 0 0.8", "1.2 0 1.6"), _SECOND), _BODY, _NEXT),
        (
            "urdf: fixed link with mass",
            _urdf(_FIRST, 'fixed|<origin xyz="0 0 0.5"/>'),
            _BODY,
            _with(_NEXT, kind="fixed"),
        ),
        (
            "urdf: prismatic",
            _urdf(_FIRST, _SECOND.replace("revolute", "prismatic")),
            _BODY,
            _with(_NEXT, kind="prismatic"),
        ),
        (
            "urdf: mimic",
            _urdf(_FIRST, f'{_SECOND}<mimic joint="joint_a" multiplier="2" offset="0.5"/>'),
            _BODY,
            _with(_NEXT, mimics="a", ratio=2.0, offset=0.5),
        ),
    ]


def _mjcf_files() -> list[tuple[str, str, Link, Link]]:
    """MJCF files, likewise."""
    anchor = (
        Joint("fixed", p=(0.0, 0.0, 0.7)),
        Joint("revolute", axis=(0.0, 1.0, 0.0)),
        Joint("fixed", p=(0.0, 0.1, -0.2)),
    )
    unplaced = '<compiler angle="radian"/>'
    return [
        ("mjcf: plain", _mjcf(_HINGE_A, _HINGE_B), _UNTURNED, _NEXT),
        (
            "mjcf: anchor of a joint",
            _mjcf(_HINGE_A, _HINGE_B.replace("<joint", '<joint pos="0 -0.1 0.2"')),
            _UNTURNED,
            replace(_NEXT, joints=(Joint("fixed", p=(0.0, -0.1, 0.7)), *anchor[1:])),
        ),
        (
            "mjcf: angles in degrees",
            _mjcf(_HINGE_A.replace('0.3">', '0.3" euler="30 0 0">', 1), _HINGE_B, '<compiler angle="degree"/>'),
            _with(_UNTURNED, R=rpy_rotation(math.pi / 6, 0, 0)),
            _NEXT,
        ),
        (
            "mjcf: two joints of a body",
            _mjcf(_HINGE_A, _HINGE_B.replace("<inertial", '<joint type="slide" axis="1 0 0"/><inertial'), unplaced),
            _UNTURNED,
            replace(_NEXT, joints=(*_NEXT.joints, Joint("prismatic", axis=(1.0, 0.0, 0.0)))),
        ),
        (
            "mjcf: armature by default",
            _mjcf(_HINGE_A, _HINGE_B, f'{unplaced}<default><joint armature="0.5"/></default>'),
            _with(_UNTURNED, armature=(0.5,)),
            _with(_NEXT, armature=(0.5,)),
        ),
        (
            "mjcf: ball",
            _mjcf(_HINGE_A, _HINGE_B.replace('<joint axis="0 1 0"/>', '<joint type="ball"/>')),
            _UNTURNED,
            _with(_NEXT, kind="ball"),
        ),
        (
            "mjcf: inertia of geoms",
            _mjcf(
                _HINGE_A,
                'pos="0 0 0.5"><joint axis="0 1 0"/><geom type="box" size="0.1 0.2 0.3" pos="0 0.1 0.2" mass="3"/>',
            ),
            _UNTURNED,
            replace(_NEXT, mass=3.0, inertia=((0.13, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.05))),
        ),
    ]
