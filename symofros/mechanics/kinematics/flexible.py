"""From a beam's root to its tip or another section: elastic coordinates move it as a joint's coordinates would.

The displacement is that of the second-order field, the rotation is the product of the section's yaw, pitch and roll
(docs/theory/beams.md, eqs. 1-5), so it is a rotation at any deflection.
"""

from __future__ import annotations

from collections.abc import Sequence

from symofros.expr.edges import ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Vec3
from symofros.mechanics.beams.elastic import BeamForms, Vector
from symofros.mechanics.beams.rod import Rod
from symofros.mechanics.kinematics.joint import (
    AcrossJoint,
    JointRotation,
    PartialVelocity,
    across_rotations,
    rotation_about,
    with_rates,
)
from symofros.mechanics.kinematics.rotations import AxisRotation, MatrixRotation, RotationProduct


def across_beam(
    forms: BeamForms, xi: float, q: tuple[Edge, ...], speeds: Sequence[Edge], deformed: bool
) -> AcrossJoint:
    """The motion of a section in the root frame B.

    Args:
        forms: Displacement and rotation of the beam's sections.
        xi: Station x/L of the section.
        q: Elastic coordinates.
        speeds: Rates of the elastic coordinates.
        deformed: Whether the section is where the deflection puts it; otherwise it moves about the undeformed place,
            with partial velocities that are constant.
    """
    g, point = forms.along.g, forms.point(xi)
    if not deformed:
        angles, zero = forms.angles(xi), Vec3(g)
        partials = tuple(_constant_partial(g, point, angles, i, zero) for i in range(len(q)))
        return AcrossJoint(RotationProduct(g, ()), _values(g, point, 0), partials)
    return across_rotations(g, q, speeds, _values(g, point), _turns(forms, xi))


def _turns(forms: BeamForms, xi: float) -> list[JointRotation]:
    """Yaw, pitch and roll of the section at a station, those that are not zero."""
    g = forms.along.g
    return [
        rotation_about(Vec3.unit(g, k), angle, k, False)
        for k, angle in zip((2, 1, 0), (form.value() for form in forms.angles(xi)), strict=True)
        if angle != ZERO
    ]


def turned_section(forms: BeamForms, xi: float) -> RotationProduct:
    """Rotation R_BS of the section at a station, as the product of its yaw, pitch and roll."""
    return RotationProduct(forms.along.g, tuple(turn.factor for turn in _turns(forms, xi)))


def across_rod(rod: Rod, xi: float, speeds: Sequence[Edge]) -> AcrossJoint:
    """The motion of a geometrically exact rod's section in the root frame B (docs/theory/rods.md, section 3).

    Args:
        rod: The rod.
        xi: Station x/L of the section.
        speeds: Rates of the strain coordinates.
    """
    g, section = rod.g, rod.section_at(xi)
    R_BS = section.R_BS
    if rod.axis is None:
        factor: AxisRotation | MatrixRotation = MatrixRotation(R_BS)
    else:
        i, j = (rod.axis + 1) % 3, (rod.axis + 2) % 3
        factor = AxisRotation(rod.axis, R_BS.at(i, i), R_BS.at(j, i))
    R = RotationProduct(g, (factor,))
    partials = tuple(
        with_rates(g, rod.coordinates, speeds, R.apply_inverse(spin), R.apply_inverse(rod.partial_position(xi, i)))
        for i, spin in enumerate(section.spins)
    )
    return AcrossJoint(R, rod.position(xi), partials)


def _values(g: Graph, forms: Vector, upto: float = float("inf")) -> Vec3:
    return Vec3(g, *(form.value(upto) for form in forms))


def _constant_partial(g: Graph, point: Vector, angles: Vector, i: int, zero: Vec3) -> PartialVelocity:
    v = Vec3(g, *(form.gradient[i].value(0) for form in point))
    yaw, pitch, roll = (form.gradient[i].value(0) for form in angles)
    return PartialVelocity(Vec3(g, roll, pitch, yaw), v, zero, zero)
