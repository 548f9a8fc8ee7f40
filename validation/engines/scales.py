"""The least sizes that a tree gives what is asked of it: no deviation is judged beside smaller numbers.

A function that is nearly zero at some state is so by cancellation, or because a speed is: an error of 5e-16 N beside a
truth of 1e-27 N is none where links weigh kilograms. Speeds and their rates are of order one (`random_state`), so a
size is a product of a mass, a length and, for what weight is part of, the acceleration of gravity, to the powers of the
function's dimension. Entries of one answer have several (force and moment, metre and radian): the smallest of them
counts, so that small trees are judged by their own measure.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from .interface import Tree


class Dimension(NamedTuple):
    """Powers of a function's dimension.

    Attributes:
        functions: Pattern that the beginnings of functions' names fit.
        mass: Power of mass.
        length: Power of length, the one whose size is the smallest among the entries.
        weight: Power of the acceleration of gravity.
    """

    functions: str
    mass: int
    length: int
    weight: int = 0


# The first that fits.
DIMENSIONS = (
    Dimension("mass_matrix_inverse|forward_dynamics|delassus(?!_inverse)|constrained_acceleration|impact|kkt", -1, -2),
    Dimension(
        "bias|gravity|coriolis_forces|inverse_dynamics|joint_wrenches|potential_energy$|constraint_forces|wrench_sens"
        "|passive_forces|actuat.*_forces|mechanical_energy|base_wrench",
        1,
        1,
        1,
    ),
    Dimension(
        "link_acc|link_velocity_prod|mass_centre_(velocity_prod|acc)|relative_acc|accelero|acceleration|angular_acc",
        0,
        0,
        1,
    ),
    Dimension(
        "mass_centre|subtree_cen|static_reg|coordinate_ra|speeds_of|relative|link_(?!reg)|jacobian|veloci|integrate|difference|interpolate|step_|tendon_|actuator_",
        0,
        1,
    ),
    Dimension(
        "constraint_jacobian|constraint_velocity|torque_reg|kinetic_energy_reg|potential_energy_reg|link_reg|squared_dist",
        0,
        2,
    ),
    Dimension("subtree_masses", 1, 0),
    Dimension("sizes|gyroscopes", 0, 0),
    Dimension("", 1, 2),
)


class Sizes(NamedTuple):
    """What a tree consists of.

    Attributes:
        masses: Smallest mass, and the largest or 1 [kg].
        lengths: Largest length or 1: the smaller, and the larger of them [m].
        gravity: Acceleration of gravity, at least 1 [m/s^2].
    """

    masses: tuple[float, float]
    lengths: tuple[float, float]
    gravity: float


@lru_cache(maxsize=64)
def sizes(tree: Tree) -> Sizes:
    """Sizes of a tree; whatever is a length in it counts, radii of gyration included."""
    masses = [link.mass for link in tree.links if link.mass > 0.0]
    lengths = [float(np.linalg.norm(joint.p)) for link in tree.links for joint in link.joints]
    lengths += [float(np.linalg.norm(link.com)) for link in tree.links]
    lengths += [float(np.sqrt(np.abs(np.trace(link.inertia)) / link.mass)) for link in tree.links if link.mass > 0.0]
    largest = max(lengths) or 1.0
    gravity = max(float(np.linalg.norm(tree.gravity)), 1.0)
    return Sizes((min(masses, default=1.0), max((*masses, 1.0))), (min(largest, 1.0), max(largest, 1.0)), gravity)


def size_of(function: str, tree: Tree) -> float:
    """The least size of a function's answers on a tree, in its unit."""
    row = next(one for one in DIMENSIONS if re.match(one.functions, function))
    own = sizes(tree)
    mass, length = own.masses[row.mass < 0], own.lengths[row.length < 0]
    return float(mass**row.mass * length**row.length * own.gravity**row.weight)
