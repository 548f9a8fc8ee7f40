"""One number a speed to move a configuration by: coordinates as they are, orientations as rotation vectors."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.model import Model


class Slider(NamedTuple):
    """What moves one degree of freedom.

    Attributes:
        label: The coordinate's name; of a rotation vector, joint.turn_x and so on.
        speed: Name of its speed.
        low: Least value [rad or m].
        high: Largest value.
        elastic: Whether it bends a beam.
        unit: Unit of the value; "" where it is not known.
    """

    label: str
    speed: str
    low: float
    high: float
    elastic: bool
    unit: str


def sliders_of(
    model: Model, elastic: tuple[bool, ...], units: Mapping[str, str] = MappingProxyType({})
) -> tuple[Slider, ...]:
    """One slider a speed, in their order.

    Args:
        model: Model that moves.
        elastic: Mask of the elastic coordinates (nq).
        units: Unit of each coordinate that has one.
    """
    bounds = model.record.sampling_bounds()
    sliders: list[Slider] = []
    for segment in model.record.segments:
        along = segment.translations
        for i in range(along):
            at = segment.q + i
            low, high = (float(f"{bound:.3g}") for bound in bounds[at])  # For people to read.
            name, speed = model.names.q[at], model.names.v[segment.v + i]
            sliders.append(Slider(name, speed, low, high, elastic[at], units.get(name, "")))
        if segment.kind != "linear":
            for i, axis in enumerate("xyz", start=segment.v + along):
                joint = model.names.v[i].rpartition(".")[0]
                sliders.append(Slider(f"{joint}.turn_{axis}", model.names.v[i], -3.14, 3.14, False, "rad"))
    return tuple(sliders)


def values_of(model: Model, q: Array) -> Array:
    """Values of the sliders (nv) at a configuration q (nq)."""
    values = model.difference(model.neutral(), q)
    for segment in model.record.segments:
        along = segment.translations
        values[segment.v : segment.v + along] = q[segment.q : segment.q + along]
    return values


def coordinates_of(model: Model, values: Array) -> Array:
    """The configuration (nq) of sliders' values (nv)."""
    steps = np.array(values, dtype=np.float64)
    for segment in model.record.segments:
        if segment.kind == "pose":
            steps[segment.v : segment.v + 3] = 0.0
    q = model.integrate(model.neutral(), steps)
    for segment in model.record.segments:
        along = segment.translations
        q[segment.q : segment.q + along] = values[segment.v : segment.v + along]
    return q
