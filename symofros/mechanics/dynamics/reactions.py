"""Multipliers, wrenches of constraints and reactions of joints by the names that conditions of events use.

`lam.CONDITION` is a multiplier; `wrench.CONSTRAINT.fx` to `.mz` the wrench of a constraint on its second frame, about
that frame's origin in world axes; `reaction.JOINT.fx` to `.mz` the wrench that a joint transmits to its body, about the
joint's point in body axes (docs/theory/constraints.md, section 13, (33)). `contact.BALL.gap` is the distance of a ball
of a contact from its surface, `contact.BALL.vx` to `.vz` the velocity of its material point there against the
surface's, in the axes of the surface, of rigid contacts in the axes of contact, and `contact.BALL.nz` the normal's
component along z of the surface's frame; these follow from coordinates and speeds alone. A coordinate, parameter or
input of such a name is meant first.
"""

from __future__ import annotations

from collections.abc import Iterable

from symofros.description.constraints import acts_on_bodies
from symofros.expr.edges import Edge
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.topology.rigid_contacts import QUANTITIES
from symofros.mechanics.topology.tree import ball_names, joint_names
from symofros.mechanics.topology.user_formulas import COMPONENTS, contact_symbols, reaction_symbols


def bind_contacts(equations: Equations, used: Iterable[str]) -> None:
    """Give formulas of a mechanism the edges of the distances and velocities of contacts that they use."""
    tree, lowering = equations.tree, equations.kinematics.lowering
    own, balls = tree.coordinates, ball_names(tree)
    for name in sorted(contact_symbols(tree).intersection(used) - {*own.symbols, *own.keys, *own.constants}):
        ball, quantity = name.removeprefix("contact.").rsplit(".", 1)
        touching = equations.touching_balls[balls.index(ball)]
        values = (touching.gap, *touching.slip, touching.tilt, touching.sine)
        lowering.bind(name, dict(zip(QUANTITIES, values, strict=True))[quantity])


def bind_reactions(equations: Equations, used: Iterable[str]) -> bool:
    """Give formulas of a mechanism the edges of the multipliers, wrenches and reactions that they use.

    Args:
        equations: Equations of the mechanism; their inputs "a" and "lam" are the accelerations and multipliers.
        used: Symbols of the formulas; others than those of reactions are left alone.

    Returns:
        Whether there are any.
    """
    tree, lowering = equations.tree, equations.kinematics.lowering
    own = tree.coordinates
    names = reaction_symbols(tree).intersection(used) - {*own.symbols, *own.keys, *own.constants}
    for name in sorted(names):
        lowering.bind(name, _reaction(equations, name))
    return bool(names)


def _reaction(equations: Equations, name: str) -> Edge:
    group, of = name.split(".", 1)
    system = equations.tree.system
    if group == "lam":
        conditions = [condition for constraint in system.constraints for condition in constraint.conditions]
        return equations.g.input("lam", conditions.index(of))
    of, component = of.rsplit(".", 1)
    column = COMPONENTS.index(component)
    if group == "wrench":
        return equations.wrenches_on_second[acts_on_bodies(system.constraints).index(of)][column]
    return equations.joint_wrenches[joint_names(equations.tree).index(of)][column]
