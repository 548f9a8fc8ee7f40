"""From a beam's root to its tip: the elastic coordinates move the tip as a joint's coordinates would.

The displacement is that of the second-order field, the rotation is the product of the section's yaw, pitch and roll
(docs/theory/beams.md, eqs. 1-5), so it is a rotation at any deflection.
"""

from __future__ import annotations

from collections.abc import Sequence

from symofros.expr.edges import ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Vec3
from symofros.mechanics.beams.elastic import BeamForms, Vector
from symofros.mechanics.kinematics.joint import AcrossJoint, Column, about, moved
from symofros.mechanics.kinematics.rotations import Turn


def across_beam(forms: BeamForms, q: tuple[Edge, ...], speeds: Sequence[Edge], deformed: bool) -> AcrossJoint:
    """The motion of the tip in the root frame B.

    Args:
        forms: Of the beam.
        q: Its elastic coordinates.
        speeds: Their rates.
        deformed: Whether the tip is where the deflection puts it; otherwise it moves about the undeformed place, with
            partial velocities that are constant.
    """
    g, point, angles = forms.along.g, forms.point(1.0), forms.angles(1.0)
    if not deformed:
        zero = Vec3(g)
        columns = tuple(_constant_column(g, point, angles, i, zero) for i in range(len(q)))
        return AcrossJoint(Turn(g, ()), _values(g, point, 0), columns)
    turns = [
        about(Vec3.unit(g, k), angle, k, False)
        for k, angle in zip((2, 1, 0), (form.value() for form in angles), strict=True)
        if angle != ZERO
    ]
    return moved(g, q, speeds, _values(g, point), turns)


def _values(g: Graph, forms: Vector, upto: float = float("inf")) -> Vec3:
    return Vec3(g, *(form.value(upto) for form in forms))


def _constant_column(g: Graph, point: Vector, angles: Vector, i: int, zero: Vec3) -> Column:
    v = Vec3(g, *(form.gradient[i].value(0) for form in point))
    yaw, pitch, roll = (form.gradient[i].value(0) for form in angles)
    return Column(Vec3(g, roll, pitch, yaw), v, zero, zero)
