"""Shapes of contacts: their balls, and the solids that push these back."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from symofros.base.arrays import Array
from symofros.description import Contact
from symofros.mechanics.topology import Numbers
from symofros.studio.viewer.drawing.meshes import Mesh, box, cylinder, merged, sphere

# Shares of the mechanism's size: of balls that are points, of the side and the thickness of a plate that stands for a
# plane, and of half a cylinder without end.
_POINT, _PLATE, _THIN, _LONG = 0.008, 0.6, 0.002, 0.5


def balls(contact: Contact, numbers: Numbers, size: float) -> Mesh:
    """The balls of a contact, in its first frame; of rims thin discs, of segments capsules.

    Args:
        contact: The contact.
        numbers: The parameters' values.
        size: Extent of the mechanism [m].
    """
    radius = max(numbers.value(contact.radius), _POINT * size)
    disc = _on_axis(0.5 * radius)
    ball = _drawn_out(radius, numbers.value(contact.segment or 0.0))
    if contact.rim is not None:
        ball = cylinder(-disc, disc, numbers.value(contact.rim))
    return merged([ball.transformed(numbers.values(point), np.eye(3)) for point in contact.points])


def surface(contact: Contact, numbers: Numbers, size: float) -> Mesh | None:
    """The solid of a contact, in its second frame; None where it is around a hollow. Arguments as of `balls`."""
    if contact.inside:
        return None
    return _SOLIDS[contact.surface](contact, numbers, size)


def _plate(_contact: Contact, _numbers: Numbers, size: float) -> Mesh:
    mesh = box(size * np.array([_PLATE, _PLATE, _THIN]))
    return mesh.transformed(np.array([0.0, 0.0, -0.5 * _THIN * size]), np.eye(3))


def _sphere(contact: Contact, numbers: Numbers, _size: float) -> Mesh:
    return sphere(numbers.value(contact.surface_radius or 0.0))


def _cylinder(contact: Contact, numbers: Numbers, size: float) -> Mesh:
    end = _on_axis(_LONG * size)
    return cylinder(-end, end, numbers.value(contact.surface_radius or 0.0))


def _capsule(contact: Contact, numbers: Numbers, _size: float) -> Mesh:
    return _drawn_out(numbers.value(contact.surface_radius or 0.0), numbers.value(contact.length or 0.0))


def _drawn_out(radius: float, length: float) -> Mesh:
    """A ball that is drawn out along z."""
    end = _on_axis(0.5 * length)
    if not length:
        return sphere(radius)
    ends = [sphere(radius).transformed(at, np.eye(3)) for at in (-end, end)]
    return merged([cylinder(-end, end, radius), *ends])


def _box(contact: Contact, numbers: Numbers, _size: float) -> Mesh:
    return box(numbers.values(contact.size))


def _on_axis(z: float) -> Array:
    return np.array([0.0, 0.0, z])


_SOLIDS: dict[str, Callable[[Contact, Numbers, float], Mesh]] = {
    "plane": _plate,
    "sphere": _sphere,
    "cylinder": _cylinder,
    "capsule": _capsule,
    "box": _box,
}
