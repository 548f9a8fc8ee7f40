"""Configurations of a model: a valid one, random ones, and moves along their manifold."""

from __future__ import annotations

import numpy as np

from symofros.base.arguments import check_argument
from symofros.runtime import manifold
from symofros.runtime.calls.kernel import Array
from symofros.runtime.functions import ArrayLike, Functions
from symofros.runtime.manifold import at_unit_length, normalized


class ConfigurationFunctions(Functions):
    """Methods of a model about its configuration manifold; arguments as in `Model`."""

    def neutral(self) -> Array:
        """A valid configuration (nq): zeros, and quaternions of no rotation."""
        return np.array(self.record.q_neutral)

    def random_state(self, rng: np.random.Generator) -> tuple[Array, Array]:
        """A random q (nq) on the manifold, within the limits, and v (nv)."""
        check_argument("random_state: rng", rng, np.random.Generator)
        return manifold.random_state(self.record, rng)

    def integrate(self, q: ArrayLike, dq: ArrayLike) -> Array:
        """Move from q (..., nq) along the manifold by dq (..., nv), a velocity times a time."""
        start, record = self._array("q", q, self.nq), self.record
        if record.quaternions:  # Two looks at a dictionary would cost a tenth of a small move.
            start = at_unit_length(record, "q", start)
        return manifold.integrate(record.segments, start, self._array("dq", dq, self.nv))

    def difference(self, q0: ArrayLike, q1: ArrayLike) -> Array:
        """The dq (..., nv) that leads from q0 to q1 (..., nq)."""
        start, end = self._array("q0", q0, self.nq), self._array("q1", q1, self.nq)
        if self.record.quaternions:
            start, end = (at_unit_length(self.record, "q", q, name) for q, name in ((start, "q0"), (end, "q1")))
        return manifold.difference(self.record.segments, start, end)

    def normalized(self, q: ArrayLike) -> Array:
        """The configurations q (..., nq) with each quaternion divided by its length, whatever that is.

        For states that an integrator of one's own, or a file, has left off unit length.

        Raises:
            ShapeError: A quaternion is zero, which is no rotation.
        """
        return normalized(self.record, self._array("q", q, self.nq))
