"""SpanningTree: the checked system as numbered links, with fixed bodies merged into the links that carry them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from symofros.description.beams.beam import STATION, Beam
from symofros.description.joints.joint import WORLD, Joint
from symofros.description.system import Body, Inertia, RigidBody, System
from symofros.description.values import IDENTITY, Rotation, Term, Vector
from symofros.mechanics.beams.theories import theory_of
from symofros.mechanics.topology.coordinates import CoordinateMap, joint_sizes, map_coordinates, speed_names
from symofros.mechanics.topology.frames import public_names
from symofros.mechanics.topology.graph import check
from symofros.mechanics.topology.numbers import Numbers
from symofros.mechanics.topology.rigid_contacts import with_rigid_contacts
from symofros.mechanics.topology.sticking import with_modes
from symofros.mechanics.topology.switches import with_held_poses

BASE = -1


class Step(NamedTuple):
    """One constant displacement: from a frame to the next, stated in the first."""

    position: Vector
    rotation: Rotation


Placement = tuple[Step, ...]


class Station(NamedTuple):
    """A section of a beam that carries frames between root and tip.

    Attributes:
        tip: Index of the link at the beam's tip, whose coordinates move this one as well.
        xi: Station x/L.
    """

    tip: int
    xi: float


@dataclass(frozen=True)
class Link:
    """A body that moves, with everything rigidly attached to it.

    Attributes:
        name: Name of the body whose frame is the link's.
        joint: Joint between the link and its parent.
        parent: Index of the parent link, or BASE.
        placement: Steps from the parent's frame to the joint's proximal frame P.
        inertias: Inertias of the body and of the bodies fixed to it, each with its placement on the link.
        q: Slice of q as (start, size); empty where the motion is prescribed.
        v: Slice of v as (start, size); empty where the motion is prescribed.
        beam: The beam whose root this link is.
        tip_of: The beam whose tip this link is: its joint stands for the beam's deformation.
        station: Section of a beam that this link is; it has no coordinates of its own.
    """

    name: str
    joint: Joint
    parent: int
    placement: Placement
    inertias: tuple[tuple[Placement, Inertia], ...]
    q: tuple[int, int]
    v: tuple[int, int]
    beam: Beam | None = None
    tip_of: Beam | None = None
    station: Station | None = None

    @property
    def is_section(self) -> bool:
        """Whether the link is a section of a beam, at its tip or before: what moves it is the beam's deformation."""
        return self.tip_of is not None or self.station is not None


@dataclass(frozen=True)
class NamedFrame:
    """A frame that can be asked for.

    Attributes:
        name: Public name: the frame's own where that is unique in the system, otherwise "body.frame".
        qualified: "body.frame", or the body's name for a body frame.
        link: Index of the link it is on, or BASE.
        placement: Steps from the link's frame to it.
        body: Body that it is of.
    """

    name: str
    qualified: str
    link: int
    placement: Placement
    body: str = ""

    @property
    def own(self) -> str:
        """Its name on its body; "" of the body frame."""
        return self.qualified[len(self.body) + 1 :]


@dataclass(frozen=True)
class SpanningTree:
    """The mechanism as it is computed with.

    Attributes:
        system: The system as described, with the parameters of poses that constraints hold, and with the modes of
            friction that sticks and of rigid contacts.
        links: Moving bodies, depth first in the order of description; parents precede children.
        frames: Every named frame.
        coordinates: Index map: names to indices of q, v, u, par.
    """

    system: System
    links: tuple[Link, ...]
    frames: tuple[NamedFrame, ...]
    coordinates: CoordinateMap

    def ancestors(self, index: int) -> list[int]:
        """The link and the links that carry it, tip to base."""
        path = []
        while index != BASE:
            path.append(index)
            index = self.links[index].parent
        return path

    def frame(self, name: str) -> NamedFrame:
        """The frame of that public or qualified name.

        Raises:
            KeyError: There is none.
        """
        for frame in self.frames:
            if name in (frame.name, frame.qualified):
                return frame
        raise KeyError(name)


def coupled_speeds(tree: SpanningTree) -> float:
    """Mean number of other speeds between a speed and the base, those of its own joint counted half: 0 without any."""
    before = {BASE: 0}  # Speeds up to a link, its own among them.
    entries = 0.0
    for index, link in enumerate(tree.links):
        above, own = before[link.parent], link.v[1]
        entries += own * (above + (own - 1) / 2)
        before[index] = above + own
    return entries / max(1, len(tree.coordinates.v))


def joint_names(tree: SpanningTree) -> tuple[str, ...]:
    """Name of each link's joint; of what a beam carries, that of the section."""
    return tuple(link.name if link.is_section else link.joint.name for link in tree.links)


def section_names(tree: SpanningTree) -> tuple[tuple[str, float], ...]:
    """The sections whose forces are formed: name of the elastic beam, and station x/L."""
    beams = [link.tip_of for link in tree.links if link.tip_of is not None]
    return tuple((beam.name, xi) for beam in beams for xi in beam.stations)


def ball_names(tree: SpanningTree) -> tuple[str, ...]:
    """The balls of all contacts, in order."""
    return tuple(name for contact in tree.system.contacts for name in contact.ball_names)


def prescribed_speeds(tree: SpanningTree) -> tuple[str, ...]:
    """Names of the speeds of prescribed motions, in order."""
    return tuple(name for link in tree.links if link.joint.prescribed for name in speed_names(link.joint))


def frame_of(tree: SpanningTree, body: str, frame: str | None = None) -> NamedFrame:
    """The frame of a body, or its body frame; the base answers to "world" too.

    Args:
        tree: Spanning tree of a checked system, in which the names exist.
        body: Name of the body.
        frame: Name of one of the body's extremity frames.
    """
    if frame is None:
        return next((one for one in tree.frames if one.qualified == body), tree.frames[0])
    stated = next((one for one in tree.frames if one.qualified == f"{body}.{frame}"), None)
    # Frames of a base that goes by another name than "world".
    return stated or tree.frame(f"{tree.frames[0].qualified}.{frame}")


def build_tree(system: System) -> SpanningTree:
    """Check a system and number it.

    Raises:
        DescriptionError: With every problem found.
    """
    check(system)
    system = with_rigid_contacts(with_modes(with_held_poses(system)))
    numbers, children = Numbers(system), dict[str, list[Body]]()
    base_names = {WORLD} | {body.name for body in system.bodies if body.joint is None}
    for body in system.bodies:
        if body.joint is not None:
            parent = WORLD if body.joint.parent in base_names else body.joint.parent
            children.setdefault(parent, []).append(_resolved(body, numbers) if isinstance(body, Beam) else body)
    base = next((body for body in system.bodies if body.joint is None), RigidBody(WORLD))
    builder = _Builder(children)
    builder.place(base, BASE, (), WORLD)
    links = tuple(builder.links[i].freeze(builder.inertias[i]) for i in range(len(builder.links)))
    names = public_names([(own, full) for own, full, *_ in builder.frames])
    frames = tuple(NamedFrame(name, *one[1:]) for name, one in zip(names, builder.frames, strict=True))
    return SpanningTree(system, links, frames, map_coordinates(system, [x.joint for x in links]))


def _resolved(beam: Beam, numbers: Numbers) -> Beam:
    """A beam with what it leaves to the generator chosen by its theory."""
    return theory_of(beam).resolved(lambda value, x: numbers.extended({STATION: x}).value(value))


class _Draft(NamedTuple):
    name: str
    joint: Joint
    parent: int
    placement: Placement
    q: tuple[int, int]
    v: tuple[int, int]
    beam: Beam | None
    tip_of: Beam | None
    station: Station | None

    def freeze(self, inertias: list[tuple[Placement, Inertia]]) -> Link:
        return Link(
            self.name,
            self.joint,
            self.parent,
            self.placement,
            tuple(inertias),
            self.q,
            self.v,
            self.beam,
            self.tip_of,
            self.station,
        )


class _Builder:
    def __init__(self, children: dict[str, list[Body]]) -> None:
        self.children = children
        self.links: list[_Draft] = []
        self.inertias: list[list[tuple[Placement, Inertia]]] = []
        self.frames: list[tuple[str, str, int, Placement, str]] = []
        self.nq = self.nv = 0

    def place(self, body: Body, link: int, placement: Placement, key: str) -> None:
        """Place a body on a link, or on a new one beyond its joint, then its descendants; depth first, no recursion."""
        stack = [(body, link, placement, key)]
        while stack:
            body, link, placement, key = stack.pop()
            beam = body if isinstance(body, Beam) else None
            if body.joint is not None and (body.joint.kind != "fixed" or beam is not None):
                link, placement = self._add_link(body.name, body.joint, link, placement, beam), ()
            ends = self._attach(body, link, placement)
            carried = []
            for child in self.children.get(key, ()):
                assert child.joint is not None
                joint = child.joint
                on, at = ends.get(joint.frame, ends[None])
                carried.append((child, on, (*at, Step(joint.position, joint.rotation)), child.name))
            stack.extend(reversed(carried))

    def _add_link(
        self,
        name: str,
        joint: Joint,
        parent: int,
        placement: Placement,
        beam: Beam | None = None,
        tip_of: Beam | None = None,
        station: Station | None = None,
    ) -> int:
        nq, nv = (0, 0) if joint.prescribed else joint_sizes(joint)
        self.links.append(_Draft(name, joint, parent, placement, (self.nq, nq), (self.nv, nv), beam, tip_of, station))
        self.inertias.append([])
        self.nq, self.nv = self.nq + nq, self.nv + nv
        return len(self.links) - 1

    def _attach(self, body: Body, link: int, placement: Placement) -> dict[str | None, tuple[int, Placement]]:
        """Add a body's inertia and frames to its link; where each of its frames is (None: the body frame)."""
        if body.inertia is not None and link != BASE:
            self.inertias[link].append((placement, body.inertia))
        self.frames.append((body.name, body.name, link, placement, body.name))
        ends: dict[str | None, tuple[int, Placement]] = {None: (link, placement)}
        sections = self._add_sections(body, link) if isinstance(body, Beam) else {}
        for frame in body.frames:
            own = (*placement, Step(frame.position, frame.rotation))
            on, at = sections[frame.station] if sections else (link, own)
            ends[frame.name] = (on, at)
            self.frames.append((frame.name, f"{body.name}.{frame.name}", on, at, body.name))
        return ends

    def _add_sections(self, beam: Beam, root: int) -> dict[float, tuple[int, Placement]]:
        """The places of a beam's tip and of its stations with frames.

        Each is a link of its own, which the elastic coordinates move, if there are any; they belong to the tip.
        """
        xis = dict.fromkeys((1.0, *(frame.station for frame in beam.frames)))
        if not beam.modes:
            return {xi: (root, (Step(((Term(xi) * Term(beam.length)).value, 0.0, 0.0), IDENTITY),)) for xi in xis}
        elastic = Joint(f"{beam.name}.elastic", "general", beam.name, coordinates=beam.coordinates)
        tip = self._add_link(f"{beam.name}.tip", elastic, root, (), tip_of=beam)
        places: dict[float, tuple[int, Placement]] = {0.0: (root, ()), 1.0: (tip, ())}
        for xi in xis:
            if xi not in places:
                name = next(frame.name for frame in beam.frames if frame.station == xi)
                name = f"{beam.name}.{name}"
                at = self._add_link(name, Joint(name, "fixed", beam.name), root, (), station=Station(tip, xi))
                places[xi] = at, ()
        return places
