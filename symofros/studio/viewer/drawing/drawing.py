"""Drawing: what there is to draw of a mechanism. Data only; `geometry` makes it, `viser_scene` and `raster` show it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple, get_args

import numpy as np

from symofros.base.arrays import Array
from symofros.studio.viewer.drawing.centre_line import CentreLine, RodLine
from symofros.studio.viewer.drawing.meshes import Mesh

Kind = Literal["bodies", "inertias", "joints", "constraints", "paths", "visuals"]
KINDS: tuple[Kind, ...] = get_args(Kind)
Color = tuple[int, int, int]


class LinkPoint(NamedTuple):
    """A point on a link: its index, and p_LF in the link's axes (3) [m]. Link -1 is the world."""

    link: int
    position: Array


@dataclass(frozen=True)
class DrawnPart:
    """Something rigid that moves with a link.

    Attributes:
        name: Unique in the drawing; "/" sorts it into folders.
        kind: Layer that it belongs to, shown or hidden together.
        link: Index of the link, -1 for the world.
        mesh: Mesh in the link's frame.
        color: Red, green, blue, 0 to 255.
        element: Entry of the description that it is drawn of, as the path of the file names it: "world", "bodies/arm",
            "bodies/arm/joint", "bodies/arm/frames/tip", "closures/loop"; "" of what belongs to none.
    """

    name: str
    kind: Kind
    link: int
    mesh: Mesh
    color: Color
    element: str = ""


@dataclass(frozen=True)
class DrawnBeam:
    """A flexible beam.

    Attributes:
        name: Name of the beam.
        link: Link at its root.
        q: Range of its elastic coordinates in q, as (start, size).
        line: Centre line, on which its sections stand.
        length: Length [m].
        outline: Outline of its section, y and z (K, 2) [m].
        color: Red, green, blue.
        element: Entry of the description, as for a DrawnPart.
    """

    name: str
    link: int
    q: tuple[int, int]
    line: CentreLine | RodLine
    length: float
    outline: Array
    color: Color
    element: str = ""


@dataclass(frozen=True)
class DrawnConnector:
    """A straight piece between two points that may move apart: a rod, a spring, the gap of a closure, a slide.

    Attributes:
        name: Unique in the drawing.
        kind: Layer, as for a DrawnPart.
        first: First end point.
        second: Second end point.
        outline: Outline of its section (K, 2) [m].
        color: Red, green, blue.
        element: Entry of the description, as for a DrawnPart.
    """

    name: str
    kind: Kind
    first: LinkPoint
    second: LinkPoint
    outline: Array
    color: Color
    element: str = ""


class Triad(NamedTuple):
    """A named frame: its public name, its link, p_LF (3), R_LF (3, 3), and the entry of the description."""

    name: str
    link: int
    position: Array
    rotation: Array
    element: str = ""


@dataclass(frozen=True)
class Drawing:
    """A mechanism, as it is drawn.

    Attributes:
        name: Name of the system.
        parts: Rigid pieces.
        beams: Deformable beams.
        connectors: Pieces whose ends move apart.
        triads: Every named frame.
        gravity: Acceleration vector in the world (3) [m/s^2].
        size: Extent of the mechanism from end to end [m].
        center: Centre of the mechanism in the neutral configuration (3) [m].
        inertias_fit: Whether no box of inertia is much longer than the mechanism; placeholders in files often are.
    """

    name: str
    parts: tuple[DrawnPart, ...]
    beams: tuple[DrawnBeam, ...]
    connectors: tuple[DrawnConnector, ...]
    triads: tuple[Triad, ...]
    gravity: Array
    size: float
    center: Array
    inertias_fit: bool


def same_geometry(a: Drawing, b: Drawing) -> bool:
    """Whether two drawings of one system, for different parameters, show the same."""

    def numbers(x: Drawing) -> list[Array]:
        parts = [part.mesh.vertices for part in x.parts]
        beams = [array for beam in x.beams for array in (np.array(beam.length), beam.outline)]
        connectors = [end.position for connector in x.connectors for end in (connector.first, connector.second)]
        triads = [array for triad in x.triads for array in (triad.position, triad.rotation)]
        return [*parts, *beams, *connectors, *triads, x.gravity]

    one, other = numbers(a), numbers(b)
    return len(one) == len(other) and all(map(np.array_equal, one, other))
