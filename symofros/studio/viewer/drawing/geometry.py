"""A checked system -> what to draw of it, from its data alone.

| stated | drawn |
|---|---|
| inertia of a rigid body | the box that has it |
| joint, frames, joints carried | cylinders from the joint to each of them |
| joint axis | a cylinder along it; spheres where a joint has several |
| beam | a tube along its axis, as the equations bend it |
| closure, rod, spring, slide | a connector between two points |
| rolling contact, knife edge | a disc, a sphere, a blade |
| compliant contact | its balls, and the solid that pushes them back |
| visual shapes of a file | these |
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from symofros.base.arrays import Array
from symofros.description import STATION, Anchor, Beam, Closure, Connection, KnifeEdge, RigidBody, Rod, Rolling
from symofros.mechanics.beams import theory_of
from symofros.mechanics.topology import BASE, Link, NamedFrame, Numbers, Placement, SpanningTree, frame_of
from symofros.studio.viewer.drawing.contact_shapes import balls, surface
from symofros.studio.viewer.drawing.drawing import (
    STATIONS,
    Color,
    Drawing,
    DrawnBeam,
    DrawnConnector,
    DrawnPart,
    LinkPoint,
    Triad,
)
from symofros.studio.viewer.drawing.inertia_box import inertia_box, longest_edges
from symofros.studio.viewer.drawing.meshes import Mesh, axes_along, box, cylinder, disc, ellipse, merged, sphere
from symofros.studio.viewer.drawing.visual_meshes import visual_mesh

# Distinct on white and on grey, also to people with red-green blindness.
_PALETTE: tuple[Color, ...] = (
    (68, 119, 170),
    (204, 187, 68),
    (34, 136, 102),
    (238, 119, 51),
    (136, 34, 85),
    (102, 204, 238),
    (153, 153, 51),
)
_BASE, _JOINT, _CLOSURE, _ROD, _SPRING, _SLIDE = (
    (110, 110, 110),
    (60, 60, 60),
    (204, 51, 17),
    (120, 80, 40),
    (0, 153, 136),
    (160, 160, 160),
)

_CONTACT: dict[str, Color] = {"balls": (204, 51, 17), "surface": (187, 187, 187)}

# Shares of the mechanism's size.
_ROD_RADIUS, _JOINT_RADIUS, _JOINT_LENGTH, _THIN, _NEAR = 0.006, 0.012, 0.045, 0.002, 1e-6
# Shares of a link's own length, which its pieces do not exceed; and of the size, which they keep to be seen.
_OF_LINK, _LEAST = 0.12, 0.25
_MAX_BOX = 1.2  # Longest box, over the mechanism's size, that is not taken for a placeholder.
_SLENDER = 60.0  # Length over half the thickness of a beam whose section is not known.
_FLATTEST = 6.0  # Ratio of the sides of its section.


def landmarks(tree: SpanningTree, numbers: Numbers) -> Iterator[LinkPoint]:
    """Points that a picture must hold: joints, frames, mass centres."""
    yield LinkPoint(BASE, np.zeros(3))
    for frame in tree.frames:
        yield LinkPoint(frame.link, placed(frame.placement, numbers)[0])
    for i, link in enumerate(tree.links):
        yield LinkPoint(link.parent, placed(link.placement, numbers)[0])
        for placement, inertia in link.inertias:
            p, R = placed(placement, numbers)
            yield LinkPoint(i, p + R @ numbers.values(inertia.center_of_mass))


def placed(placement: Placement, numbers: Numbers) -> tuple[Array, Array]:
    """Position (3) and rotation (3, 3) of a constant placement."""
    p, R = np.zeros(3), np.eye(3)
    for step in placement:
        p, R = p + R @ numbers.values(step.position), R @ numbers.rotation(step.rotation)
    return p, R


def draw(tree: SpanningTree, values: dict[str, float], size: float, center: Array) -> Drawing:
    """Drawing of a mechanism.

    Args:
        tree: Tree of a checked system.
        values: Values of its parameters, by name; those left out keep their defaults.
        size: Extent, from which parts without a thickness of their own take theirs [m].
        center: Centre (3) [m].
    """
    return _DrawingBuilder(tree, values, size, center).drawing()


class _DrawingBuilder:
    def __init__(self, tree: SpanningTree, values: dict[str, float], size: float, center: Array) -> None:
        self.tree, self.values, self.size, self.center = tree, values, size, center
        self.numbers = Numbers(tree.system, values)
        self.branch_points = {i: list(self._branch_points(i)) for i in range(BASE, len(tree.links))}

    def drawing(self) -> Drawing:
        boxes = list(self._boxes())
        longest = max(longest_edges(self.tree.system, self.numbers), default=0.0)
        triads = tuple(
            Triad(frame.name, frame.link, *placed(frame.placement, self.numbers), self._frame_element(frame))
            for frame in self.tree.frames
        )
        marks = (*self._marks(), *self._contacts())
        parts = (*self._skeleton(), *self._joints(), *boxes, *marks, *self._visuals())
        return Drawing(
            self.tree.system.name,
            parts,
            tuple(self._beams()),
            (*self._slide_connectors(), *self._constraint_connectors()),
            triads,
            self.numbers.values(self.tree.system.gravity),
            self.size,
            self.center,
            longest <= _MAX_BOX * self.size,
        )

    # How thick things are.

    def _color(self, link: int) -> Color:
        return _BASE if link == BASE else _PALETTE[link % len(_PALETTE)]

    def _scaled(self, share: float, link: int) -> float:
        """A share of the mechanism's size, less on short links, so that a gripper's joints do not hide the gripper."""
        own = max((float(np.linalg.norm(p)) for p in self.branch_points[link]), default=0.0)
        if own == 0.0 and link != BASE:
            return self._scaled(share, self.tree.links[link].parent)
        return max(min(share * self.size, share / _ROD_RADIUS * _OF_LINK * own), _LEAST * share * self.size)

    # Rigid bodies.

    def _branch_points(self, link: int) -> Iterator[Array]:
        """Distinct origins of a link's frames and children away from its own; its mass centre if there are none."""
        if link != BASE and self.tree.links[link].beam is not None:
            return  # The beam itself leads there.
        origins = [placed(frame.placement, self.numbers)[0] for frame in self.tree.frames if frame.link == link]
        origins += [placed(child.placement, self.numbers)[0] for child in self.tree.links if child.parent == link]
        far = [p for p in origins if np.linalg.norm(p) > _NEAR * self.size]
        if not far and link != BASE:
            far = [
                place.position
                for place in landmarks(self.tree, self.numbers)
                if place.link == link and np.linalg.norm(place.position) > _NEAR * self.size
            ]
        kept: list[Array] = []
        for p in far:
            if all(np.linalg.norm(p - other) > _NEAR * self.size for other in kept):
                kept.append(p)
                yield p

    def _skeleton(self) -> Iterator[DrawnPart]:
        for link, points in self.branch_points.items():
            if points:
                radius = self._scaled(_ROD_RADIUS, link)
                mesh = merged([cylinder(np.zeros(3), p, radius) for p in points])
                element = self._element(self._body(link))
                yield DrawnPart(f"bodies/{self._name(link)}", "bodies", link, mesh, self._color(link), element)

    def _name(self, link: int) -> str:
        return "world" if link == BASE else self.tree.links[link].name

    # What of the description it is drawn of.

    def _body(self, link: int) -> str:
        """The body that a link is of: of a section of a beam, the beam."""
        if link == BASE:
            return self.tree.frames[0].qualified
        while self.tree.links[link].is_section:
            link = self.tree.links[link].parent
        return self.tree.links[link].name

    def _element(self, body: str) -> str:
        return "world" if body in ("world", self.tree.frames[0].qualified) else f"bodies/{body}"

    def _frame_element(self, frame: NamedFrame) -> str:
        return f"bodies/{frame.body}/frames/{frame.own}" if frame.own else self._element(frame.body)

    def _boxes(self) -> Iterator[DrawnPart]:
        for body in self.tree.system.bodies:
            inertia = inertia_box(body, self.numbers) if isinstance(body, RigidBody) else None
            if inertia is None:
                continue
            frame = frame_of(self.tree, body.name)
            if np.any(inertia.edges > 0.0):
                mesh = box(np.maximum(inertia.edges, _THIN * self.size))
            else:
                mesh = sphere(2 * _JOINT_RADIUS * self.size)  # A point mass.
            mesh = mesh.transformed(inertia.center, inertia.axes).transformed(*placed(frame.placement, self.numbers))
            element, color = self._element(body.name), self._color(frame.link)
            yield DrawnPart(f"inertias/{body.name}", "inertias", frame.link, mesh, color, element)

    def _joints(self) -> Iterator[DrawnPart]:
        for i, link in enumerate(self.tree.links):
            mesh = None if link.is_section else self._joint(link, i)
            if mesh is not None:
                element = f"{self._element(link.name)}/joint"
                yield DrawnPart(f"joints/{link.joint.name}", "joints", i, mesh, _JOINT, element)

    def _joint(self, link: Link, i: int) -> Mesh | None:
        """The sign of a joint, in its distal frame; none of a clamped or a free body."""
        radius, length = self._scaled(_JOINT_RADIUS, i), self._scaled(_JOINT_LENGTH, i)
        symbol = link.joint.traits.symbol
        if symbol is None:
            return None
        if symbol == "sphere":
            return sphere(1.3 * radius)
        if symbol == "disc":
            return disc(length / 2, radius / 2)
        axis = self.numbers.values(link.joint.axis)
        axis = axis / np.linalg.norm(axis)
        if symbol == "box":
            return box(np.array([length, 1.6 * radius, 1.6 * radius])).transformed(np.zeros(3), axes_along(axis))
        return cylinder(-length / 2 * axis, length / 2 * axis, radius)

    def _visuals(self) -> Iterator[DrawnPart]:
        """Parts that draw the visuals of bodies, as stated in the model's file."""
        for body in self.tree.system.bodies:
            for k, visual in enumerate(self.tree.system.visuals.get(body.name, ())):
                mesh = visual_mesh(visual)
                if mesh is None:
                    continue
                frame = frame_of(self.tree, body.name)
                mesh = mesh.transformed(np.array(visual.position), self.numbers.rotation(visual.rotation))
                mesh = mesh.transformed(*placed(frame.placement, self.numbers))
                element = self._element(body.name)
                # A color of the description goes before those of the file, but not before those of its own picture.
                parts = (
                    mesh.by_color() if visual.picture or visual.checker or not visual.color else [(visual.color, mesh)]
                )
                for i, (stated, part) in enumerate(parts):
                    name = f"visuals/{body.name}.{k}" + (f".{i}" if len(parts) > 1 else "")
                    yield DrawnPart(name, "visuals", frame.link, part, stated or self._color(frame.link), element)

    # Beams.

    def _beams(self) -> Iterator[DrawnBeam]:
        tips = {link.tip_of.name: link for link in self.tree.links if link.tip_of is not None}
        for i, link in enumerate(self.tree.links):
            if link.beam is not None:
                tip = tips.get(link.name)
                yield DrawnBeam(
                    link.name,
                    i,
                    tip.q if tip else (0, 0),
                    theory_of(link.beam).shape(self.values, STATIONS),
                    self.numbers.value(link.beam.length),
                    self._outline(link.beam),
                    self._color(i),
                    self._element(link.name),
                )

    def _outline(self, beam: Beam) -> Array:
        """The section at mid-length: that of its rotary inertia, or a guess with the proportions of its stiffnesses."""
        length = self.numbers.value(beam.length)
        middle = Numbers(self.tree.system, {**self.values, STATION: length / 2})
        rhoA, about_y, about_z = (middle.value(x) for x in (beam.rhoA, beam.rhoI_y, beam.rhoI_z))
        if about_y > 0.0 and about_z > 0.0 and rhoA > 0.0:
            # An elliptic section of half-axis a has moment of inertia A a^2/4.
            return ellipse(2 * np.sqrt(about_z / rhoA), 2 * np.sqrt(about_y / rhoA))
        EI_y, EI_z = middle.value(beam.EI_y), middle.value(beam.EI_z)
        ratio = np.sqrt(EI_y / EI_z) if EI_y > 0.0 and EI_z > 0.0 else 1.0
        flat = np.sqrt(np.clip(ratio, 1 / _FLATTEST, _FLATTEST))
        return ellipse(length / _SLENDER / flat, length / _SLENDER * flat)

    # What joins two points, and what touches the ground.

    def _slide_connectors(self) -> Iterator[DrawnConnector]:
        for i, link in enumerate(self.tree.links):
            if link.joint.traits.slides:
                start = LinkPoint(link.parent, placed(link.placement, self.numbers)[0])
                radius = self._scaled(_ROD_RADIUS, i) / 2
                yield DrawnConnector(
                    f"joints/{link.joint.name}.slide",
                    "joints",
                    start,
                    LinkPoint(i, np.zeros(3)),
                    ellipse(radius, radius),
                    _SLIDE,
                    f"{self._element(link.name)}/joint",
                )

    def _constraint_connectors(self) -> Iterator[DrawnConnector]:
        system, radius = self.tree.system, _ROD_RADIUS * self.size
        for item in system.constraints:
            if isinstance(item, Closure):
                yield self._connector("closures", item, radius / 2, _CLOSURE)
            elif isinstance(item, Rod):
                yield self._connector("closures", item, radius, _ROD)
        for spring in system.springs:
            yield self._connector("connections", spring, radius / 2, _SPRING)

    def _connector(self, section: str, item: Closure | Rod | Connection, radius: float, color: Color) -> DrawnConnector:
        return DrawnConnector(
            f"constraints/{item.name}",
            "constraints",
            self._place(item.first),
            self._place(item.second),
            ellipse(radius, radius),
            color,
            f"{section}/{item.name}",
        )

    def _anchor(self, anchor: Anchor) -> NamedFrame:
        return frame_of(self.tree, *anchor)

    def _place(self, anchor: Anchor) -> LinkPoint:
        frame = self._anchor(anchor)
        return LinkPoint(frame.link, placed(frame.placement, self.numbers)[0])

    def _contacts(self) -> Iterator[DrawnPart]:
        """Balls and surfaces of compliant contacts."""
        for item in self.tree.system.contacts:
            shapes = {"balls": (item.first, balls), "surface": (item.second, surface)}
            for label, (anchor, shape) in shapes.items():
                frame, mesh = self._anchor(anchor), shape(item, self.numbers, self.size)
                if mesh is not None:
                    mesh = mesh.transformed(*placed(frame.placement, self.numbers))
                    name, element = f"constraints/{item.name}.{label}", f"contacts/{item.name}"
                    yield DrawnPart(name, "constraints", frame.link, mesh, _CONTACT[label], element)

    def _marks(self) -> Iterator[DrawnPart]:
        """The marks of closures, rolling contacts and knife edges."""
        for item in self.tree.system.constraints:
            if isinstance(item, Closure):
                mesh, anchor = sphere(1.5 * _JOINT_RADIUS * self.size), item.second
            elif isinstance(item, Rolling):
                radius = self.numbers.value(item.radius)
                mesh, anchor = sphere(radius) if item.shape == "sphere" else disc(radius, radius / 15), item.anchor
            elif isinstance(item, KnifeEdge):
                sides = np.array([_JOINT_LENGTH, _JOINT_LENGTH, _JOINT_LENGTH / 3]) * self.size
                sides["xyz".index(item.axis)] = _THIN * self.size
                mesh, anchor = box(sides), item.anchor
            else:
                continue
            frame = self._anchor(anchor)
            mesh = mesh.transformed(*placed(frame.placement, self.numbers))
            section = "closures" if isinstance(item, Closure) else "nonholonomic"
            name, element = f"constraints/{item.name}.mark", f"{section}/{item.name}"
            yield DrawnPart(name, "constraints", frame.link, mesh, _CLOSURE, element)
