"""Measures of the rows and columns of G (docs/theory/constraints.md, section 10)."""

from __future__ import annotations

from symofros.base.measures import ANGLE, FORMULA, LENGTH, OTHER, ROTATION, TRANSLATION, Measures
from symofros.description.constraints import BY_FORMULA, Closure, Constraint
from symofros.description.joints.joint import Joint
from symofros.mechanics.topology.coordinates import speed_names
from symofros.mechanics.topology.tree import SpanningTree


def measures_of(tree: SpanningTree) -> Measures:
    """Measures of a tree's constraint Jacobian."""
    group: list[int] = []
    unit: list[int] = []
    for constraint in tree.system.constraints:
        for measure, count in _units(constraint):
            group += [len(group)] * count
            unit += [measure] * count
    speeds = [kind for link in tree.links if not link.joint.prescribed for kind in _speed_kinds(link.joint)]
    speeds += (OTHER,) * len(tree.coordinates.states)
    return Measures(tuple(group), tuple(unit), tuple(speeds))


def _units(constraint: Constraint) -> list[tuple[int, int]]:
    """Unit and number of rows, group by group."""
    if isinstance(constraint, Closure):
        return [(LENGTH, len(constraint.translations)), (ANGLE, len(constraint.rotations))]
    if isinstance(constraint, BY_FORMULA):
        return [(FORMULA, len(constraint.conditions))]
    return [(LENGTH, len(constraint.conditions))]


def _speed_kinds(joint: Joint) -> tuple[int, ...]:
    """Kind of each speed of a joint; those of the user's own joints and of beams are of no certain kind."""
    traits = joint.traits
    if traits.manifold == "pose":
        return (TRANSLATION,) * 3 + (ROTATION,) * 3
    if traits.manifold == "quaternion":
        return (ROTATION,) * 3
    if traits.user_defined:
        return (OTHER,) * len(speed_names(joint))
    return tuple(TRANSLATION if c.measure == "length" else ROTATION for c in traits.coordinates)
