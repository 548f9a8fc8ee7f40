"""Frame: a named place on a body."""

from __future__ import annotations

from dataclasses import dataclass

from symofros.description.entries import refuses_unknown_entries
from symofros.description.values import IDENTITY, ORIGIN, Rotation, Vector, as_vector


@refuses_unknown_entries
@dataclass(frozen=True)
class Frame:
    """An extremity frame E fixed on a body B.

    Attributes:
        name: Name, unique on its body.
        position: Position p_BE of the frame's origin, in the body frame [m].
        rotation: Rotation R_BE from the body frame to this one.
    """

    name: str
    position: Vector = ORIGIN
    rotation: Rotation = IDENTITY

    def __post_init__(self) -> None:
        """Convert the position."""
        object.__setattr__(self, "position", as_vector(self.position, f"frame '{self.name}': position"))
