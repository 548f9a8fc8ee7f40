"""Formulas of the user's over a mechanism's coordinates, speeds, forces, inputs, parameters and time -> a Program.

Names of forces, which conditions of events use:
`lam.CONDITION` is a multiplier; `wrench.CONSTRAINT.fx` to `.mz` the wrench of a constraint on its second frame, about
that frame's origin in world axes; `reaction.JOINT.fx` to `.mz` the wrench that a joint transmits to its body, about the
joint's point in body axes (docs/theory/constraints.md, section 13, (33)). `contact.BALL.gap` is the distance of a ball
of a contact from its surface, `contact.BALL.vx` to `.vz` the velocity of its material point there against the
surface's, in the axes of the surface, of rigid contacts in the axes of contact, and `contact.BALL.nz` the normal's
component along z of the surface's frame; these follow from coordinates and speeds alone. A coordinate, parameter or
input of such a name is meant first.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from symofros.description.constraints import acts_on_bodies
from symofros.description.values import Value, symbols
from symofros.errors import DescriptionError
from symofros.expr.derivative import directional
from symofros.expr.edges import ONE, Edge
from symofros.expr.program import Function, Output, Program
from symofros.mechanics.dynamics.derivatives.differentiation import by_configuration, by_inputs
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.kinematics.links import TreeKinematics
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


def formula_program(equations: Equations, values: Sequence[tuple[Value, int]], derivatives: bool = True) -> Program:
    """One function, "formulas", of q, v, u and t: the values, and their derivatives by q (along its manifold) and v.

    Where one uses multipliers, wrenches or reactions, it is of a and lam, too.

    Args:
        equations: Equations of the tree, in whose graph the formulas are formed.
        values: Numbers and formulas over its names, and how often each is differentiated by t.
        derivatives: Whether to form those by q and v.

    Raises:
        DescriptionError: One that is differentiated depends on more than t and parameters.
    """
    kinematics = equations.kinematics
    tree, names = kinematics.tree, kinematics.tree.coordinates
    g, nv, n = kinematics.g, len(names.v), len(values)
    used = {name for value, _ in values for name in symbols(value)}
    bind_contacts(equations, used)
    reactions = bind_reactions(equations, used)
    edges = [_rate(kinematics, value, order) for value, order in values]
    outputs = [Output("value", (n,), tuple(edges))]
    if derivatives:
        slopes = {"by_q": by_configuration(kinematics, edges), "by_v": by_inputs(kinematics, edges, "v", nv)}
        outputs += [Output(name, (n, nv), tuple(edge for row in rows for edge in row)) for name, rows in slopes.items()]
    sizes = {"q": len(names.q), "v": nv, "u": len(names.u), "par": len(names.par), "t": 1}
    inputs = ("q", "v", "u", "t", *(("a", "lam") if reactions else ()))
    if reactions:
        sizes |= {"a": nv, "lam": sum(len(item.conditions) for item in tree.system.constraints)}
    return Program(tree.system.name, g, sizes, (Function("formulas", "", inputs, tuple(outputs)),))


def _rate(kinematics: TreeKinematics, value: Value, order: int) -> Edge:
    names, g = kinematics.tree.coordinates, kinematics.g
    moving = {name for name, slot in (*names.symbols.items(), *names.keys.items()) if slot.group in ("q", "v", "u")}
    if order and (used := sorted(symbols(value) & moving)):
        raise DescriptionError(
            f"system '{kinematics.tree.system.name}': a motion that depends on '{used[0]}'",
            f"'{value}'",
            "the rates of a prescribed motion are found for formulas of t and parameters only",
            "give its speeds and their rates as well",
        )
    edge = kinematics.lowering.value(value)
    for _ in range(order):
        edge = directional(g, [edge], {g.input("t", 0): ONE})[0]
    return edge
