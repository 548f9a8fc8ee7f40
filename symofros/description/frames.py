"""Frame: a named place on a body."""

from __future__ import annotations

from dataclasses import dataclass

from symofros.description.values import IDENTITY, ORIGIN, Rotation, Vector, as_vector


@dataclass(frozen=True)
class Frame:
    """An extremity frame E fixed on a body B.

    Attributes:
        name: Unique on its body.
        position: p_BE, from Bo to Eo, in B [m].
        rotation: R_BE.
    """

    name: str
    position: Vector = ORIGIN
    rotation: Rotation = IDENTITY

    def __post_init__(self) -> None:
        """Convert the position."""
        object.__setattr__(self, "position", as_vector(self.position, f"frame '{self.name}': position"))
