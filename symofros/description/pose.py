"""Poses of frames in frames, as readers of files put them together."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array


class Pose(NamedTuple):
    """A frame B in a frame A.

    Attributes:
        p: Position p_AB (3,) [m].
        R: Rotation R_AB (3, 3).
    """

    p: Array
    R: Array

    def __matmul__(self, other: Pose) -> Pose:
        """The pose in A of a frame whose pose in B is given."""
        return Pose(self.p + self.R @ other.p, self.R @ other.R)

    def inverse(self) -> Pose:
        """A in B."""
        return Pose(-(self.R.T @ self.p), self.R.T)


IDENTITY_POSE = Pose(np.zeros(3), np.eye(3))
