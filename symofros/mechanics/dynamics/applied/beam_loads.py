"""Loads along beams: their virtual power on root and elastic coordinates (docs/theory/beams.md, 5; rods.md, 5)."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from symofros.description.beam import BeamLoad
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
        for d, force, torque in zip(directions, load.force, load.torque, strict=True):
            if isinstance(beam.forms, Rod):
                one, forces = _on_rod(beam.forms, load.at, d, force, torque)
            else:
                one, forces = _along(beam.forms, load.at, d, force, torque)
            wrench = wrench + Wrench(R_LB.times(one.f), R_LB.times(one.n))
            modal = [g.add(a, b) for a, b in zip(modal, forces, strict=True)]
    return wrench, modal


def _at_station(forms: BeamForms, xi: float, field: Field, weight: Value) -> Form:
    return forms.along.at(field, xi).scaled(forms.along.lower(weight))


def _on_rod(rod: Rod, at: float | None, d: Vec3, force: Value, torque: Value) -> tuple[Wrench, list[Edge]]:
    """One component of a load on a geometrically exact rod, at a station or at every section (18)."""
    g, n = rod.g, len(rod.coordinates)
    wrench, modal = no_wrench(g), [ZERO] * n
    if at is not None:
        stations: tuple[float, ...] = (at,)
        forces: tuple[Edge, ...] = (rod.along.lower(force),)
        torques: tuple[Edge, ...] = (rod.along.lower(torque),)
        sections: tuple[Section, ...] = (rod.section_at(at),)
    else:
        stations, sections = rod.strains.stations[0], rod.sections
        forces, torques = rod.shares(force), rod.shares(torque)
    for xi, section, share, moment in zip(stations, sections, forces, torques, strict=True):
        f, m = d.scaled(share), d.scaled(moment)
        wrench = wrench + Wrench(f, rod.position(xi).cross(f) + m)
        for i in range(n):
            power = g.add(rod.partial_position(xi, i).dot(f), section.spins[i].dot(m))
            modal[i] = g.add(modal[i], power)
    return wrench, modal


def _directions(kinematics: TreeKinematics, frames: FrameKinematics, beam: MovingBeam, load: BeamLoad) -> list[Vec3]:
    """The axes that a load's components are along, in B."""
    if load.axes == "body":
        return [Vec3.unit(kinematics.g, k) for k in range(3)]
    R_WL, R_LB = frames.link_pose(beam.root).R_WF, kinematics.links[beam.root].R_LB
    return [R_LB.T.times(R_WL.row(k)) for k in range(3)]


def _along(forms: BeamForms, at: float | None, d: Vec3, force: Value, torque: Value) -> tuple[Wrench, list[Edge]]:
    """One component of a load along a direction d: the wrench about Bo, and the elastic coordinates' forces."""
    g, shape, order = d.g, forms.shape, forms.order
    weighted: Weighted = partial(_at_station, forms, at) if at is not None else forms.along.integral
    one = unit_field(forms.shape.lengths)
    wrench, modal = no_wrench(g), [ZERO] * forms.beam.modes

    def vector(fields: tuple[Field, ...], weight: Value) -> Vec3:
        return Vec3(g, *(weighted(field, weight).value(order) for field in fields))

    if force != 0.0:
        total = d.scaled(weighted(one, force).value())
        wrench = wrench + Wrench(total, vector(shape.position, force).cross(d))
        for i in range(forms.beam.modes):
            partial_velocity = vector(tuple(field.by(i) for field in shape.position), force)
            modal[i] = g.add(modal[i], partial_velocity.dot(d))
    if torque != 0.0:
        wrench = wrench + Wrench(Vec3(g), d.scaled(weighted(one, torque).value()))
        if order == EVERY_DEGREE:
            turned = _turned(forms, at, d, torque)
        else:
            turned = [vector(turning, torque).dot(d) for turning in shape.turning]
        modal = [g.add(a, b) for a, b in zip(modal, turned, strict=True)]
    return wrench, modal


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
