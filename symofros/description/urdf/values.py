"""Numbers, vectors, rotations and inertias of URDF elements; faults and remarks are collected on the way."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

import numpy as np

from symofros.base.rotations import normalized, quaternion_matrix
from symofros.description.imported.geometry import stated_rotation
from symofros.description.joints.joint import Limits
from symofros.description.remarks import Remarks
from symofros.description.system import Inertia
from symofros.description.values import IDENTITY, Rotation
from symofros.description.xml_nodes import Element
from symofros.errors import MAX_PROBLEMS, DescriptionError, Problem, first_of

Triple = tuple[float, float, float]

ZERO: Triple = (0.0, 0.0, 0.0)

_NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?\Z")
_INFINITE = re.compile(r"[-+]?inf(?:inity)?\Z", re.IGNORECASE)
_QUARTER = math.pi / 2

# Beyond this the length of an axis is more than rounding of its digits.
_UNIT_TOLERANCE = 1e-6


@dataclass
class Values:
    """Reads attributes of elements.

    Attributes:
        file: File name, for the problems.
        snap_tol: Angles this close to a multiple of pi/2, lengths this close to 0 and entries of an axis this close
            to 0 or +-1 become exact.
        problems: Every fault met.
        remarks: Remarks on what was ignored or changed.
        quaternions: Whether <origin> may state a quaternion: in URDF 1.2.
    """

    file: str
    snap_tol: float
    problems: list[Problem] = field(default_factory=list)
    remarks: Remarks = field(default_factory=Remarks)
    quaternions: bool = False

    def where(self, element: Element) -> str:
        """The element's place."""
        return f"{self.file}:{element.line}"

    def fault(self, element: Element, what: str, found: str, rule: str, remedy: str = "") -> None:
        """Note a problem.

        Raises:
            DescriptionError: There are more than anybody reads.
        """
        self.problems.append(Problem(what, found, rule, remedy, self.where(element)))
        self.check_count()

    def check_count(self) -> None:
        """Stop at more problems than anybody reads.

        Raises:
            DescriptionError: There are more.
        """
        if len(self.problems) > MAX_PROBLEMS:
            raise DescriptionError(first_of(self.problems))

    def attribute(self, element: Element, name: str, owner: str) -> str | None:
        """An attribute that must be there."""
        text = element.attributes.get(name)
        if text is None:
            given = ", ".join(element.attributes) or "no attributes"
            self.fault(
                element,
                f"{owner}: <{element.tag}> lacks the attribute '{name}'",
                given,
                f"<{element.tag}> has the attribute '{name}'",
                f'write <{element.tag} {name}="…">',
            )
        return text

    def numbers(self, element: Element, name: str, owner: str, count: int) -> tuple[float, ...] | None:
        """The numbers of an attribute that must be there."""
        text = self.attribute(element, name, owner)
        if text is None:
            return None
        numbers = finite_numbers(text, count)
        if numbers is None:
            rule = "a finite number" if count == 1 else f"{count} finite numbers, separated by spaces"
            remedy = "expand the file's macros first (xacro)" if "${" in text else ""
            self.fault(element, f"{owner}: <{element.tag}> has a bad '{name}'", f"'{text:.60}'", rule, remedy)
            return None
        return numbers

    def number(self, element: Element, name: str, owner: str) -> float:
        """One number; NaN after a fault."""
        numbers = self.numbers(element, name, owner, 1)
        return numbers[0] if numbers else math.nan

    def triple(self, element: Element, name: str, owner: str, default: Triple) -> Triple:
        """Three numbers, or the default where the attribute is not given."""
        if name not in element.attributes:
            return default
        numbers = self.numbers(element, name, owner, 3)
        return (numbers[0], numbers[1], numbers[2]) if numbers else default

    def origin(self, owner_element: Element, owner: str) -> tuple[Triple, Rotation]:
        """Position and rotation of <origin>, snapped; none where there is none."""
        element = owner_element.first("origin")
        if element is None:
            return ZERO, IDENTITY
        position = self.triple(element, "xyz", owner, ZERO)
        x, y, z = self.snapped(position, (0.0,), owner)
        if "quat_xyzw" in element.attributes:
            return (x, y, z), self.quaternion(element, owner)
        angles = self.triple(element, "rpy", owner, ZERO)
        roll, pitch, yaw = (self.snapped((angle,), (round(angle / _QUARTER) * _QUARTER,), owner)[0] for angle in angles)
        return (x, y, z), Rotation.rpy(roll, pitch, yaw)

    def quaternion(self, element: Element, owner: str) -> Rotation:
        """The rotation of an <origin> by its quaternion, which URDF has since version 1.2, in place of angles."""
        numbers = self.numbers(element, "quat_xyzw", owner, 4) or (0.0, 0.0, 0.0, 1.0)
        if not self.quaternions or "rpy" in element.attributes or not any(numbers):
            found = ", ".join(element.attributes) + ("" if self.quaternions else "; URDF before version 1.2")
            rule = "angles, or in URDF 1.2 a quaternion that is not zero, and not both"
            remedy = 'write rpy="…" alone, or quat_xyzw="…" alone and <robot version="1.2">'
            self.fault(element, f"{owner}: <origin> can't have this quat_xyzw", found, rule, remedy)
            return IDENTITY
        quaternion = np.array(numbers)
        if abs(np.linalg.norm(quaternion) - 1.0) > _UNIT_TOLERANCE:
            self.remarks.add("quaternions that are no unit quaternions normalized", "element", _bare(owner))
        return stated_rotation(quaternion_matrix(normalized(quaternion)))

    def axis(self, owner_element: Element, owner: str) -> Triple:
        """Direction of <axis>, snapped; x where there is none, as URDF has it."""
        element = owner_element.first("axis")
        stated: tuple[float, ...] = (1.0, 0.0, 0.0)
        if element is not None:
            stated = self.numbers(element, "xyz", owner, 3) or stated
        x, y, z = self.snapped(stated, (0.0, 1.0, -1.0), owner)
        length = math.hypot(x, y, z)
        if length == 0.0:
            self.fault(
                element or owner_element,
                f"{owner}: the axis has no direction",
                f"'{x:g} {y:g} {z:g}'",
                "an axis is not the zero vector",
                'give a direction such as xyz="0 0 1"',
            )
        elif abs(length - 1.0) > _UNIT_TOLERANCE:
            self.remarks.add("axes that are not unit vectors are normalised", "joint", _bare(owner))
        return x, y, z

    def snapped(self, values: tuple[float, ...], exact: tuple[float, ...], owner: str) -> tuple[float, ...]:
        """The values, each replaced by an exact one within the tolerance."""
        result = tuple(next((e for e in exact if abs(value - e) <= self.snap_tol), value) for value in values)
        if result != values:
            self.remarks.add(f"numbers within {self.snap_tol:g} of exact ones made exact", "element", _bare(owner))
        return result

    def inertia(self, link: Element, owner: str) -> Inertia | None:
        """The inertia of a link; None for one without."""
        element = link.first("inertial")
        if element is None:
            self.remarks.add("links without <inertial> are massless", "link", _bare(owner))
            return None
        position, rotation = self.origin(element, owner)
        mass, matrix = element.first("mass"), element.first("inertia")
        for part, tag in ((mass, "mass"), (matrix, "inertia")):
            if part is None:
                child_tags = ", ".join(f"<{child.tag}>" for child in element.children) or "nothing inside"
                self.fault(
                    element,
                    f"{owner}: <inertial> lacks <{tag}>",
                    child_tags,
                    "<inertial> holds <mass> and <inertia>",
                    "add it, or remove <inertial>",
                )
        if mass is None or matrix is None:
            return None
        kilograms = self.number(mass, "value", owner)
        xx, yy, zz, xy, xz, yz = (self.number(matrix, f"i{ij}", owner) for ij in ("xx", "yy", "zz", "xy", "xz", "yz"))
        if not all(map(math.isfinite, (kilograms, xx, yy, zz, xy, xz, yz))):
            return None
        return Inertia(kilograms, position, (xx, yy, zz, xy, xz, yz), rotation=rotation)

    def limits(self, joint: Element, bounded: bool, owner: str) -> Limits | None:
        """The limits of a joint; a bound that is not given or infinite is none."""
        element = joint.first("limit")
        if element is None:
            return None
        velocity, effort = (self.size(element, name, owner) for name in ("velocity", "effort"))
        if not bounded or not {"lower", "upper"} & element.attributes.keys():
            return Limits(velocity=velocity, effort=effort)
        lower, upper = (
            self.bound(element, name, owner) if name in element.attributes else 0.0 for name in ("lower", "upper")
        )
        return Limits(lower, upper, velocity, effort)

    def size(self, element: Element, name: str, owner: str) -> float | None:
        """A limit of a size; of a negative one, by which some mean none and which no size keeps, none."""
        bound = self.bound(element, name, owner)
        if bound is None or not bound < 0.0:
            return bound
        self.remarks.add(f"negative limits of {name} taken for none", "joint", _bare(owner))
        return None

    def bound(self, element: Element, name: str, owner: str) -> float | None:
        """A limit that may be infinite or not given."""
        text = element.attributes.get(name)
        if text is None or _INFINITE.match(text.strip()):
            return None
        return self.number(element, name, owner)


def finite_numbers(text: str, count: int) -> tuple[float, ...] | None:
    """A given number of finite numbers between spaces; None where they are not that."""
    entries = text.split()
    numbers = tuple(float(word) if _NUMBER.match(word) else math.nan for word in entries)
    return numbers if len(numbers) == count and all(map(math.isfinite, numbers)) else None


def _bare(owner: str) -> str:
    """The name in "joint 'name'"."""
    return owner.partition("'")[2].removesuffix("'")
