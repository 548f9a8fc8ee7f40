"""URDF in, as Pinocchio understands it: links are bodies, joints carry them, the root is the base.

What a rigid tree has no place for (collisions, transmissions) is ignored, and System.notes says so.
Joints that mimic others are independent, as Pinocchio has them by default, or coupled where that is asked for.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

from symofros.base.sources import Source
from symofros.description.closing import closing_remedy
from symofros.description.constraints import MIMICS, Coupling, mimic_cycle, mimicry
from symofros.description.imported.building import system_of
from symofros.description.imported.options import DEFAULT_OPTIONS, ImportOptions
from symofros.description.imported.tree import ImportedBody, ImportedJoint, ImportedTree, Resistance
from symofros.description.joints.joint import WORLD, Joint
from symofros.description.joints.joint_kinds import KINDS
from symofros.description.packages import Packages
from symofros.description.reading import Reading, read_bytes
from symofros.description.system import Inertia
from symofros.description.urdf.extras import remark_extras
from symofros.description.urdf.planar import planar_frames
from symofros.description.urdf.values import Values, finite_numbers
from symofros.description.urdf.visuals import Visuals
from symofros.description.values import ORIGIN, Rotation, Vector
from symofros.description.visual import Visual
from symofros.description.xml_nodes import Element, parse_xml
from symofros.errors import DescriptionError, did_you_mean

MAX_BYTES = 16 << 20
MAX_LINKS = 10_000
ROOT_JOINT = "root_joint"  # As in Pinocchio.

_PLANAR = "planar"  # Written as its three simple joints, which more programs read; read by its name.
_KINDS = {row.urdf: row for row in KINDS.values() if row.urdf is not None} | {_PLANAR: KINDS["planar"]}


def read_urdf(
    path: str | os.PathLike[str],
    options: ImportOptions = DEFAULT_OPTIONS,
    *,
    text: bytes | None = None,
    packages: Packages | None = None,
) -> Reading:
    """Read a URDF file.

    Args:
        path: The file.
        options: How it is read. Without a floating base the root link is the base and never moves.
        text: URDF that was made of the file (xacro), whose lines problems then name.
        packages: Folders that its files may be read from; its own by default.

    Returns:
        The system without the links that could not be read, and every problem.

    Raises:
        DescriptionError: The file can't be read.
    """
    file = os.fspath(path) if text is None else f"{os.fspath(path)} (expanded)"
    content = read_bytes(Path(path), MAX_BYTES) if text is None else text
    root = parse_xml(content, file)
    if root.tag != "robot":
        raise DescriptionError(
            "the file is not a URDF",
            f"the root element is <{root.tag:.60}>",
            "the root element is <robot>",
            "check that it is the file you meant",
            f"{file}:{root.line}",
        )
    reading = _Importer(packages or Packages(Path(path)), Values(file, options.snap_tol), root, options).reading()
    return replace(reading, sources=(Source.of(Path(path), content),)) if text is None else reading


@dataclass
class _Link:
    """A link, and the joint above it once that is known; `joint` stays None for a root or a faulty joint."""

    element: Element
    inertia: Inertia | None
    parent: str | None = None
    joint: ImportedJoint | None = None
    children: list[str] = field(default_factory=list)


class _Importer:
    def __init__(self, packages: Packages, values: Values, robot: Element, options: ImportOptions) -> None:
        self.values = values
        self.visuals = Visuals(packages, robot, values.remarks)
        self.looks: dict[str, tuple[Visual, ...]] = {}
        self.robot = robot
        self.options, self.mimic = options, options.mimic
        self.couplings: list[Coupling] = []
        self.leaders: dict[str, str] = {}
        self.links: dict[str, _Link] = {}
        self.broken: set[str] = set()
        # Rotations from the frames that planar joints move to their links, whose axes are others, by the joint's name.
        self.turned: dict[str, Rotation] = {}
        self.origin: dict[tuple[str, ...], str] = {("system",): values.where(robot)}

    def reading(self) -> Reading:
        name = self.values.attribute(self.robot, "name", "the file") or ""
        self.values.quaternions = self.robot.attributes.get("version", "").strip() == "1.2"
        count = sum(1 for _ in self.robot.all("link"))
        if count > MAX_LINKS:
            self.values.fault(self.robot, "too many links", f"{count} links", f"at most {MAX_LINKS}", "split the robot")
            raise DescriptionError(self.values.problems)
        for element in self.robot.all("link"):
            self.link(element)
        for element in self.robot.all("joint"):
            self.joint(element)
        if not self.links:
            self.values.fault(
                self.robot,
                "the robot has no links",
                f"{len(self.robot.children)} other elements",
                "a robot has at least one <link>",
                "expand the file's macros first (xacro)?",
            )
        remark_extras(self.robot, self.values.remarks)
        if not self.links:
            raise DescriptionError(self.values.problems)
        tree = ImportedTree(
            name,
            self.options,
            self.values.where(self.robot),
            dissipation="none",
            floating_joint=ROOT_JOINT,
            remarks=self.values.remarks,
            bodies=list(self.bodies()),
            constraints=tuple(self.couplings),
            origin=self.origin,
            visuals={name: shapes for name, shapes in self.looks.items() if shapes},
            problems=self.values.problems,
        )
        return Reading(system_of(tree), tuple(tree.problems), frozenset(self.broken))

    def link(self, element: Element) -> None:
        name = self.values.attribute(element, "name", "a link")
        if name is None:
            return
        if name in self.links:
            first = self.links[name].element.line
            self.values.fault(
                element,
                f"link '{name}' appears twice",
                f"lines {first} and {element.line}",
                "names of links are unique",
                "rename one of them",
            )
            return
        before = len(self.values.problems)
        self.links[name] = _Link(element, self.values.inertia(element, f"link '{name}'"))
        self.origin["body", name] = self.values.where(element)
        if len(self.values.problems) > before:
            self.broken.add(name)
        self.looks[name] = self.visuals.of(element, name)
        if element.first("collision"):
            self.values.remarks.add("collision shapes ignored", "link", name)

    def joint(self, element: Element) -> None:
        """Read a joint and hang its child link on it."""
        before = len(self.values.problems)
        name = self.values.attribute(element, "name", "a joint") or "?"
        owner = f"joint '{name}'"
        parent, child = self.end(element, "parent", owner), self.end(element, "child", owner)
        joint = self.joint_noun(element, name)
        if child is None:
            return
        link = self.links.get(child)
        if link is None:
            self.values.fault(
                element,
                f"{owner}: its child link '{child}' does not exist",
                f"child '{child}'",
                "a joint connects two links of the file",
                did_you_mean(child, self.links),
            )
            return
        if link.parent is not None:
            self.values.fault(
                element,
                f"link '{child}' has two parents",
                f"'{link.parent}' and '{parent}'",
                "each link is the child of one joint at most: links form a tree",
                closing_remedy(name, element.attributes.get("type", ""), parent or "?", child),
            )
            return
        link.parent = parent or "?"
        if link.parent in self.links:
            self.links[link.parent].children.append(child)
        if joint is None or len(self.values.problems) > before:
            self.broken.add(child)
            return
        link.joint = ImportedJoint(joint, self.resistances(element, joint))
        self.origin["joint", name] = self.values.where(element)
        self.mimicking(element, name)

    def end(self, element: Element, tag: str, owner: str) -> str | None:
        """The link at one end of a joint."""
        inner = element.first(tag)
        if inner is None:
            self.values.fault(
                element,
                f"{owner}: <{tag}> is missing",
                "no such element",
                "a joint names its <parent> and its <child>",
                f'add <{tag} link="…"/>',
            )
            return None
        return self.values.attribute(inner, "link", owner)

    def joint_noun(self, element: Element, name: str) -> Joint | None:
        owner = f"joint '{name}'"
        stated = self.values.attribute(element, "type", owner)
        position, rotation = self.values.origin(element, owner)
        kind = _KINDS.get(stated or "")
        if kind is None:
            if stated is not None:
                self.values.fault(
                    element,
                    f"{owner}: joints of type '{stated}' are unknown here",
                    f"type '{stated}'",
                    f"one of {', '.join(_KINDS)}",
                    did_you_mean(stated, _KINDS),
                )
            return None
        if stated == _PLANAR:
            return self.planar(element, name, position, rotation)
        if "axis" not in kind.entries:
            return Joint(name, kind.name, position=position, rotation=rotation)
        limits = self.values.limits(element, "limits" in kind.entries, owner)
        axis = self.values.axis(element, owner)
        # What follows another joint has no motor of its own.
        alone = not (self.mimic and element.first("mimic"))
        return Joint(name, kind.name, WORLD, None, position, rotation, axis, actuated=alone, limits=limits)

    def planar(self, element: Element, name: str, position: Vector, rotation: Rotation) -> Joint:
        """A planar joint: its coordinates lie in x and y of P, whose z is the axis; passive, as a floating one is."""
        if element.first("limit") is not None:
            self.values.remarks.add("limits of planar joints ignored", "joint", name)
        placed, turned = planar_frames(rotation, self.values.axis(element, f"joint '{name}'"))
        if turned is not None:
            self.turned[name] = turned
        return Joint(name, "planar", position=position, rotation=placed)

    def resistances(self, element: Element, joint: Joint) -> tuple[Resistance, ...]:
        """Damping and friction of a joint; invalid numbers become NaN, and are refused only if they are used."""
        dynamics = element.first("dynamics")
        stated = {} if dynamics is None else dynamics.attributes
        damping, friction = (
            number[0] if (number := finite_numbers(stated.get(name, "0"), 1)) else math.nan
            for name in ("damping", "friction")
        )
        if any(finite_numbers(stated[name], 1) != (0.0,) for name in stated.keys() - {"damping", "friction"}):
            text = "entries of <dynamics> other than damping and friction ignored"
            self.values.remarks.add(text, "joint", joint.name)
        if joint.traits.nv == 1:
            return (Resistance(damping=damping, friction=friction),)
        if damping or friction:
            text = "damping and friction of fixed, planar and floating joints ignored"
            self.values.remarks.add(text, "joint", joint.name)
        return ()

    def mimicking(self, element: Element, name: str) -> None:
        """Couple a joint that mimics another one, where that is asked for."""
        mimic = element.first("mimic")
        if mimic is not None and not self.mimic:
            text = "mimic ignored, the coordinate stays independent (mimic=True of load, or --mimic, couples it)"
            self.values.remarks.add(text, "joint", name)
        elif mimic is not None:
            self.couple(mimic, name)

    def couple(self, mimic: Element, name: str) -> None:
        """Bind the coordinate of a joint to that of the joint that it mimics."""
        owner = f"joint '{name}'"
        leader = self.values.attribute(mimic, "joint", owner)
        stated = {key: mimic.attributes.get(key, default) for key, default in (("multiplier", "1"), ("offset", "0"))}
        numbers = finite_numbers(" ".join(stated.values()), 2)
        single = {
            joint.attributes.get("name", "")
            for joint in self.robot.all("joint")
            if "axis" in getattr(_KINDS.get(joint.attributes.get("type", "")), "entries", ())
        }
        if numbers is None:
            values = ", ".join(f"{key} '{text:.40}'" for key, text in stated.items())
            self.values.fault(mimic, f"{owner}: <mimic> has bad numbers", values, "finite numbers", "mend the number")
        elif leader is not None and (leader not in single or name not in single or leader == name):
            self.values.fault(
                mimic,
                f"{owner}: it can't mimic joint '{leader}'",
                f"type '{self.type_of(leader)}' of '{leader}'",
                "a joint with one coordinate mimics another one of the file",
                did_you_mean(leader, single - {name}),
            )
        elif leader is not None and (cycle := mimic_cycle(self.leaders, name, leader)):
            self.values.fault(mimic, f"{owner}: it mimics itself by way of others", cycle, *MIMICS)
        elif leader is not None:
            self.couplings.append(mimicry(name, leader, *numbers))
            self.origin["constraint", self.couplings[-1].name] = self.values.where(mimic)

    def type_of(self, joint: str) -> str:
        """Type of the joint of that name; "none" where there is no such joint."""
        named = (element for element in self.robot.all("joint") if element.attributes.get("name") == joint)
        return next((element.attributes.get("type", "none") for element in named), "none")

    def bodies(self) -> Iterator[ImportedBody]:
        """The bodies, depth first, children in the order of the file; what no root reaches comes last."""
        roots = [name for name, link in self.links.items() if link.parent is None]
        done: set[str] = set()
        for start in (*roots, *self.links):
            stack = [start]
            while stack:
                name = stack.pop()
                if name in done:
                    continue
                done.add(name)
                link = self.links[name]
                stack.extend(reversed(link.children))
                if name in self.broken:
                    continue
                joints = () if link.joint is None else (link.joint,)
                turned = self.turned.get(joints[0].joint.name) if joints else None
                yield ImportedBody(
                    name,
                    link.inertia,
                    link.parent or WORLD,
                    joints,
                    None if turned is None else (ORIGIN, turned),
                    is_ground=link.parent is None,
                )
