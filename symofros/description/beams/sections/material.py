"""Material: what an isotropic elastic material brings to a section; what sizes a section may have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields

from symofros.description.entries import refuses_unknown_entries
from symofros.description.values import Value, as_value
from symofros.errors import DescriptionError
from symofros.expr.expression import Expression

# In place of a beam without mass.
SPRING = (
    "a beam has mass all along, as each of its shape functions moves; state a small one, such as a per cent of what it"
    " carries, which lowers the lowest frequency by about 0.1 %, or rigid bodies and joints with springs"
)
# E/G where Poisson's ratio is 1/2; beyond by rounding counts as there.
_LARGEST_RATIO = 3.0 * (1.0 + 1e-9)


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
        """Convert the numbers, and check those that are none of parameters."""
        for item in fields(self):
            object.__setattr__(self, item.name, as_value(getattr(self, item.name), f"material: {item.name}"))
        refuse_sizes("material", {"E": self.E, "G": self.G})
        if not isinstance(self.rho, Expression) and not self.rho > 0.0:
            raise DescriptionError(f"material: rho = {self.rho:g}", f"{self.rho:g}", "rho is positive", SPRING)
        E, G = self.E, self.G
        if isinstance(E, float) and isinstance(G, float) and E / G > _LARGEST_RATIO:
            raise DescriptionError(
                "material: E and G are those of no isotropic material",
                f"E = {E:g}, G = {G:g}: Poisson's ratio E/2G - 1 is {E / (2.0 * G) - 1.0:.3g}",
                "Poisson's ratio is at most 1/2",
                "mend a modulus; of a material with a grain, state EI_y, EI_z, GJ of the beam",
            )


def refuse_sizes(what: str, sizes: Mapping[str, Value], bound: tuple[str, float] | None = None) -> None:
    """Refuse numbers that are not positive; formulas are judged by what follows from them.

    Args:
        what: What has them, for the error.
        sizes: Numbers or formulas, by name.
        bound: Name of a thickness, and the largest that it may be.

    Raises:
        DescriptionError: One is zero or negative, or the thickness is above its bound.
    """
    for name, size in sizes.items():
        if not isinstance(size, Expression) and not size > 0.0:
            raise DescriptionError(f"{what}: {name} = {size:g}", f"{size:g}", f"{name} is positive", "mend it")
    if bound is not None:
        name, most = bound
        thickness = sizes[name]
        if not isinstance(thickness, Expression) and thickness > most:
            rule = f"{name} is at most {most:g}, which fills the section"
            raise DescriptionError(f"{what}: {name} = {thickness:g}", f"{thickness:g}", rule, "mend a size")
