"""Loads along a geometrically exact beam: their virtual power on root and coordinates (docs/theory/rods.md, 5)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from symofros.description.beams.beam import BeamLoad
from symofros.expr.edges import ZERO, Edge
from symofros.expr.vector import Vec3
from symofros.mechanics.beams.strain.frames import SectionFrame
from symofros.mechanics.beams.strain.sections import BeamSections
from symofros.mechanics.spatial.wrench import Wrench, no_wrench


def on_sections(rod: BeamSections, load: BeamLoad, k: int, d: Vec3) -> tuple[Wrench, list[Edge]]:
    """Component k of a load on a geometrically exact rod, along d or an axis of the sections (18)."""
    g, n = rod.g, len(rod.coordinates)
    wrench, modal = no_wrench(g), [ZERO] * n
    for point in _points(rod, load, k, d, rod.strains.sections.weights):
        wrench = wrench + point.wrench(rod)
        for i in range(n):
            power = g.add(rod.partial_position(point.xi, i).dot(point.force), point.section.spins[i].dot(point.torque))
            modal[i] = g.add(modal[i], power)
    return wrench, modal


class _Point(NamedTuple):
    """A force and a moment on a rod at one station, in B."""

    xi: float
    section: SectionFrame
    force: Vec3
    torque: Vec3

    def wrench(self, rod: BeamSections) -> Wrench:
        """The wrench about the root."""
        return Wrench(self.force, rod.position(self.xi).cross(self.force) + self.torque)


def _points(rod: BeamSections, load: BeamLoad, k: int, d: Vec3, weights: Sequence[float]) -> list[_Point]:
    """Component k of a load on a rod: at its station, or spread over it or a part of it as loads on the sections."""
    force, torque = load.force[k], load.torque[k]
    xis, sections = rod.strains.sections.stations, rod.sections
    if load.at is not None:
        xis, sections = (load.at,), (rod.section_at(load.at),)
        shares = [[rod.along.lower(value)] for value in (force, torque)]
    else:
        shares = [list(rod.shares(value, xis, weights)) for value in (force, torque)]
    points = []
    for xi, section, f, m in zip(xis, sections, *shares, strict=True):
        along = section.R_BS.column(k) if load.axes == "section" else d
        points.append(_Point(xi, section, along.scaled(f), along.scaled(m)))
    return points


def beyond(rod: BeamSections, load: BeamLoad, k: int, d: Vec3, xi: float) -> Iterator[Wrench]:
    """Wrenches about the root, in B, that component k of a load adds up to on the part of a rod beyond a station."""
    yield from (point.wrench(rod) for point in _points(rod, load, k, d, rod.strains.sections.beyond(xi)))
