"""What is compared, in which unit, and how close is close enough."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

# Products and sums of a few hundred doubles (eps = 2.2e-16) in another order differ by some 1e-14 of the largest
# entry; Pinocchio and MuJoCo themselves differ by up to 1.1e-14 on humanoids. Two digits are left for longer trees.
# Any wrong term shows at 1e-6 or more, so nothing hides below.
ROUNDING = 1e-12

# Solving M a = f amplifies rounding by up to cond(M), which is 1e5 and more for robots with light fingers. The
# condition found is reported beside the error.
SOLVE = 1e-9

# Rounding errors are those of the terms that are summed. Where the sum happens to be small, they are judged against
# this fraction of what the quantity typically is, not against its own vanishing size.
SMALL = 1e-2

# What keeps the scale of a quantity away from zero; see `compare.floor`.
Floor = Literal["none", "inertia_force", "energy", "unit"]


@dataclass(frozen=True)
class Quantity:
    """One thing that engines are compared by.

    Attributes:
        name: The `Engine` method that gives it.
        symbol: For people.
        unit: For people.
        tolerance: Of the error relative to the largest entry.
        axes: How many trailing axes make one value: 2 for a matrix a state, 1 for a vector, 0 for a number.
        floor: What its scale is kept above where it vanishes.
        at_rest: Whether it is asked for with v = 0.
    """

    name: str
    symbol: str
    unit: str
    tolerance: float
    axes: int
    floor: Floor = "none"
    at_rest: bool = False

    @property
    def method(self) -> str:
        """The `Engine` method that computes it."""
        return "bias" if self.at_rest else self.name


QUANTITIES: dict[str, Quantity] = {
    quantity.name: quantity
    for quantity in (
        Quantity("mass_matrix", "M", "kg m^2, kg m, kg", ROUNDING, 2),
        Quantity("bias", "h", "N m, N", ROUNDING, 1, "inertia_force"),
        Quantity("gravity", "h(q, 0)", "N m, N", ROUNDING, 1, "inertia_force", at_rest=True),
        Quantity("kinetic_energy", "T", "J", ROUNDING, 0),
        Quantity("potential_energy", "V", "J", ROUNDING, 0, "energy"),
        Quantity("inverse_dynamics", "M a + h - Q", "N m, N", ROUNDING, 1, "inertia_force"),
        Quantity("forward_dynamics", "v'", "rad/s^2, m/s^2", SOLVE, 1, "unit"),
        Quantity("frame_pose", "p, R", "m, 1", ROUNDING, 1),
        Quantity("frame_velocity", "v, w", "m/s, rad/s", ROUNDING, 1),
        Quantity("frame_acceleration", "a, alpha", "m/s^2, rad/s^2", ROUNDING, 1),
        Quantity("frame_jacobian", "J", "m, 1", ROUNDING, 2),
        Quantity("frame_jacobian_rate", "J'", "m/s, 1/s", ROUNDING, 2),
        Quantity("motion_energy", "T + V along a free motion", "J", ROUNDING, 0),
        Quantity("generalized_force", "Q", "N m, N", ROUNDING, 1, "unit"),
    )
}
