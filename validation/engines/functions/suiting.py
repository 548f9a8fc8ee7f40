"""All functions by name, and which of them a tree is for."""

from __future__ import annotations

import re

from ..tree import Tree
from ..truth.features.connectors import CONNECTORS
from ..truth.geometry.attitudes import ATTITUDES
from ..truth.spaceflight.guidance import GUIDANCE
from ..truth.spaceflight.orbits import ORBITS
from ..truth.spaceflight.parts import PARTS
from ..truth.spaceflight.spacecraft import SPACECRAFT
from .acting import ACTING, MEASURED
from .algebra import ALGEBRA
from .arms import ARMS
from .beside import LONE, TURNS
from .carried import CARRIED
from .constrained import CONSTRAINED
from .devices import DEVICES
from .features import FEATURES
from .function import Function, functions_of
from .integrators import STEPS
from .poses import POSES
from .shapes import SHAPES
from .stated import STATED
from .trees import TREES
from .vectors import VECTORS

FUNCTIONS: dict[str, Function] = (
    TREES
    | CARRIED
    | CONSTRAINED
    | LONE
    | STEPS
    | ACTING
    | MEASURED
    | STATED
    | TURNS
    | POSES
    | ALGEBRA
    | SHAPES
    | ARMS
    | FEATURES
    | VECTORS
    | DEVICES
)
FUNCTIONS |= functions_of(ATTITUDES | ORBITS | GUIDANCE | PARTS | CONNECTORS, "turns") | functions_of(
    SPACECRAFT, "spacecraft"
)
# Of "turns", what depends on the rotations R and Q: the others have no part in `Tree.beside`.
_OF_ROTATIONS = re.compile(
    "rotation_(matrix(?!_rate)|composed|angle|logarithm|inverse|halfway|difference|squared|to_rpy|vector_rates_along)"
    "|pose_(aligned|composed|inverse|relative|logarithm|difference|halfway|squared)|quaternion_rates"
)
_ACTED_ON = ("mass_matrix", "forward_dynamics", "forward_dynamics_dq", "forward_dynamics_dv", "potential_energy")
_SENSED = ("joint_wrenches", "link_accelerations", "subtree_momenta")
# Formulas in which actuators have no states that change within a step, or whose step is another than `interface.STEP`.
_STATELESS = re.compile("step_(midpoint|rk.*|trapezoidal)|.*_(dq|dv|derivative)")
# Formulas that take forces at the end of a step; those of a medium are no line.
_LINEAR = re.compile("step_(forces|velocities|stiffness).*|.*_(dq|dv|derivative)")
# What is asked of a tree with constraints besides, for identities; and if it has sensors.
_BESIDES = ("mass_matrix", "bias")
_SENSED_BOUND = ("wrench_sensors:bound",)


def suits(way: str, tree: Tree) -> bool:
    """Whether a way to a function is for a tree: of constraints and of forces only where it has some."""
    name = way.partition(":")[0]
    needs = FUNCTIONS[name].needs
    if tree.asked:
        return tree.asked in needs and (not tree.beside or bool(_OF_ROTATIONS.match(name)))
    if way in _SENSED_BOUND:
        return bool(tree.constraints and tree.sensors)
    if tree.constraints:
        return way in _BESIDES or (name in CONSTRAINED and (not needs or bool(tree.demands & set(needs))))
    if "activations" in tree.forces and _STATELESS.fullmatch(name):
        return False
    if tree.medium and _LINEAR.fullmatch(name):
        return False
    if needs:
        return bool(tree.demands & set(needs))
    if tree.sensors:
        return name in _SENSED
    return name in STEPS or name in _ACTED_ON if tree.forces else name not in CONSTRAINED
