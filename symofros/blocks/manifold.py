"""Differences of configurations along their manifold, as `Model.difference` has them."""

from __future__ import annotations

from symofros.blocks.rotations import matrix_of_quaternion, position_of_step, quaternion_product, vector_of_quaternion
from symofros.diagrams.tensor import Tensor, joined
from symofros.runtime.record import ModelRecord


def difference(record: ModelRecord, q0: Tensor, q1: Tensor) -> Tensor:
    """The step (nv) from q0 (nq) to q1 (nq): rotation vectors of ball and free joints are in body axes."""
    parts = []
    for kind, i, _, size in record.segments:
        if kind == "linear":
            parts.append(q1[i : i + size] - q0[i : i + size])
            continue
        at = i + 3 if kind == "pose" else i
        turn = vector_of_quaternion(quaternion_product(_conjugate(q0[at : at + 4]), q1[at : at + 4]))
        if kind == "pose":
            shift = matrix_of_quaternion(q0[at : at + 4]).T @ (q1[i : i + 3] - q0[i : i + 3])
            parts.append(position_of_step(turn, shift))
        parts.append(turn)
    return joined(parts)


def _conjugate(quaternion: Tensor) -> Tensor:
    return joined([-quaternion[:3], quaternion[3]])
