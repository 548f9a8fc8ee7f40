"""Material: what an isotropic elastic material brings to a section."""

from __future__ import annotations

from dataclasses import dataclass, fields

from symofros.description.entries import refuses_unknown_entries
from symofros.description.values import Value, as_value


@refuses_unknown_entries
@dataclass(frozen=True)
class Material:
    """An isotropic elastic material.

    Attributes:
        E: Young's modulus [N/m^2].
        G: Shear modulus [N/m^2].
        rho: Density [kg/m^3].
    """

    E: Value
    G: Value
    rho: Value

    def __post_init__(self) -> None:
        """Convert the numbers."""
        for item in fields(self):
            object.__setattr__(self, item.name, as_value(getattr(self, item.name), f"material: {item.name}"))
