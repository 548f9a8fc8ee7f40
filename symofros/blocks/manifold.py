"""Differences of configurations along their manifold, as `Model.difference` has them."""

from __future__ import annotations

from symofros.diagrams.tensor import Tensor
from symofros.runtime import manifold
from symofros.runtime.record import ModelRecord


def difference(record: ModelRecord, q0: Tensor, q1: Tensor) -> Tensor:
    """The step (nv) from q0 (nq) to q1 (nq): rotation vectors of ball and free joints are in body axes."""
    return Tensor.of_terms(q0.g, manifold.difference(record.segments, q0.terms, q1.terms))
