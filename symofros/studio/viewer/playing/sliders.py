"""One number a speed to move a configuration by: coordinates as they are, orientations as rotation vectors."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from symofros.runtime.model import Model
from symofros.studio.viewer.drawing.meshes import Array


class Slider(NamedTuple):
    """What moves one degree of freedom.

    Attributes:
        label: The coordinate's name; of a rotation vector, joint.turn_x and so on.
        speed: Name of its speed.
        low: Least value [rad or m].
        high: Largest value.
        elastic: Whether it bends a beam.
    """

    label: str
    speed: str
    low: float
    high: float
    elastic: bool


def sliders_of(model: Model, elastic: tuple[bool, ...]) -> tuple[Slider, ...]:
    """One slider a speed, in their order.

    Args:
        model: Model that moves.
        elastic: Mask of the elastic coordinates (nq).
    """
    bounds = model.record.sampling_bounds()
    sliders: list[Slider] = []
    for segment in model.record.segments:
        along = segment.translations
        for i in range(along):
            low, high = (float(f"{bound:.3g}") for bound in bounds[segment.q + i])  # For people to read.
            sliders.append(
                Slider(model.names.q[segment.q + i], model.names.v[segment.v + i], low, high, elastic[segment.q + i])
            )
        if segment.kind != "linear":
            for i, axis in enumerate("xyz", start=segment.v + along):
                joint = model.names.v[i].rpartition(".")[0]
                sliders.append(Slider(f"{joint}.turn_{axis}", model.names.v[i], -3.14, 3.14, False))
    return tuple(sliders)


def values_of(model: Model, q: Array) -> Array:
    """Where the sliders of a configuration (nq) stand (nv)."""
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
