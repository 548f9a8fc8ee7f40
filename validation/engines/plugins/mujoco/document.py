"""MJCF of a tree: bodies, joints of MuJoCo's own, several to a body."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from xml.sax.saxutils import escape

import numpy as np

from ...interface import Array, Joint, Slot, Tree, Unsupported
from ...tree import SOFT_LIMITS
from ..writing.source import series
from . import elements as beside

# Kind of a joint -> elements (type, axis), chart, coordinates, speeds.
CHARTS: dict[str, tuple[str, int, int]] = {
    "revolute": ("angle", 1, 1),
    "prismatic": ("length", 1, 1),
    "universal": ("two angles", 2, 2),
    "euler": ("three angles", 3, 3),
    "translation": ("three lengths", 3, 3),
    "ball": ("quaternion wxyz, body speeds", 4, 3),
    "free": ("free wxyz, linear before and angular after", 7, 6),
}


def _text(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)


def _elements(joint: Joint) -> list[tuple[str, Array]]:
    """MuJoCo's joints for one of ours: type and axis."""
    unit = np.eye(3)
    match joint.kind:
        case "revolute":
            return [("hinge", np.array(joint.axis))]
        case "prismatic":
            return [("slide", np.array(joint.axis))]
        case "universal":
            return [("hinge", np.array(joint.axis)), ("hinge", np.array(joint.second))]
        case "euler":
            return [("hinge", unit["XYZ".index(letter)]) for letter in joint.sequence]
        case "translation":
            return [("slide", axis) for axis in unit]
        case _:
            return [(joint.kind, unit[2])]


def _name(name: str) -> str:
    """A name escaped for an XML attribute within a triple-quoted Python string."""
    return escape(name, {"'": "&apos;", '"': "&quot;", "\\": "&#92;"})


def _frame(R: Array, p: Array) -> str:
    return f'pos="{_text(p)}" xyaxes="{_text([*R[:, 0], *R[:, 1]])}"'


class _Bodies:
    """Elements of a tree's bodies, with the slots of their joints, which MuJoCo numbers depth first."""

    def __init__(self, tree: Tree, principal: bool) -> None:
        self.tree, self.principal = tree, principal
        self.children: dict[int, list[int]] = {k: [] for k in range(-1, len(tree.links))}
        for k, link in enumerate(tree.links):
            self.children[link.parent].append(k)
        self.slots: dict[int, tuple[Slot, ...]] = {}
        self.nq = self.nv = 0

    def element(self, k: int) -> str | Unsupported:
        """The element of a link and of what it carries."""
        link = self.tree.links[k]
        steps, (R, p) = series(link.joints)
        if steps:
            if not _is_identity(R, p):
                return Unsupported("a link's frame stands at its joints", offered=False)
            R, p = steps[0][:2]
        joints = self._joints(k, steps)
        if isinstance(joints, Unsupported):
            return joints
        inertial = f'<inertial pos="{_text(link.com)}" mass="{link.mass!r}" {self._inertia(np.array(link.inertia))}/>'
        inner = self.elements(k)
        if isinstance(inner, Unsupported):
            return inner
        own = [inertial if link.mass else "", *joints, beside.sites(self.tree, link.name), *inner]
        borne = f' gravcomp="{link.compensation!r}"' if link.compensation else ""
        return f'<body name="{_name(link.name)}" {_frame(R, p)}{borne}>' + "".join(own) + "</body>"

    def elements(self, k: int) -> list[str] | Unsupported:
        """The elements of a link's children; -1 is the world."""
        made = []
        for child in self.children[k]:
            text = self.element(child)
            if isinstance(text, Unsupported):
                return text
            made.append(text)
        return made

    def _inertia(self, inertia: Array) -> str:
        """MJCF attributes of an inertia: its entries, or its principal moments and the turn of its axes.

        By its quaternion, which all releases read: what hides behind a mass matrix is asked of all.
        """
        if not self.principal:
            return f'fullinertia="{_text(inertia[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))}"'
        moments, axes = np.linalg.eigh(inertia)
        axes[:, 2] *= np.linalg.det(axes)
        return f'diaginertia="{_text(moments)}" quat="{_text(beside.quaternion_of(axes))}"'

    def _joints(self, k: int, steps: Sequence[tuple[Array, Array, Joint]]) -> list[str] | Unsupported:
        """The elements of a link's joints."""
        link, own, elements = self.tree.links[k], [], []
        for number, (R, p, joint) in enumerate(steps):
            if joint.kind not in CHARTS or joint.form or joint.mimics:
                return Unsupported(f"no joint of kind {joint.kind} {joint.form}".strip(), offered=False)
            if number and not _is_identity(R, p):
                return Unsupported("joints of one body share its frame", offered=False)
            if joint.kind == "free" and (link.parent >= 0 or not _is_identity(*steps[0][:2])):
                return Unsupported("a free joint stands in the world", offered=False)
            chart, nq, nv = CHARTS[joint.kind]
            q, v = range(self.nq, self.nq + nq), range(self.nv, self.nv + nv)
            own.append(Slot(chart, tuple(q), tuple(v)))
            self.nq, self.nv = q.stop, v.stop
            rows = beside.limits(joint) if self.tree.asked == SOFT_LIMITS else ""
            armature = f' armature="{joint.armature[0]!r}"' if joint.armature else ""
            # A joint alone has its link's name, by which lines and sensors find it.
            named = f' name="{_name(link.name)}"' if len(steps) == len(_elements(joint)) == 1 else ""
            for kind, axis in _elements(joint):
                about = f' axis="{_text(axis)}"' if kind in ("hinge", "slide") else ""
                elements.append(f'<joint{named} type="{kind}"{about}{armature}{beside.forces(joint)}{rows}/>')
        self.slots[k] = tuple(own)
        return elements


def _is_identity(R: Array, p: Array) -> bool:
    return np.array_equal(R, np.eye(3)) and not np.any(p)


def document(tree: Tree, principal: bool = False) -> tuple[str, tuple[tuple[Slot, ...], ...], int, int] | Unsupported:
    """MJCF of a tree, with the slots of its joints, nq and nv.

    Inertias are stated by their entries, or by principal moments: MuJoCo's own diagonalisation stops at 1e-12, which
    shows in the light bodies of a hand; LAPACK's does not.

    MuJoCo numbers joints depth first, so links must stand in that order to have their slots in series; others are found
    by walking.
    """
    made = _Bodies(tree, principal)
    elements = made.elements(-1)
    if isinstance(elements, Unsupported):
        return elements
    bodies = "\n".join([*elements, *filter(None, [beside.sites(tree, "")])])
    option = f'<option gravity="{_text(tree.gravity)}"{beside.options(tree)}/>'
    xml = f'<mujoco model="tree"><compiler angle="radian"/>{option}<worldbody>\n{bodies}\n</worldbody>'
    xml += f"{beside.elements(tree)}</mujoco>"
    return xml, tuple(made.slots[k] for k in range(len(tree.links))), made.nq, made.nv
