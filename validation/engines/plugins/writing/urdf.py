"""A tree as URDF, for engines that know no other way in."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from xml.etree import ElementTree

from ...interface import IDENTITY, ORIGIN, Joint, Link, Rows, Slot, Statement, Tree, Unsupported, Vector
from ...truth.charts import CHARTS
from .source import Source

# URDF's names of elementary joints with one coordinate, and of none.
SIMPLE = {"revolute": "continuous", "prismatic": "prismatic", "fixed": "fixed"}
WORLD = "world"

# Kinds of joints that every reader of URDF knows -> what URDF calls them.
KINDS = {
    "revolute x": "continuous",
    "revolute y": "continuous",
    "revolute z": "continuous",
    "revolute oblique": "continuous",
    "prismatic": "prismatic",
    "prismatic oblique": "prismatic",
}

_AXIS = re.compile(r'<axis xyz="([^"]*)"|<axis>.*?<xyz[^>]*>([^<]*)<')


def _has_long_axis(tree: Tree, text: str) -> bool:
    """Whether a file of URDF or SDF states an axis of another length than 1."""
    axes = (found[1] or found[2] for found in _AXIS.finditer(text))
    return any(abs(math.hypot(*map(float, axis.split())) - 1.0) > 1e-6 for axis in axes)


def has_bare_link(tree: Tree, text: str) -> bool:
    """Whether a file of URDF states a link without inertia, which by the format has no mass."""
    return "<robot" in text and any(not link.mass for link in tree.links)


def has_bare_shape(tree: Tree, text: str) -> bool:
    """Whether one of these has shapes."""
    return has_bare_link(tree, text) and "<collision" in text


# Of whoever reads these formats.
MESH_WITHIN = Statement(
    "precondition",
    "meshes of MJCF come from files of their own",
    "drake 1.51.1, its warning: The attribute 'vertex' found in a 'mesh' tag is currently unsupported",
    holds=lambda tree, text: "<mesh" in text and "vertex=" in text,
)
UNIT_AXIS = Statement(
    "precondition",
    "the vector of an axis should be normalized",
    "http://wiki.ros.org/urdf/XML/joint and http://sdformat.org/spec?elem=joint: axis, xyz",
    holds=_has_long_axis,
)


@dataclass(frozen=True)
class Described:
    """A tree in URDF.

    Attributes:
        text: The file.
        floating: Whether the root link floats: it is the tree's first link, and no link "world" is in the file.
        joints: For each link of the tree, the names of its moving joints of one coordinate, in series.
        links: Names of the tree's links in their order.
    """

    text: str
    floating: bool
    joints: tuple[tuple[str, ...], ...]
    links: tuple[str, ...]

    @property
    def moving(self) -> tuple[str, ...]:
        """Names of all moving joints of one coordinate, in the order of the tree."""
        return tuple(name for series in self.joints for name in series)


def rpy(R: Rows) -> Vector:
    """Angles of R = Rz(yaw) Ry(pitch) Rx(roll); roll and pitch are those of Rz(yaw)^T R."""
    yaw = math.atan2(R[1][0], R[0][0]) if max(abs(R[0][0]), abs(R[1][0])) > 1e-15 else 0.0
    c, s = math.cos(yaw), math.sin(yaw)
    second = [c * y - s * x for x, y in zip(R[0], R[1], strict=True)]
    return (math.atan2(-second[2], second[1]), math.atan2(-R[2][0], c * R[0][0] + s * R[1][0]), yaw)


def numbers(values: Vector) -> str:
    """Numbers with all digits, as attributes of XML have them."""
    return " ".join(repr(float(x) + 0.0) for x in values)


def describe(tree: Tree, *, base: str = WORLD) -> Described | Unsupported:
    """The tree in URDF; a first link on a free joint alone makes it a floating one."""
    floating = _floats(tree)
    lines: list[str] = []
    series: list[tuple[str, ...]] = []
    if not floating:
        lines.append(f'<link name="{base}"/>')
    for index, link in enumerate(tree.links):
        if index == 0 and floating:
            lines += _link(link)
            series.append(())
            continue
        at = base if link.parent < 0 else tree.links[link.parent].name
        names = []
        for place, joint in enumerate(link.joints):
            refusal = _refusal(joint)
            if refusal:
                return refusal
            last = place == len(link.joints) - 1
            child = link.name if last else f"{link.name}_{place}"
            name = f"joint_{child}"
            lines += _link(link) if last else [f'<link name="{child}"/>']
            lines += _joint(name, joint, at, child)
            if joint.kind != "fixed":
                names.append(name)
            at = child
        series.append(tuple(names))
    for k, end in enumerate(tree.sensors):  # Frames, as links without mass.
        lines += [f'<link name="o{k}"/>', *_joint(f"frame_{k}", Joint("fixed", end.R, end.p), end.link, f"o{k}")]
    text = "\n".join(['<robot name="tree">', *lines, "</robot>"])
    return Described(text, floating, tuple(series), tuple(link.name for link in tree.links))


def base(text: str) -> str:
    """Name of the link that a file hangs all others on."""
    robot = ElementTree.fromstring(text)
    children = {one.get("link") for one in robot.iterfind("joint/child")}
    return next(name for one in robot.iterfind("link") if (name := one.get("name", "")) not in children)


# Text that has an engine read the file of a described tree.
Reading = Callable[[Tree, Described], Source]


def through_reader(reading: Reading) -> Callable[[Tree], Source | Unsupported]:
    """What builds a tree by an engine's reader (`SourcePlugin.write`)."""

    def write(tree: Tree) -> Source | Unsupported:
        described = describe(tree)
        return described if isinstance(described, Unsupported) else reading(tree, described)

    return write


def of_files(reading: Reading) -> Callable[[Tree, str, str], Source | Unsupported]:
    """What reads a file that states a tree (`SourcePlugin.write_reading`)."""

    def write_reading(tree: Tree, form: str, text: str) -> Source | Unsupported:
        described = describe(tree)
        if isinstance(described, Unsupported):
            return described
        names = _joint_names(text)
        own = (
            tuple(name if name in names.values() else names[link.name] for name in series)
            for link, series in zip(tree.links, described.joints, strict=True)
        )
        return reading(tree, replace(described, text=text, joints=tuple(own)))

    return write_reading


def _joint_names(text: str) -> dict[str, str]:
    """Link -> name of the joint that it hangs on."""
    joints = ElementTree.fromstring(text).iterfind("joint")
    return {child.get("link", ""): one.get("name", "") for one in joints if (child := one.find("child")) is not None}


def _floats(tree: Tree) -> bool:
    roots = [link for link in tree.links if link.parent < 0]
    first = tree.links[0].joints
    alone = len(roots) == 1 and len(first) == 1 and first[0].kind == "free"
    return alone and first[0].R == IDENTITY and first[0].p == ORIGIN and not first[0].armature


def _refusal(joint: Joint) -> Unsupported | None:
    if joint.kind not in SIMPLE or joint.form:
        return Unsupported(f'URDF states no joint of kind "{joint.kind} {joint.form}" between links', offered=False)
    if any(joint.armature):
        return Unsupported("URDF states no inertia of rotors", offered=False)
    if joint.mimics:
        return Unsupported("mimicking joints of URDF are no constraint to this engine", offered=False)
    return None


def _origin(p: Vector, R: Rows) -> str:
    return f'<origin xyz="{numbers(p)}" rpy="{numbers(rpy(R))}"/>'


def _link(link: Link) -> list[str]:
    J = link.inertia
    entries = (("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2))
    inertia = " ".join(f'{name}="{float(J[i][j])!r}"' for name, i, j in entries)
    return [
        f'<link name="{link.name}"><inertial><origin xyz="{numbers(link.com)}"/><mass value="{float(link.mass)!r}"/>',
        f"<inertia {inertia}/></inertial></link>",
    ]


def _joint(name: str, joint: Joint, parent: str, child: str) -> list[str]:
    kind = SIMPLE[joint.kind]
    lines = [
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>',
        _origin(joint.p, joint.R),
    ]
    if kind != "fixed":
        lines.append(f'<axis xyz="{numbers(joint.axis)}"/>')
    if joint.damping:
        lines.append(f'<dynamics damping="{joint.damping!r}"/>')
    if kind == "prismatic":
        lines.append('<limit lower="-100" upper="100" effort="1e9" velocity="1e9"/>')
    return [*lines, "</joint>"]


def slots_of(tree: Tree, described: Described, order: Sequence[str], base: str = "") -> tuple[tuple[Slot, ...], ...]:
    """Slots of an engine that orders joints of one coordinate in its own way, after those of a floating base."""
    chart = CHARTS[base] if described.floating else None
    nq, nv = (chart.nq, chart.nv) if chart else (0, 0)
    slots: list[tuple[Slot, ...]] = []
    for link, names in zip(tree.links, described.joints, strict=True):
        if chart and link is tree.links[0]:
            slots.append((Slot(base, tuple(range(nq)), tuple(range(nv))),))
            continue
        moving = [joint for joint in link.joints if joint.kind != "fixed"]
        slots.append(
            tuple(
                Slot("length" if joint.kind == "prismatic" else "angle", (nq + k,), (nv + k,))
                for joint, k in zip(moving, map(list(order).index, names), strict=True)
            )
        )
    return tuple(slots)


def breadth_first(tree: Tree, described: Described) -> list[str]:
    """Names of the moving joints, nearest to the root first, as siblings were stated."""
    depths: dict[str, int] = {}
    level: list[int] = []
    for link, names in zip(tree.links, described.joints, strict=True):
        depth = level[link.parent] if link.parent >= 0 else 0
        for joint in link.joints:
            depth += 1
            if joint.kind not in ("fixed", "free"):
                depths[names[len([name for name in names if name in depths])]] = depth
        level.append(depth)
    return sorted(depths, key=depths.__getitem__)
