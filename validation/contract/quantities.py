"""What is compared, in which unit, and how close is close enough."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from .interface import TreeEngine

# Sums of some hundred products of doubles (eps = 2.2e-16), done in another order, differ by some 1e-14 of the largest
# entry; two engines that share nothing with us differ from each other by up to 1.1e-14 on humanoids. The rest is
# margin for longer trees. A wrong term shows at 1e-6 or more, so nothing hides below.
ROUNDING = 1e-12

# Solving M v' = f amplifies rounding by up to cond(M), 1e5 and more for a robot with light fingers. The condition
# that was found is reported beside the error.
SOLVE = 1e-9

# Postures are assembled to 1e-12 m; what an engine that closes loops itself measures there is this, of a centimetre.
GAP = 1e-9

# The rounding error of a sum is that of its terms. In a state where the sum happens to be small, it is judged against
# this fraction of what the quantity typically is, not against its own vanishing size.
SMALL = 1e-2

# What keeps a quantity's scale away from zero on a model where it vanishes altogether (a horizontal arm has no
# gravity torque; what the engines then return is rounding of terms that cancel):
#   inertia_force  the force that unit acceleration takes: SMALL times the typical largest entry of M
#   energy         the largest value over all states (its zero is arbitrary), and SMALL times the kinetic energy
#   unit           SMALL of the unit it is measured in
Floor = Literal["none", "inertia_force", "energy", "unit"]


@dataclass(frozen=True)
class Quantity:
    """One thing that engines are compared by.

    Attributes:
        name: Name in tables.
        symbol: Symbol for people.
        unit: Unit for people.
        tolerance: Tolerance of the error relative to the largest entry.
        axes: Number of trailing axes of one value: 2 for a matrix, 1 for a vector, 0 for a number.
        floor: Lower bound of its scale.
        column: Title of the column of tables that it shares; its symbol, if it has one of its own.
        method: The `Engine` method that computes it, if not named like it.
        at_rest: Whether it is computed with v = 0.
    """

    name: str
    symbol: str
    unit: str
    tolerance: float
    axes: int
    floor: Floor = "unit"
    column: str = ""
    method: str = ""
    at_rest: bool = False


QUANTITIES: dict[str, Quantity] = {
    quantity.name: quantity
    for quantity in (
        Quantity("mass_matrix", "M", "kg m², kg m, kg", ROUNDING, 2, "none"),
        Quantity("bias", "h", "N m, N", ROUNDING, 1, "inertia_force"),
        Quantity("gravity", "h(q, 0)", "N m, N", ROUNDING, 1, "inertia_force", "gravity", method="bias", at_rest=True),
        Quantity("generalized_force", "Q", "N m, N", ROUNDING, 1),
        Quantity("kinetic_energy", "T", "J", ROUNDING, 0, "none", "T, V"),
        Quantity("potential_energy", "V", "J", ROUNDING, 0, "energy", "T, V"),
        Quantity("inverse_dynamics", "M a + h - Q", "N m, N", ROUNDING, 1, "inertia_force", "inverse"),
        Quantity("joint_wrenches", "f, n", "N, N m", ROUNDING, 2, "inertia_force", column="wrenches"),
        Quantity("forward_dynamics", "dv/dt", "rad/s², m/s²", SOLVE, 1, column="forward"),
        Quantity("frame_pose", "p, R", "m, 1", ROUNDING, 1, column="poses"),
        Quantity("frame_velocity", "v, w", "m/s, rad/s", ROUNDING, 1, column="twists"),
        Quantity("frame_acceleration", "dv/dt, dw/dt", "m/s², rad/s²", ROUNDING, 1, column="twists"),
        Quantity("frame_jacobian", "J", "m, 1", ROUNDING, 2, column="J, dJ/dt"),
        Quantity("frame_jacobian_rate", "dJ/dt", "m/s, 1/s", ROUNDING, 2, column="J, dJ/dt"),
        Quantity("constraint", "phi", "m, 1", ROUNDING, 1, column="phi, G, gamma"),
        Quantity("constraint_jacobian", "G", "m, 1", ROUNDING, 2, column="phi, G, gamma"),
        Quantity("constraint_bias", "gamma", "m/s², 1/s²", ROUNDING, 1, column="phi, G, gamma"),
        Quantity("closure_gap", "|phi|", "m, 1", GAP, 0, column="phi, G, gamma"),
        Quantity("multipliers", "lam", "N, N m", SOLVE, 1, column="multipliers"),
        Quantity("constraint_force", "Gᵀ lam", "N m, N", SOLVE, 1, "inertia_force", "multipliers"),
        # All frames of a state at once: they move by one solution, whose error is that of its largest entry.
        Quantity(
            "frame_response",
            "dv/dt, dw/dt of a motion under the forces",
            "m/s², rad/s²",
            SOLVE,
            2,
            column="multipliers",
        ),
    )
}

# Energy along a free motion: the states are those of our integration, the energies each engine's own.
MOTION_ENERGY = Quantity("motion_energy", "T + V on a free motion", "J", ROUNDING, 0, "energy", "motion")

FRAME_QUANTITIES = frozenset(name for name in QUANTITIES if name.startswith("frame_"))
FORCES_STATED = frozenset({"generalized_force"})
# Quantities of mechanisms with constraints, at any state.
CONSTRAINED = frozenset({"multipliers", "constraint", "constraint_jacobian", "constraint_bias"})
# What engines that close loops themselves are compared by, at postures where the loops are closed.
LOOPS = frozenset({"constraint_force", "closure_gap", "frame_response"})
# What an engine's own reading of a file is compared by: all of geometry and inertia enters these.
SECOND_ROUTE = frozenset({"mass_matrix", "bias", "gravity", "kinetic_energy", "potential_energy"})
# MJCF also has springs, dampers and sites, and MuJoCo's potential energy counts springs as ours does.
MJCF_ROUTE = SECOND_ROUTE | {"generalized_force", "frame_pose"}


def offered_by(engine: type) -> frozenset[str]:
    """Names of the quantities that a class of engines has methods for."""
    return frozenset(one.name for one in QUANTITIES.values() if hasattr(engine, one.method or one.name))


# What every engine for trees offers; the forces of a description's formulas are known to the description only.
TREE_QUANTITIES = offered_by(TreeEngine)
