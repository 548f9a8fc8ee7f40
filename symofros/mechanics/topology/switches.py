"""Constraints that engage and release: their checks, and the poses that they hold (docs/theory/constraints.md, 13).

A constraint that holds the pose of the moment has parameters besides those that are stated: an offset of each condition
on positions, "grip.x.held", and the rotation that a closure turns its second frame by, "grip.held_x" to "grip.held_w",
a quaternion of any length. Zero and no rotation are the stated pose.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from symofros.description.constraints import Closure, Constraint, Switch
from symofros.description.system import Parameter, System
from symofros.description.values import Term
from symofros.errors import Problem, did_you_mean
from symofros.mechanics.topology.conditions import Condition
from symofros.mechanics.topology.numbers import Numbers


def switches_of(system: System) -> dict[str, Switch]:
    """Switch of each constraint that has one, by the constraint's name."""
    return {switch.constraint: switch for switch in system.switches}


def offset_names(constraint: Constraint) -> dict[str, str]:
    """Condition on positions -> parameter that is its offset."""
    turns = {f"{constraint.name}.r{axis}" for axis in getattr(constraint, "rotations", ())}
    free = {*constraint.on_speeds, *turns}
    return {condition: f"{condition}.held" for condition in constraint.conditions if condition not in free}


def rotation_names(constraint: Constraint) -> tuple[str, ...]:
    """Parameters that are the quaternion (x, y, z, w) of a closure's held rotation; none where it blocks none."""
    turns = isinstance(constraint, Closure) and constraint.rotations
    return tuple(f"{constraint.name}.held_{entry}" for entry in "xyzw") if turns else ()


def with_held_poses(system: System) -> System:
    """The system with the parameters of the poses that its constraints hold."""
    switches, held = switches_of(system), list[Parameter]()
    for constraint in system.constraints:
        if constraint.name in switches and switches[constraint.name].pose == "moment":
            held += [Parameter(name, 0.0) for name in offset_names(constraint).values()]
            names = rotation_names(constraint)
            held += [Parameter(name, float(name == names[-1])) for name in names]
    return replace(system, parameters=(*system.parameters, *held)) if held else system


def switch_problems(system: System) -> Iterator[Problem]:
    """Switches of constraints that are not there, that have two, or that have no pose to hold."""
    constraints = {item.name: item for item in system.constraints}
    seen = set[str]()
    for switch in system.switches:
        name, where = switch.constraint, system.origin.get(("switch", switch.constraint), "")
        what = f"switch of '{name}'"
        if name not in constraints:
            found, rule = ", ".join(constraints) or "no constraints", "a switch is of a constraint of the system"
            remedy = did_you_mean(name, constraints) or "state the constraint, or drop the switch"
            yield Problem(f"{what}: no such constraint", found, rule, remedy, where)
        elif name in seen:
            yield Problem(f"{what}: there are two", name, "a constraint has one switch", "keep one", where)
        elif switch.pose == "moment" and not offset_names(constraints[name]) and not rotation_names(constraints[name]):
            rule = "the pose of the moment is held by conditions on positions or rotations"
            yield Problem(f"{what}: has no pose to hold", "conditions on speeds alone", rule, "leave pose out", where)
        seen.add(name)


def switch_conditions(system: System) -> Iterator[Condition]:
    """Conditions that a parameter that engages a constraint is 0 or 1: e (e - 1) >= 0 and e (1 - e) >= 0."""
    for switch in system.switches:
        e, one = Term(switch.engaged), Term(1.0)
        margins = (e * (e - one)).value, (e * (one - e)).value
        yield Condition(margins, "not negative", partial(_between, system, switch))


def _between(system: System, switch: Switch, numbers: Numbers) -> Problem:
    return Problem(
        f"switch of '{switch.constraint}': engaged = {numbers.value(switch.engaged):g}",
        f"'{switch.engaged}'",
        "a constraint holds, 1, or is released, 0",
        "for one that yields, state a Connection: a spring and a damper",
        system.origin.get(("switch", switch.constraint), ""),
    )
