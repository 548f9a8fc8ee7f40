"""Differences of configurations along their manifold, as `Model.difference` has them."""

from __future__ import annotations

from symofros.blocks.rotations import matrix_of_quaternion, position_of_step, rotation_between
from symofros.diagrams.tensor import Tensor, joined
from symofros.runtime.record import ModelRecord


def difference(record: ModelRecord, q0: Tensor, q1: Tensor) -> Tensor:
    """The step (nv) from q0 (nq) to q1 (nq): rotation vectors of ball and free joints are in body axes."""
    parts = []
    for segment in record.segments:
        first, quaternion = segment.q, slice(segment.q + segment.translations, segment.q + segment.size)
        position = slice(first, first + segment.translations)
        shift = q1[position] - q0[position]
        if segment.kind == "linear":
            parts.append(shift)
            continue
        w = rotation_between(q0[quaternion], q1[quaternion])
        if segment.kind == "pose":
            parts.append(position_of_step(w, matrix_of_quaternion(q0[quaternion]).T @ shift))
        parts.append(w)
    return joined(parts)
