"""Numbers, vectors, poses and truth values of SDFormat elements; faults and remarks are collected on the way."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from symofros.base.rotations import normalized, quaternion_matrix
from symofros.description.frames import IDENTITY_POSE, Pose
from symofros.description.imported.geometry import roll_pitch_yaw, stated_rotation
from symofros.description.remarks import remark_unread
from symofros.description.system import Inertia
from symofros.description.urdf.values import Values, finite_numbers
from symofros.description.xml_nodes import Element
from symofros.errors import Problem

# SDFormat's number for "no bound".
UNBOUNDED = 1e16
# Quaternions of six printed digits are unit quaternions to less than this.
UNIT_NORM_TOL = 1e-5
_TRUTH = {"true": True, "1": True, "false": False, "0": False}
# Element -> children that are read, or that a remark of their own tells of.
_READ_IN: dict[str, frozenset[str]] = {
    "link": frozenset(
        {"pose", "inertial", "visual", "gravity", "kinematic", "enable_wind", "self_collide", "must_be_base_link"}
        | {"collision", "sensor", "light", "battery", "audio_source", "projector", "particle_emitter"}
    ),
    "inertial": frozenset({"pose", "mass", "inertia", "fluid_added_mass"}),
    "inertia": frozenset({"ixx", "iyy", "izz", "ixy", "ixz", "iyz"}),
    "joint": frozenset({"pose", "parent", "child", "axis", "axis2", "screw_thread_pitch", "thread_pitch"}),
    "axis": frozenset({"xyz", "limit", "dynamics", "mimic", "use_parent_model_frame"}),
    "axis2": frozenset({"xyz", "limit", "dynamics", "mimic", "use_parent_model_frame"}),
    "limit": frozenset({"lower", "upper", "velocity", "effort"}),
    "dynamics": frozenset({"damping", "friction", "spring_reference", "spring_stiffness"}),
    "mimic": frozenset({"multiplier", "offset", "reference"}),
}
# Attributes of links, joints and what is read inside them.
_ATTRIBUTES: dict[str, tuple[str, ...]] = {
    "link": ("name",),
    "joint": ("name", "type"),
    "pose": ("relative_to", "frame", "degrees", "rotation_format"),
    "inertial": ("auto",),
    "xyz": ("expressed_in",),
    "mimic": ("joint", "axis"),
}
_SEVERAL = frozenset({"visual", "collision", "sensor", "light", "battery", "audio_source", "projector"}) | frozenset(
    {"particle_emitter"}
)
_MOMENTS = (("ixx", 1.0), ("iyy", 1.0), ("izz", 1.0), ("ixy", 0.0), ("ixz", 0.0), ("iyz", 0.0))


@dataclass
class SdfValues(Values):
    """Reads the content of elements, which states what attributes do in URDF.

    Attributes:
        versions: Minor version of each file: 7 of SDFormat 1.7.
    """

    versions: dict[str, int] = field(default_factory=dict)

    def where(self, element: Element) -> str:
        """The element's place, in a file that the main one includes, too."""
        return element.where if element.file else super().where(element)

    def add(self, problem: Problem) -> None:
        """Note a problem.

        Raises:
            DescriptionError: There are more than anybody reads.
        """
        self.problems.append(problem)
        self.check_count()

    def text(self, element: Element, tag: str, default: str = "") -> str:
        """Content of a child; the default where there is none."""
        child = element.first(tag)
        return default if child is None else child.text

    def truth(self, text: str, element: Element, owner: str) -> bool:
        """A truth value."""
        if text.lower() not in _TRUTH:
            self.fault(element, f"{owner}: no truth value", f"'{text:.60}'", "true or false", "write true or false")
        return _TRUTH.get(text.lower(), False)

    def given(self, element: Element, tag: str, owner: str, defaults: tuple[float, ...]) -> tuple[float, ...]:
        """The numbers that a child holds; the defaults where there is none, or after a fault."""
        child = element.first(tag)
        if child is None:
            return defaults
        numbers = finite_numbers(child.text, len(defaults))
        if numbers is None:
            count = len(defaults)
            rule = "a finite number" if count == 1 else f"{count} finite numbers, separated by spaces"
            self.fault(child, f"{owner}: <{tag}> is bad", f"'{child.text:.60}'", rule, "mend the numbers")
        return numbers or defaults

    def one(self, element: Element, tag: str, owner: str, default: float) -> float:
        """One number; the default where there is none."""
        return self.given(element, tag, owner, (default,))[0]

    def bound(self, element: Element, name: str, owner: str) -> float | None:
        """A limit; none where it is not given or as good as infinite."""
        child = element.first(name)
        if child is None or child.text.lower().lstrip("+-") in ("inf", "infinity"):
            return None
        number = self.one(element, name, owner, UNBOUNDED)
        return None if abs(number) >= UNBOUNDED else number

    def remark_unread(self, element: Element, kind: str, name: str) -> None:
        """Tell of elements and attributes of a link or joint that nothing reads."""
        remark_unread(self.remarks, element, _ATTRIBUTES, _SEVERAL, (kind, name))
        for child in element.children:
            if child.tag not in _READ_IN[element.tag]:
                self.remarks.add(f"<{child.tag:.60}> of <{element.tag}> ignored", kind, name)
            elif child.tag in _READ_IN:
                self.remark_unread(child, kind, name)
            elif child.tag in _ATTRIBUTES:
                remark_unread(self.remarks, child, _ATTRIBUTES, _SEVERAL, (kind, name))

    def pose_frame(self, pose: Element | None, owner: str) -> str:
        """Name of the frame that a pose is stated in; "" for its default. Before 1.7 the attribute was `frame`."""
        if pose is None:
            return ""
        name, older = (pose.attributes.get(label, "") for label in ("relative_to", "frame"))
        if older and self.versions.get(pose.file, 7) >= 7:
            self.fault(
                pose,
                f"{owner}: <pose> is bad",
                f"frame='{older:.60}'",
                "since SDFormat 1.7 a pose names its frame by relative_to",
                "write relative_to, which has the meaning that frame had",
            )
        return name or older

    def pose(self, element: Element | None, owner: str) -> Pose:
        """The numbers of a <pose>, by whichever frame it is stated; the identity where there is none."""
        if element is None or not element.text:
            return IDENTITY_POSE
        form = element.attributes.get("rotation_format", "euler_rpy")
        count = {"euler_rpy": 6, "quat_xyzw": 7}.get(form)
        numbers = None if count is None else finite_numbers(element.text, count)
        if numbers is None or (form == "quat_xyzw" and not any(numbers[3:])):
            self.fault(
                element,
                f"{owner}: <pose> is bad",
                f"'{element.text:.80}' with rotation_format '{form:.40}'",
                "x y z and roll pitch yaw (euler_rpy), or a quaternion x y z w that is not zero (quat_xyzw)",
                "mend the numbers",
            )
            return IDENTITY_POSE
        if form == "quat_xyzw":
            quaternion = np.array(numbers[3:])
            if abs(np.linalg.norm(quaternion) - 1.0) > UNIT_NORM_TOL:
                self.remarks.add("quaternions that are no unit quaternions normalized", "pose", owner)
            return Pose(np.array(numbers[:3]), quaternion_matrix(normalized(quaternion)))
        degrees = self.truth(element.attributes.get("degrees", "false"), element, owner)
        angles = [math.radians(angle) if degrees else angle for angle in numbers[3:]]
        return Pose(np.array(numbers[:3]), roll_pitch_yaw(angles))

    def mass_properties(self, link: Element, name: str) -> Inertia:
        """Inertia of a link; unstated values have SDFormat's defaults, 1 kg and a unit matrix."""
        element, owner = link.first("inertial"), f"link '{name}'"
        if element is None:
            self.remarks.add("links without <inertial> have SDFormat's 1 kg and unit inertia", "link", name)
            return Inertia(1.0, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0, 0.0, 0.0, 0.0))
        if self.truth(element.attributes.get("auto", "false"), element, owner):
            self.fault(
                element,
                f"{owner}: its inertia is to be computed of its collision shapes",
                'auto="true"',
                "inertias are stated",
                "run `gz sdf --print --expand-auto-inertials` on the file",
            )
        added = element.first("fluid_added_mass")
        if added and any(self.one(added, child.tag, owner, 0.0) for child in added.children):
            self.remarks.add("added mass of fluids ignored", "link", name)
        matrix = element.first("inertia") or Element("inertia", {}, element.line)
        moments = tuple(self.one(matrix, tag, owner, default) for tag, default in _MOMENTS)
        pose = self.pose(element.first("pose"), owner)
        if frame := self.pose_frame(element.first("pose"), owner):
            self.fault(
                element,
                f"{owner}: the <pose> of its <inertial> is stated in another frame",
                f"'{frame:.60}'",
                "an inertial frame is stated in the frame of its link",
                "state it so, and drop the attribute",
            )
        x, y, z = map(float, pose.p)
        mass = self.one(element, "mass", owner, 1.0)
        return Inertia(mass, (x, y, z), moments, rotation=stated_rotation(pose.R))
