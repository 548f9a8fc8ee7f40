"""Friction that sticks: modes of coordinates, and what holds them (docs/theory/constraints.md, section 14).

A mode is a run-time parameter, "q1.mode": 1 and -1 are sliding forwards and backwards, 2 is held, and 0, what it is
unless a run sets it, the smooth friction of rigid.md, (58). The condition "q1.stuck" binds the rate of the coordinate
to zero while it is held; its multiplier is the force of friction.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from symofros.description.constraints import Nonholonomic, Switch
from symofros.description.forces import Friction, JointElement
from symofros.description.joints.joint import Joint
from symofros.description.system import Parameter, System
from symofros.description.values import Term, Value
from symofros.expr.expression import Expression
from symofros.mechanics.topology.coordinates import coordinate_names, joint_sizes, speed_keys, speed_symbols

# Speed backwards [rad/s or m/s] at which a joint that slides forwards has come to rest: below any that matters, above
# the rounding of one that has just begun to move.
_REST = 1e-14


class StickingCoordinate(NamedTuple):
    """A coordinate with friction that sticks.

    Attributes:
        number: Number among the coordinates of its joint, from 0.
        coordinate: Name of the coordinate.
        speed: What conditions on speeds call its rate.
        key: Symbol of its rate that nothing else has.
        breakaway: Most that its friction takes at rest.
    """

    number: int
    coordinate: str
    speed: str
    key: str
    breakaway: Value

    @property
    def mode(self) -> str:
        """Name of the parameter that is its mode."""
        return f"{self.coordinate}.mode"

    @property
    def condition(self) -> str:
        """Name of the condition that holds it."""
        return f"{self.coordinate}.stuck"

    @property
    def held(self) -> Value:
        """1 where it is held, 0 in other modes: (34)."""
        m = _symbol(self.mode)
        return (m * (m * m - Term(1.0)) / Term(6.0)).value

    @property
    def watch(self) -> Value:
        """What falls to zero where a mode ends: (36)."""
        held, one, m, lam = Term(self.held), Term(1.0), _symbol(self.mode), _symbol(f"lam.{self.condition}")
        left = Term(self.breakaway) * Term(self.breakaway) - lam * lam
        return (held * left + (one - held) * (m * _symbol(self.key) + Term(_REST))).value


def sticks(element: JointElement) -> bool:
    """Whether an element is friction that sticks."""
    return isinstance(element, Friction) and element.sticks


def mode_name(joint: Joint, index: int) -> str:
    """Name of the parameter that is the mode of a coordinate."""
    return f"{coordinate_names(joint)[index]}.mode"


def sticking_coordinates(joint: Joint) -> Iterator[StickingCoordinate]:
    """The coordinates of a joint that have friction which sticks, in order; none of prescribed ones."""
    for k in range(0 if joint.prescribed else joint_sizes(joint)[1]):
        frictions = [one for one in joint.elements if isinstance(one, Friction) and one.sticks and one.coordinate == k]
        if frictions:
            total = Term(frictions[0].breakaway)
            for friction in frictions[1:]:
                total += Term(friction.breakaway)
            names = (coordinate_names(joint)[k], speed_symbols(joint)[k], speed_keys(joint)[k])
            yield StickingCoordinate(k, *names, total.value)


def with_modes(system: System) -> System:
    """The system with the modes of its friction that sticks, and the constraints that hold its coordinates."""
    joints = [body.joint for body in system.bodies if body.joint is not None]
    found = [one for joint in joints for one in sticking_coordinates(joint)]
    if not found:
        return system
    return replace(
        system,
        parameters=(*system.parameters, *(Parameter(one.mode, 0.0) for one in found)),
        constraints=(*system.constraints, *(Nonholonomic(one.condition, ((one.speed, 1.0),)) for one in found)),
        switches=(*system.switches, *(Switch(one.condition, one.held) for one in found)),
    )


def _symbol(name: str) -> Term:
    return Term(Expression("symbol", name=name))
