"""Loads along beams: their virtual power on root and elastic coordinates (docs/theory/beams.md, 5; rods.md, 5)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

from symofros.description.beams.beam import BeamLoad
from symofros.description.values import Value
from symofros.expr.edges import ZERO, Edge
from symofros.expr.vector import Vec3
from symofros.mechanics.beams.elastic import BeamForms
from symofros.mechanics.beams.fields import EVERY_DEGREE, Field, Form, unit_field
from symofros.mechanics.beams.rod import Rod, Section
from symofros.mechanics.dynamics.acceleration import Wrench, no_wrench
from symofros.mechanics.kinematics.frames import FrameKinematics
from symofros.mechanics.kinematics.links import MovingBeam, TreeKinematics

# A field, weighted by a component of a load, at its station or over the length.
Weighted = Callable[[Field, Value], Form]


def beam_loads(kinematics: TreeKinematics, frames: FrameKinematics, beam: MovingBeam) -> tuple[Wrench, list[Edge]]:
    """Wrench and generalized forces of the loads along a beam (eqs. 18, 19).

    Args:
        kinematics: Kinematics of the tree.
        frames: Kinematics of frames, for components in world axes.
        beam: The beam.

    Returns:
        The wrench on its root in the link frame, and the force on each elastic coordinate.
    """
    g, R_LB = kinematics.g, kinematics.links[beam.root].R_LB
    wrench = no_wrench(g)
    modal = [ZERO] * beam.forms.beam.modes
    for load in beam.forms.beam.loads:
        directions = _directions(kinematics, frames, beam, load)
        for k, (d, force, torque) in enumerate(zip(directions, load.force, load.torque, strict=True)):
            if isinstance(beam.forms, Rod):
                one, forces = _on_rod(beam.forms, load, k, d)
            else:
                one, forces = _along(beam.forms, load.at, d, force, torque)
            wrench = wrench + Wrench(R_LB.times(one.f), R_LB.times(one.n))
            modal = [g.add(a, b) for a, b in zip(modal, forces, strict=True)]
    return wrench, modal


def _at_station(forms: BeamForms, xi: float, field: Field, weight: Value) -> Form:
    return forms.along.at(field, xi).scaled(forms.along.lower(weight))


def _on_rod(rod: Rod, load: BeamLoad, k: int, d: Vec3) -> tuple[Wrench, list[Edge]]:
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
    section: Section
    force: Vec3
    torque: Vec3

    def wrench(self, rod: Rod) -> Wrench:
        """The wrench about the root."""
        return Wrench(self.force, rod.position(self.xi).cross(self.force) + self.torque)


def _points(rod: Rod, load: BeamLoad, k: int, d: Vec3, weights: Sequence[float]) -> list[_Point]:
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


def loads_beyond(kinematics: TreeKinematics, frames: FrameKinematics, beam: MovingBeam, xi: float) -> Wrench:
    """The wrench about the root, in B, of the loads along the part of a beam beyond a station, those at it included.

    Args:
        kinematics: Kinematics of the tree.
        frames: Kinematics of frames, for components in world axes.
        beam: The beam.
        xi: Station x/L.
    """
    wrench, forms = no_wrench(kinematics.g), beam.forms
    for load in forms.beam.loads:
        if load.at is not None and load.at < xi:
            continue
        directions = _directions(kinematics, frames, beam, load)
        for k, (d, force, torque) in enumerate(zip(directions, load.force, load.torque, strict=True)):
            if isinstance(forms, Rod):
                for point in _points(forms, load, k, d, forms.strains.sections.beyond(xi)):
                    wrench = wrench + point.wrench(forms)
            else:
                part = forms if load.at is not None else forms.beyond(xi)
                wrench = wrench + _wrench_along(part, load.at, d, force, torque)
    return wrench


def _directions(kinematics: TreeKinematics, frames: FrameKinematics, beam: MovingBeam, load: BeamLoad) -> list[Vec3]:
    """The axes that a load's components are along, in B; of one along those of the sections, the root's."""
    if load.axes != "world":
        return [Vec3.unit(kinematics.g, k) for k in range(3)]
    R_WL, R_LB = frames.link_pose(beam.root).R_WF, kinematics.links[beam.root].R_LB
    return [R_LB.T.times(R_WL.row(k)) for k in range(3)]


def _along(forms: BeamForms, at: float | None, d: Vec3, force: Value, torque: Value) -> tuple[Wrench, list[Edge]]:
    """One component of a load along a direction d: the wrench about Bo, and the elastic coordinates' forces."""
    g, shape = d.g, forms.shape
    wrench, modal = _wrench_along(forms, at, d, force, torque), [ZERO] * forms.beam.modes
    if force != 0.0:
        for i in range(forms.beam.modes):
            partial_velocity = _vector(forms, at, tuple(field.by(i) for field in shape.position), force)
            modal[i] = g.add(modal[i], partial_velocity.dot(d))
    if torque != 0.0:
        if forms.order == EVERY_DEGREE:
            turned = _turned(forms, at, d, torque)
        else:
            turned = [_vector(forms, at, turning, torque).dot(d) for turning in shape.turning]
        modal = [g.add(a, b) for a, b in zip(modal, turned, strict=True)]
    return wrench, modal


def _wrench_along(forms: BeamForms, at: float | None, d: Vec3, force: Value, torque: Value) -> Wrench:
    """The wrench about Bo of one component of a load, along d, on a beam or on the part beyond a station."""
    g, weighted, one = d.g, _weighted(forms, at), unit_field(forms.shape.lengths)
    wrench = no_wrench(g)
    if force != 0.0:
        total = d.scaled(weighted(one, force).value())
        wrench = wrench + Wrench(total, _vector(forms, at, forms.shape.position, force).cross(d))
    if torque != 0.0:
        wrench = wrench + Wrench(Vec3(g), d.scaled(weighted(one, torque).value()))
    return wrench


def _weighted(forms: BeamForms, at: float | None) -> Weighted:
    return partial(_at_station, forms, at) if at is not None else forms.along.integral


def _vector(forms: BeamForms, at: float | None, fields: tuple[Field, ...], weight: Value) -> Vec3:
    weighted = _weighted(forms, at)
    return Vec3(forms.along.g, *(weighted(field, weight).value(forms.order) for field in fields))


def _turned(forms: BeamForms, at: float | None, d: Vec3, torque: Value) -> list[Edge]:
    """Generalized forces of a moment along d on sections that are turned exactly, as the tip is (eq. 19)."""
    g, along = d.g, forms.along
    modal = [ZERO] * forms.beam.modes
    for xi, share in along.shares(torque) if at is None else [(at, along.lower(torque))]:
        angles = forms.angles(xi)
        (cP, sP), (cT, sT) = ((g.call("cos", x), g.call("sin", x)) for x in (form.value() for form in angles[:2]))
        axes = Vec3.unit(g, 2), Vec3(g, -sP, cP, ZERO), Vec3(g, g.mul(cP, cT), g.mul(sP, cT), -sT)
        for axis, angle in zip(axes, angles, strict=True):
            moment = g.mul(share, axis.dot(d))
            modal = [g.add(x, g.mul(part.value(), moment)) for x, part in zip(modal, angle.gradient, strict=True)]
    return modal
