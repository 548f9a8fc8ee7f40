"""Loads along a beam of second order: their virtual power on root and elastic coordinates (docs/theory/beams.md, 5)."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from symofros.description.values import Value
from symofros.expr.edges import ZERO, Edge
from symofros.expr.vector import Vec3
from symofros.mechanics.beams.fields import EVERY_DEGREE, Field, Form, unit_field
from symofros.mechanics.beams.second_order.forms import BeamForms
from symofros.mechanics.spatial.wrench import Wrench, no_wrench

# A field, weighted by a component of a load, at its station or over the length.
Weighted = Callable[[Field, Value], Form]


def _at_station(forms: BeamForms, xi: float, field: Field, weight: Value) -> Form:
    return forms.along.at(field, xi).scaled(forms.along.lower(weight))


def along(forms: BeamForms, at: float | None, d: Vec3, force: Value, torque: Value) -> tuple[Wrench, list[Edge]]:
    """One component of a load along a direction d: the wrench about Bo, and the elastic coordinates' forces."""
    g, shape = d.g, forms.shape
    wrench, modal = wrench_along(forms, at, d, force, torque), [ZERO] * forms.beam.modes
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


def wrench_along(forms: BeamForms, at: float | None, d: Vec3, force: Value, torque: Value) -> Wrench:
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
    g, over = d.g, forms.along
    modal = [ZERO] * forms.beam.modes
    for xi, share in over.shares(torque) if at is None else [(at, over.lower(torque))]:
        angles = forms.angles(xi)
        (cP, sP), (cT, sT) = ((g.call("cos", x), g.call("sin", x)) for x in (form.value() for form in angles[:2]))
        axes = Vec3.unit(g, 2), Vec3(g, -sP, cP, ZERO), Vec3(g, g.mul(cP, cT), g.mul(sP, cT), -sT)
        for axis, angle in zip(axes, angles, strict=True):
            moment = g.mul(share, axis.dot(d))
            modal = [g.add(x, g.mul(part.value(), moment)) for x, part in zip(modal, angle.gradient, strict=True)]
    return modal
