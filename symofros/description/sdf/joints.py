"""Joints of SDFormat: how a link moves on another one, or what closes a loop.

A joint is placed in a frame J of its child link C; at coordinates of zero all links are where the file puts them.
With A the parent, P is at J's origin with the axes of C, so that an axis in P is that axis in C; where J's origin is
not that of C, a massless body at J carries C.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from symofros.description.closing import BLOCKED, closing_remedy
from symofros.description.constraints import MIMICS, Closure, Coupling, mimic_cycle, mimicry
from symofros.description.forces import Spring
from symofros.description.frames import Frame, Pose
from symofros.description.imported.geometry import Exact
from symofros.description.imported.tree import ImportedBody, ImportedJoint, Placement, Resistance
from symofros.description.joints.joint import WORLD, Joint, Limits
from symofros.description.joints.joint_kinds import KINDS, JointKindName
from symofros.description.sdf.frames import Frames
from symofros.description.sdf.values import UNIT_NORM_TOL, SdfValues
from symofros.description.values import IDENTITY, Vector
from symofros.description.xml_nodes import Element
from symofros.errors import did_you_mean

_KINDS: dict[str, JointKindName] = {
    "revolute": "revolute",
    "continuous": "continuous",
    "prismatic": "prismatic",
    "screw": "screw",
    "universal": "universal",
    "revolute2": "universal",
    "ball": "ball",
    "fixed": "fixed",
}
_CLOSING = ("revolute", "continuous", "prismatic", "ball", "fixed")
_REVOLUTION = 2.0 * math.pi


@dataclass
class SdfJoint:
    """A joint of the file.

    Attributes:
        name: Full name.
        element: Its element.
        scope: Prefix of names in its model.
        kind: Kind of joint here.
        parent: Full name of the parent's frame.
        child: Full name of the child's frame.
    """

    name: str
    element: Element
    scope: str
    kind: JointKindName
    parent: str
    child: str


class JointReader:
    """Makes joints and closures of the file's joints.

    Args:
        values: Reads the numbers.
        frames: Frames of the file.
        exact: Makes numbers exact.

    Attributes:
        joints: The file's joints by their full names.
    """

    def __init__(self, values: SdfValues, frames: Frames, exact: Exact) -> None:
        self.values, self.frames, self.exact = values, frames, exact
        self.joints: dict[str, SdfJoint] = {}
        self._closing: set[str] = set()  # Names of the joints that close loops.

    def add(self, name: str, element: Element, scope: str) -> None:
        """Take up a joint, and its frame."""
        owner = f"joint '{name}'"
        ends = []
        for tag in ("parent", "child"):
            stated = self.values.text(element, tag)
            if not stated:
                self.values.fault(
                    element,
                    f"{owner}: <{tag}> is missing",
                    "no such element",
                    "a joint names its <parent> and its <child>",
                    f"add <{tag}>",
                )
            ends.append(self.frames.full(scope, stated) if stated else "")
        self.values.remark_unread(element, "joint", name)
        kind = _KINDS.get(element.attributes.get("type", ""))
        if kind is None:
            stated = element.attributes.get("type", "")
            remedy = (
                "couple two revolute joints by sf.Coupling" if stated == "gearbox" else did_you_mean(stated, _KINDS)
            )
            rule = f"one of {', '.join(_KINDS)}"
            self.values.fault(element, f"{owner}: type '{stated:.40}' can't be read", f"'{stated:.40}'", rule, remedy)
        if kind is not None and all(ends):
            self.joints[name] = SdfJoint(name, element, scope, kind, ends[0], ends[1])
            self.frames.add(name, element, scope, ends[1], ends[1])

    def carried(self, joint: SdfJoint, child: str, parent: str) -> ImportedBody:
        """A link with its joint, whose D is at J with the axes of the link."""
        C, J = self.frames.relative(child, parent), self.frames.relative(joint.name, child)
        # A shift is the same wherever it is anchored.
        offset = np.zeros(3) if joint.kind in ("prismatic", "fixed") else np.array(self.exact.vector(J.p))
        made = self._made(joint, child, self.exact.placement((C @ Pose(offset, np.eye(3))).p, C.R))
        held = (self.exact.vector(-offset), IDENTITY) if any(offset) else None
        return ImportedBody(child, parent=parent, joints=(made,), placement=held)

    def _made(self, joint: SdfJoint, child: str, placement: Placement) -> ImportedJoint:
        """The joint at its placement on the parent link, with the resistances of its axes."""
        kind, (position, rotation) = joint.kind, placement
        if "axis" not in KINDS[kind].entries:
            if kind == "ball" and joint.element.first("axis"):
                self.values.remarks.add("axes of ball joints (damping, limits) ignored", "joint", joint.name)
            return ImportedJoint(Joint(joint.name, kind, position=position, rotation=rotation))
        axes = [axis for tag in ("axis", "axis2") if (axis := joint.element.first(tag)) is not None]
        if len(axes) < (2 if kind == "universal" else 1):
            self.values.fault(
                joint.element,
                f"joint '{joint.name}': an axis is missing",
                f"{len(axes)} axes",
                "a universal joint and a revolute2 have <axis> and <axis2>, others <axis>",
                "add it",
            )
            return ImportedJoint(Joint(joint.name, kind, position=position, rotation=rotation))
        directions = [self._direction(joint, axis, child) for axis in axes]
        limits = [self._limits(joint, axis) for axis in axes]
        if kind == "revolute" and limits[0] == Limits(None, None, limits[0].velocity, limits[0].effort):
            kind = "continuous"
        # Where no axis has an effort the joint is not actuated, which tells their bounds.
        actuated = not self._mimics(joint) and any(bound.effort != 0.0 for bound in limits)
        kept = Limits(effort=None if actuated else 0.0)
        if kind == "universal" and any(bound not in (Limits(), kept) for bound in limits):
            self.values.remarks.add("limits of universal joints ignored", "joint", joint.name)
        made = Joint(
            joint.name,
            kind,
            WORLD,
            None,
            position,
            rotation,
            directions[0],
            actuated=actuated,
            limits=limits[0] if kind != "universal" else None,
            axis2=directions[-1] if kind == "universal" else (0.0, 1.0, 0.0),
            pitch=self._pitch(joint) if kind == "screw" else 0.0,
        )
        return ImportedJoint(made, tuple(self._resistance(joint, axis) for axis in axes))

    def closing(self, joint: SdfJoint, on: dict[str, list[Frame]]) -> Closure | None:
        """The closure of a joint whose child another joint carries; the frames that it needs go onto the two links."""
        bodies = {label: self.frames.body(getattr(joint, label)) for label in ("parent", "child")}
        self._closing.add(joint.name)
        if joint.kind not in _CLOSING:
            instead = closing_remedy(joint.name, joint.kind, *bodies.values())
            self.values.fault(
                joint.element,
                f"joint '{joint.name}' closes a loop",
                f"type '{joint.element.attributes.get('type')}'",
                f"a loop is closed by one of {', '.join(_CLOSING)}",
                f"let another joint of the loop be the last one, or {instead}",
            )
            return None
        self.values.remarks.add(
            "joints that close loops have no coordinate, input, spring or limit", "joint", joint.name
        )
        axis = joint.element.first("axis")
        R = np.eye(3)
        if "axis" in KINDS[joint.kind].entries and axis is not None:
            z = np.array(self._direction(joint, axis, joint.name), dtype=float)
            x = np.cross(np.eye(3)[int(np.argmin(np.abs(z)))], z)
            x, z = x / np.linalg.norm(x), z / np.linalg.norm(z)
            R = np.column_stack([x, np.cross(z, x), z])
        for label, body in bodies.items():
            pose = self.frames.relative(joint.name, body) @ Pose(np.zeros(3), R)
            on.setdefault(body, []).append(Frame(f"{joint.name}_{label}", *self.exact.placement(*pose)))
        first, second = ((body, f"{joint.name}_{label}") for label, body in bodies.items())
        return Closure(joint.name, first, second, *BLOCKED[joint.kind])

    def couplings(self) -> Iterator[Coupling]:
        """Couplings from <mimic> elements."""
        leaders: dict[str, str] = {}
        for joint in self.joints.values():
            for k, tag in enumerate(("axis", "axis2")):
                axis = joint.element.first(tag)
                mimic = axis.first("mimic") if axis is not None else None
                if mimic is None:
                    continue
                stated = mimic.attributes.get("joint", "")
                leader = self.joints.get(self.frames.full(joint.scope, stated))
                follower = self._coordinate(joint, k)
                leading = self._coordinate(leader, int(mimic.attributes.get("axis") == "axis2")) if leader else ""
                if leader is joint or not leading or not follower:
                    self.values.fault(
                        mimic,
                        f"joint '{joint.name}': it can't mimic joint '{stated}'",
                        "no joint, one without that axis, or one that closes a loop",
                        "a joint mimics the axis of another one of its model; joints of loops' ends have no coordinate",
                        did_you_mean(stated, self.joints),
                    )
                    continue
                owner = f"joint '{joint.name}'"
                if cycle := mimic_cycle(leaders, follower, leading):
                    self.values.fault(mimic, f"{owner}: it mimics itself by way of others", cycle, *MIMICS)
                    continue
                ratio, offset, reference = (
                    self.values.one(mimic, tag, owner, default)
                    for tag, default in (("multiplier", 1.0), ("offset", 0.0), ("reference", 0.0))
                )
                yield mimicry(follower, leading, ratio, offset - ratio * reference)

    @staticmethod
    def _mimics(joint: SdfJoint) -> bool:
        return any(axis.first("mimic") for tag in ("axis", "axis2") for axis in joint.element.all(tag))

    def _coordinate(self, joint: SdfJoint, axis: int) -> str:
        """Name of the coordinate about or along an axis; "" where there is none."""
        if joint.name in self._closing:
            return ""
        suffixes = KINDS[joint.kind].coordinate_suffixes
        if KINDS[joint.kind].quasi_velocities or axis >= len(suffixes):
            return ""
        return f"{joint.name}.{suffixes[axis]}" if suffixes[axis] else joint.name

    def _direction(self, joint: SdfJoint, axis: Element, into: str) -> Vector:
        """Direction of an axis in the frame `into`."""
        owner = f"joint '{joint.name}'"
        stated = axis.first("xyz")
        vector = np.array(self.values.given(axis, "xyz", owner, (0.0, 0.0, 1.0)))
        expressed_in = stated.attributes.get("expressed_in", "") if stated is not None else ""
        frame = self.frames.full(joint.scope, expressed_in) if expressed_in else joint.name
        if self.values.truth(self.values.text(axis, "use_parent_model_frame", "false"), axis, owner):
            frame = self.frames.full(joint.scope, "__model__")
        length = float(np.linalg.norm(vector))
        if frame not in self.frames.nodes or length == 0.0:
            self.values.fault(
                axis,
                f"{owner}: the axis has no direction",
                f"'{stated.text if stated is not None else ''}' in frame '{frame}'",
                "an axis is not the zero vector, and is expressed in a frame of its model",
                did_you_mean(expressed_in, self.frames.nodes) if expressed_in else "give a direction such as 0 0 1",
            )
            return (0.0, 0.0, 1.0)
        if abs(length - 1.0) > UNIT_NORM_TOL:
            self.values.remarks.add("axes that are not unit vectors are normalised", "joint", joint.name)
        if frame == into:
            return self.exact.direction(vector / length)
        return self.exact.direction(self.frames.relative(frame, into).R @ (vector / length))

    def _limits(self, joint: SdfJoint, axis: Element) -> Limits:
        owner = f"joint '{joint.name}'"
        element = axis.first("limit")
        if element is None:
            return Limits()
        lower, upper = (self.values.bound(element, tag, owner) for tag in ("lower", "upper"))
        velocity, effort = (self.values.size(element, tag, owner) for tag in ("velocity", "effort"))
        return Limits(lower, upper, velocity, effort)

    def _pitch(self, joint: SdfJoint) -> float:
        """Pitch of a screw [m/rad]; the older entry has radians per metre, and the other sign."""
        owner = f"joint '{joint.name}'"
        new, old = (self.values.one(joint.element, tag, owner, 0.0) for tag in ("screw_thread_pitch", "thread_pitch"))
        if not new and not old:
            self.values.fault(
                joint.element,
                f"{owner}: the screw has no pitch",
                "neither <screw_thread_pitch> nor <thread_pitch>, or zero",
                "a screw moves along its axis as it turns",
                "add <screw_thread_pitch> in metres per revolution, or use a revolute joint",
            )
            return 0.0
        return new / _REVOLUTION if new else -1.0 / old

    def _resistance(self, joint: SdfJoint, axis: Element) -> Resistance:
        """Spring, damping and friction of an axis."""
        dynamics = axis.first("dynamics")
        if dynamics is None:
            return Resistance()
        damping, friction, rest, stiffness = (
            self.values.one(dynamics, tag, f"joint '{joint.name}'", 0.0)
            for tag in ("damping", "friction", "spring_reference", "spring_stiffness")
        )
        return Resistance(Spring(stiffness, rest) if stiffness else None, damping, friction=friction)
