"""The box that has a body's mass and moments of inertia: how big a body is, where nothing states its shape."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.description import RigidBody, System
from symofros.mechanics.topology import Numbers, moments_about_center


class InertiaBox(NamedTuple):
    """A uniform box with the inertia of a body.

    Attributes:
        center: p_BC, the mass centre in the body frame (3) [m].
        axes: R_BC, its edges' directions: the principal axes (3, 3).
        edges: Their lengths, the shortest first; zero along a rod or plate, all zero for a point mass (3) [m].
    """

    center: Array
    axes: Array
    edges: Array


def inertia_box(body: RigidBody, numbers: Numbers) -> InertiaBox | None:
    """The box of a body; None where it has no mass.

    A box of edges a, b, c has moments such as m (b^2 + c^2)/12, so a^2 = 6 (I_b + I_c - I_a)/m. Where an inertia that
    no body can have (waiver `nonphysical_inertia`) makes that negative, the edge is zero.
    """
    if body.inertia is None:
        return None
    mass = numbers.value(body.inertia.mass)
    if not mass > 0.0:
        return None
    J = moments_about_center(body, numbers)
    if body.inertia.about == "center_of_mass":
        R = numbers.rotation(body.inertia.rotation)
        J = R @ J @ R.T
    ascending, vectors = np.linalg.eigh((J + J.T) / 2)
    moments, axes = ascending[::-1], vectors[:, ::-1]  # The largest moment first.
    if np.linalg.det(axes) < 0.0:
        axes = axes * np.array([1.0, 1.0, -1.0])
    edges = np.sqrt(np.maximum(6.0 * (moments.sum() - 2.0 * moments) / mass, 0.0))
    return InertiaBox(numbers.values(body.inertia.center_of_mass), axes, edges)


def longest_edges(system: System, numbers: Numbers) -> list[float]:
    """The longest edge of every body's box [m]."""
    boxes = (inertia_box(body, numbers) for body in system.bodies if isinstance(body, RigidBody))
    return [float(box.edges.max()) for box in boxes if box is not None]
