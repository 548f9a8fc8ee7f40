"""MJCF: the tree that a file states, by what its XML reference says (mujoco.readthedocs.io, XMLreference).

Of files as `mjcf_files` makes them: bodies with joints, inertias, geoms and sites, frames, classes of defaults,
actuators and fixed tendons.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from xml.etree import ElementTree as XML

import numpy as np

from ...interface import IDENTITY, ORIGIN, Actuator, Array, End, Joint, Link, Rows, Tendon, Tree, Vector, rows, vector
from ..files.mjcf import solid_of
from ..files.readers import about, along, diagonal, in_series

_KINDS = {"hinge": "revolute", "slide": "prismatic", "ball": "ball", "free": "free"}
_ACTUATORS = ("motor", "position", "velocity", "general")
_SPEEDS = {"revolute": 1, "prismatic": 1, "ball": 3, "free": 6}
_CONTROL = 0.5
_EYE = IDENTITY
Stated = dict[str, str]


def _numbers(stated: Stated, name: str, default: str = "0 0 0") -> list[float]:
    return [float(one) for one in stated.get(name, default).split()]


def _number(stated: Stated, name: str, default: float = 0.0) -> float:
    return float(stated.get(name, default))


def _vector(stated: Stated, name: str, default: str = "0 0 0") -> Vector:
    return vector(np.array(_numbers(stated, name, default)))


@dataclass
class _Reader:
    """What holds for all of a file, and what was read of it.

    Attributes:
        compiler: Attributes of all <compiler>: of each, the last that is stated.
        classes: Class -> element -> its attributes, with those of the classes around it.
        links: Links, depth first.
        sites: Their frames by name.
    """

    compiler: Stated
    classes: dict[str, dict[str, Stated]]
    links: list[Link] = field(default_factory=list)
    sites: dict[str, End] = field(default_factory=dict)

    def of(self, element: XML.Element, childclass: str, kind: str = "") -> Stated:
        """Attributes of an element: its own before those of its class, or else of `childclass`."""
        named = element.get("class", childclass or "main")
        return self.classes.get(named, {}).get(kind or element.tag, {}) | dict(element.attrib)

    def angle(self, value: float) -> float:
        """An angle in radians: degrees are the default."""
        return value if self.compiler.get("angle", "degree") == "radian" else math.radians(value)

    def rotation(self, stated: Stated) -> Rows:
        """The orientation, by whichever attribute states it."""
        if "quat" in stated:
            w, *axis = _numbers(stated, "quat")
            length = math.hypot(*axis)
            return about(vector(np.array(axis)), 2.0 * math.atan2(length, w)) if length else _EYE
        if "axisangle" in stated:
            *axis, angle = _numbers(stated, "axisangle")
            return about(vector(np.array(axis)), self.angle(angle))
        if "euler" in stated:
            sequence = self.compiler.get("eulerseq", "xyz")
            turns = [(s.lower(), self.angle(x)) for s, x in zip(sequence, _numbers(stated, "euler"), strict=True)]
            # Small letters turn about axes of the frame that turns, capitals about those of the parent.
            return in_series(*(turns if sequence.islower() else reversed(turns)))
        if "xyaxes" in stated:
            x, y = np.reshape(_numbers(stated, "xyaxes"), (2, 3))
            x = x / np.linalg.norm(x)
            y = y - (y @ x) * x
            y /= np.linalg.norm(y)
            return rows(np.stack([x, y, np.cross(x, y)], axis=1))
        if "zaxis" in stated:
            return _least_turn(np.array(_numbers(stated, "zaxis")))
        return _EYE

    def body(self, element: XML.Element, parent: int, R: Rows, p: Vector, childclass: str) -> None:
        """Read a body that stands at R, p in its parent, and what it carries."""
        childclass = element.get("childclass", childclass)
        stated = dict(element.attrib)
        R, p = _placed(R, p, self.rotation(stated), _vector(stated, "pos"))
        name, place = element.get("name", ""), len(self.links)
        joints = list(self._joints(element, R, p, childclass))
        mass, com, inertia = self._inertia(element, childclass)
        self.links.append(
            Link(name, parent, tuple(joints), mass, com, inertia, compensation=_number(stated, "gravcomp"))
        )
        for site in element.findall("site"):
            own = self.of(site, childclass)
            self.sites[site.get("name", "")] = End(name, self.rotation(own), _vector(own, "pos"))
        self.inside(element, place, _EYE, ORIGIN, childclass)

    def inside(self, element: XML.Element, parent: int, R: Rows, p: Vector, childclass: str) -> None:
        """Read the bodies of an element, through frames."""
        for child in element:
            if child.tag == "body":
                self.body(child, parent, R, p, childclass)
            elif child.tag == "frame":
                stated = dict(child.attrib)
                at = _placed(R, p, self.rotation(stated), _vector(stated, "pos"))
                self.inside(child, parent, *at, child.get("childclass", childclass))

    def _joints(self, element: XML.Element, R: Rows, p: Vector, childclass: str) -> Iterator[Joint]:
        """The joints: the body's placement, and for each the turn or shift from its reference, about its anchor."""
        free = element.find("freejoint")
        if free is not None:  # No defaults are its.
            yield Joint("free")
            return
        every = [self.of(one, childclass) for one in element.findall("joint")]
        if any(one.get("type") == "free" for one in every):
            yield self._joint(every[0])
            return
        yield Joint("fixed", R, p)
        for stated in every:
            anchor, made = _vector(stated, "pos"), self._joint(stated)
            if any(anchor):
                yield Joint("fixed", p=anchor)
            at = _number(stated, "ref")
            if at and made.kind == "revolute":
                yield Joint("fixed", R=about(made.axis, -self.angle(at)))
            elif at:
                yield Joint("fixed", p=vector(-at * np.array(made.axis)))
            yield made
            if any(anchor):
                yield Joint("fixed", p=vector(-np.array(anchor)))

    def _joint(self, stated: Stated) -> Joint:
        kind = _KINDS[stated.get("type", "hinge")]
        axis = np.array(_numbers(stated, "axis", "0 0 1"))
        is_angle = kind == "revolute"
        bounds, limited = _numbers(stated, "range", "0 0"), stated.get("limited", "auto")
        is_limited = limited == "true" or (
            limited == "auto" and self.compiler.get("autolimits", "true") == "true" and bounds != [0.0, 0.0]
        )
        rest = _number(stated, "springref")
        armature, forces = _number(stated, "armature"), tuple(_numbers(stated, "actuatorfrcrange", ""))
        return Joint(
            kind,
            axis=vector(axis / np.linalg.norm(axis)),
            armature=(armature,) * _SPEEDS[kind] if armature else (),
            damping=_number(stated, "damping"),
            stiffness=_number(stated, "stiffness"),
            rest=self.angle(rest) if is_angle else rest,
            friction=_number(stated, "frictionloss"),
            limits=tuple(map(self.angle, bounds) if is_angle else bounds) if is_limited else (),
            force_limits=forces,
        )

    def _inertia(self, element: XML.Element, childclass: str) -> tuple[float, Vector, Rows]:
        """Mass, mass centre and inertia: as <inertial> states, or of the geoms."""
        inertial, rule = element.find("inertial"), self.compiler.get("inertiafromgeom", "auto")
        solids = [self._solid(self.of(one, childclass)) for one in element.findall("geom")]
        if inertial is not None and (rule != "true" or not solids):
            stated = dict(inertial.attrib)
            mass, com = _number(stated, "mass"), _vector(stated, "pos")
            if "fullinertia" in stated:
                x, y, z, xy, xz, yz = _numbers(stated, "fullinertia")
                own: Rows = ((x, xy, xz), (xy, y, yz), (xz, yz, z))
            else:
                own = along(self.rotation(stated), self._bounded(_numbers(stated, "diaginertia")))
            return max(mass, _number(self.compiler, "boundmass")), com, own
        if rule == "false" or not solids:
            return 0.0, ORIGIN, diagonal(0.0, 0.0, 0.0)
        mass = math.fsum(one for one, _, _ in solids)
        centre: Array = np.sum([one * np.array(p) for one, p, _ in solids], axis=0) / mass
        total: Array = np.zeros((3, 3))
        for one, p, moments in solids:
            r = np.array(p) - centre
            total += np.array(moments) + one * (r @ r * np.eye(3) - np.outer(r, r))
        return mass, vector(centre), rows(total)

    def _bounded(self, moments: list[float]) -> Rows:
        """Moments, no less than the compiler's bound, or balanced: their mean where one exceeds the others' sum."""
        x, y, z = (max(one, _number(self.compiler, "boundinertia")) for one in moments)
        if self.compiler.get("balanceinertia") == "true" and 2.0 * max(x, y, z) > x + y + z:
            x = y = z = (x + y + z) / 3.0
        return diagonal(x, y, z)

    def _solid(self, stated: Stated) -> tuple[float, Vector, Rows]:
        """Mass, centre and inertia of a geom; water where no density is stated, a ball where no type is."""
        kind, size = stated.get("type", "sphere"), [*_numbers(stated, "size"), 0.0, 0.0]
        R, p = self.rotation(stated), _vector(stated, "pos")
        if "fromto" in stated:
            first, last = np.reshape(_numbers(stated, "fromto"), (2, 3))
            way = last - first
            R, p, size = _least_turn(way), vector((first + last) / 2.0), [size[0], float(np.linalg.norm(way)) / 2.0]
        if stated.get("shellinertia") == "true":
            volume, moments = _shell(kind, size)
        elif kind == "sphere":
            volume, moments = solid_of("ellipsoid", size[0], size[0], size[0])
        elif kind in ("capsule", "cylinder"):
            volume, moments = solid_of(kind, size[0], 0.0, size[1])
        else:
            volume, moments = solid_of(kind, size[0], size[1], size[2])
        mass = _number(stated, "mass", _number(stated, "density", 1000.0) * volume)
        return mass, p, along(R, diagonal(*(mass / volume * one for one in moments)))


def _shell(kind: str, size: list[float]) -> tuple[float, Vector]:
    """Area, and moments of a unit of mass for an area, of a ball or of a box."""
    x, y, z = size[:3]
    if kind == "sphere":
        area = 4.0 * math.pi * x * x
        return area, (2.0 / 3.0 * area * x * x,) * 3
    sides = 8.0 * y * z, 8.0 * x * z, 8.0 * x * y
    # Second moments along x: of the two sides across it all of x^2, of the other four a third.
    u, v, w = (h * h * (own + (sum(sides) - own) / 3.0) for h, own in zip((x, y, z), sides, strict=True))
    return sum(sides), (v + w, u + w, u + v)


def _placed(R: Rows, p: Vector, R2: Rows, p2: Vector) -> tuple[Rows, Vector]:
    """A frame within a frame."""
    if R == _EYE and R2 == _EYE:
        return _EYE, vector(np.array(p) + np.array(p2))
    return rows(np.array(R) @ np.array(R2)), vector(np.array(p) + np.array(R) @ np.array(p2))


def _least_turn(z: Array) -> Rows:
    """The least rotation that takes z along a direction."""
    x, y, w = (z / np.linalg.norm(z)).tolist()
    return about((-y, x, 0.0), math.atan2(math.hypot(x, y), w)) if x or y else _EYE


def _classes(root: XML.Element) -> dict[str, dict[str, Stated]]:
    """Classes of defaults; those within another begin with what it states."""
    made: dict[str, dict[str, Stated]] = {"main": {}}

    def add(element: XML.Element, name: str, around: dict[str, Stated]) -> None:
        own = made.setdefault(name, {tag: dict(stated) for tag, stated in around.items()})
        for child in element:
            if child.tag != "default":
                # Defaults of actuators are those of one element, whatever it is called.
                tag = "general" if child.tag in _ACTUATORS else child.tag
                own[tag] = own.get(tag, {}) | dict(child.attrib)
        for child in element.findall("default"):
            add(child, child.get("class", ""), own)

    for section in root.findall("default"):
        add(section, section.get("class", "main"), {})
    return made


def _actuator(kind: str, stated: Stated) -> Actuator:
    """What an actuator's shortcut stands for (XMLreference, actuator)."""
    gain, bias = 1.0, ORIGIN
    match kind:
        case "position":
            gain = _number(stated, "kp", 1.0)
            bias = (0.0, -gain, -_number(stated, "kv"))
        case "velocity":
            gain = _number(stated, "kv", 1.0)
            bias = (0.0, 0.0, -gain)
        case "general":
            gain = _numbers(stated, "gainprm", "1")[0]
            if stated.get("biastype") == "affine":
                bias = vector(np.array([*_numbers(stated, "biasprm"), 0.0, 0.0][:3]))
    gear = _numbers(stated, "gear", "1")[0]
    return Actuator(
        stated.get("joint", ""),
        gear=gear,
        gain=gain,
        bias=bias,
        control=_CONTROL,
        control_limits=tuple(_numbers(stated, "ctrlrange", "")),
        force_limits=tuple(_numbers(stated, "forcerange", "")),
    )


def _tendons(root: XML.Element, reader: _Reader) -> Iterator[Tendon]:
    """Fixed tendons: weighted sums of joints."""
    for one in (one for section in root.findall("tendon") for one in section.findall("fixed")):
        stated = reader.of(one, "", "tendon")
        yield Tendon(
            "coupling",
            tuple(End(part.get("joint", "")) for part in one),
            tuple(float(part.get("coef", 1.0)) for part in one),
            stiffness=_number(stated, "stiffness"),
            damping=_number(stated, "damping"),
            rest=_number(stated, "springlength"),
            armature=_number(stated, "armature"),
        )


def meaning(text: str) -> Tree:
    """The tree that a file states."""
    root = XML.fromstring(text)
    compiler: Stated = {}
    option: Stated = {}
    for one in root.findall("compiler"):
        compiler |= dict(one.attrib)
    for one in root.findall("option"):
        option |= dict(one.attrib)
    off = any(one.get("gravity") == "disable" for one in root.findall("option/flag"))
    reader = _Reader(compiler, _classes(root))
    for world in root.findall("worldbody"):
        reader.inside(world, -1, _EYE, ORIGIN, "")
    total = _number(compiler, "settotalmass", -1.0)
    links = reader.links
    if total > 0.0:
        scale = total / math.fsum(one.mass for one in links)
        links = [replace(one, mass=scale * one.mass, inertia=rows(scale * np.array(one.inertia))) for one in links]
    actuators = (one for section in root.findall("actuator") for one in section)
    return Tree(
        "",
        tuple(links),
        ORIGIN if off else _vector(option, "gravity", "0 0 -9.81"),
        tendons=tuple(_tendons(root, reader)),
        actuators=tuple(_actuator(one.tag, reader.of(one, "", "general")) for one in actuators),
        sensors=tuple(end for name, end in sorted(reader.sites.items()) if re.fullmatch("o[0-9]+", name)),
    )
