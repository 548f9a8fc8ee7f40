"""Frames, named places on bodies, and poses of frames in frames, as readers of files put them together."""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Real
from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.description.entries import refuses_unknown_entries
from symofros.description.values import IDENTITY, ORIGIN, Rotation, Vector, as_vector
from symofros.errors import DescriptionError


@refuses_unknown_entries
@dataclass(frozen=True)
class Frame:
    """An extremity frame E fixed on a body B.

    Attributes:
        name: Name, unique on its body.
        position: Position p_BE of the frame's origin, in the body frame [m].
        rotation: Rotation R_BE from the body frame to this one.
        at: Station x/L of a frame that turns with a section of a beam, from 0 (root) to 1 (tip); the tip if not given.
            A rigid body has no stations.
    """

    name: str
    position: Vector = ORIGIN
    rotation: Rotation = IDENTITY
    at: float | None = None

    def __post_init__(self) -> None:
        """Convert the position, check the station."""
        object.__setattr__(self, "position", as_vector(self.position, f"frame '{self.name}': position"))
        if self.at is not None and not (isinstance(self.at, Real) and 0.0 <= self.at <= 1.0):
            raise DescriptionError(
                f"frame '{self.name}': station off the beam",
                f"at {self.at!r}",
                "at is x/L, from 0 (root) to 1 (tip)",
                "divide the station by the length; leave at out for a frame at the tip",
            )

    @property
    def station(self) -> float:
        """Station x/L on a beam."""
        return 1.0 if self.at is None else self.at


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
