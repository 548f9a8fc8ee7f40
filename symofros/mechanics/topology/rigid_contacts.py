"""Rigid contacts: modes of balls on surfaces, and what holds them (docs/theory/constraints.md, section 15).

A mode is a run-time parameter, "foot.mode": 0 is open, what it is unless a run sets it, 1 slides and 2 sticks. In
modes 1 and 2 the condition "foot.normal" keeps the ball on the surface, in mode 2 "foot.across.x" and ".y" its point
of contact from slipping; their multipliers are the forces on the ball along the axes of contact: those of a plane, else
two tangents and the normal. The parameters "foot.push_x" to ".push_z" are a further force along these axes, by which a
run adds sliding friction, and "foot.way_x", ".way_y" and ".way_speed" the direction in which the ball has begun to
slide, and its speed then; "foot.apart" is how far a ball that has grazed the surface may pass it by rounding. Where the
surface is no plane "foot.pole", 1 or -1, is the end of its z axis from which the tangents are turned to where the ball
is.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

from symofros.description.constraints import AXES, Switch, Touching
from symofros.description.contacts import Contact
from symofros.description.system import Parameter, System
from symofros.description.values import Term, Value
from symofros.errors import Problem
from symofros.expr.expression import Expression
from symofros.mechanics.topology.sticking import sticking_coordinates

# Speed [m/s] against the direction of sliding at which a ball has come to rest: below any that matters,
# above the rounding of one that has just begun to slide.
_REST = 1e-14
# Quantities of a ball in formulas, "contact.foot.gap": its distance from the surface, the velocity of its material
# point against the surface's along the axes of contact, the z component of the normal in the axes of the surface, and
# the sine of the angle of a rim or segment with what it would touch along a line, or near zero where two points touch.
QUANTITIES = ("gap", "vx", "vy", "vz", "nz", "sine")
# Least cosine between normal and pole, less than which the pole is taken anew: 120 degrees.
_POLE_LEAST = -0.5
# That sine at which a mode ends. Runs end there: SYM_FLAT of native code is larger.
_FLAT = 0.009


class RigidBall(NamedTuple):
    """A ball of a rigid contact.

    Attributes:
        contact: The contact.
        number: Number of the ball in it, from 0.
        name: Name of the ball.
    """

    contact: Contact
    number: int
    name: str

    @property
    def mode(self) -> str:
        """Name of the parameter that is its mode."""
        return f"{self.name}.mode"

    @property
    def pushes(self) -> tuple[str, ...]:
        """Names of the parameters that are a further force, along the axes of contact."""
        return tuple(f"{self.name}.push_{axis}" for axis in AXES)

    @property
    def way(self) -> tuple[str, str, str]:
        """Names of the parameters that are the direction in which it has begun to slide, and its speed then."""
        return f"{self.name}.way_x", f"{self.name}.way_y", f"{self.name}.way_speed"

    @property
    def apart(self) -> str:
        """Name of the parameter that is how far an open ball may pass the surface before it strikes: by rounding."""
        return f"{self.name}.apart"

    @property
    def pole(self) -> str:
        """Name of the parameter that is the sign of the pole, of surfaces but planes."""
        return f"{self.name}.pole"

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The contact's parameters, at what they are unless a run sets them."""
        names = (self.mode, *self.pushes, *self.way, self.apart)
        pole = () if self.contact.surface == "plane" else (Parameter(self.pole, 1.0),)
        return (*(Parameter(name, 0.0) for name in names), *pole)

    @property
    def normal(self) -> Touching:
        """The condition that keeps the ball on the surface."""
        return Touching(f"{self.name}.normal", self.contact, self.number, (2,))

    @property
    def across(self) -> Touching:
        """The conditions that keep its point of contact from slipping."""
        return Touching(f"{self.name}.across", self.contact, self.number, (0, 1))

    @property
    def conditions(self) -> tuple[str, str, str]:
        """Names of the conditions along the axes of contact."""
        x, y = self.across.conditions
        return x, y, self.normal.name

    @property
    def switches(self) -> tuple[Switch, Switch]:
        """When the conditions hold: (39)."""
        m, one = _symbol(self.mode), Term(1.0)
        closed, sticks = m * (Term(3.0) - m) / Term(2.0), m * (m - one) / Term(2.0)
        return Switch(self.normal.name, closed.value), Switch(self.across.name, sticks.value)

    @property
    def watched(self) -> tuple[Value, Value]:
        """What falls to zero where a mode ends, (40): distance or normal force; slip, or what friction has left.

        The latter falls to zero, too, where the normal of a surface that is no plane has come too far from its pole,
        and where a rim or segment comes to touch along a line.
        """
        m, one, two = _symbol(self.mode), Term(1.0), Term(2.0)
        is_open, slides, sticks = (m - one) * (m - two) / two, m * (two - m), m * (m - one) / two
        (vx, vy), (wx, wy) = (_symbol(f"contact.{self.name}.{x}") for x in ("vx", "vy")), map(_symbol, self.way[:2])
        fx, fy, fz = (_symbol(f"lam.{condition}") for condition in self.conditions)
        limit = Term(self.contact.friction) * fz
        ahead = wx * vx + wy * vy + Term(_REST)
        left = limit * limit - fx * fx - fy * fy
        gap = _symbol(f"contact.{self.name}.gap") + _symbol(self.apart)
        across = is_open + slides * ahead + sticks * left
        limits = []
        if self.contact.surface != "plane":
            limits.append(_symbol(self.pole) * _symbol(f"contact.{self.name}.nz") - Term(_POLE_LEAST))
        if self.contact.rim is not None or self.contact.segment is not None:
            sine = _symbol(f"contact.{self.name}.sine")
            limits.append(sine * sine - Term(_FLAT * _FLAT))  # Smooth in a step over zero, which the sine is not.
        for distance in limits:
            across = across * (is_open + (one - is_open) * distance)
        return (is_open * gap + (one - is_open) * fz).value, across.value


def rigid_balls(system: System) -> Iterator[RigidBall]:
    """The balls of all rigid contacts, in order."""
    for contact in system.contacts:
        if contact.rigid:
            for number, name in enumerate(contact.ball_names):
                yield RigidBall(contact, number, name)


def with_rigid_contacts(system: System) -> System:
    """The system with the modes of its rigid contacts, and the constraints that hold their balls."""
    balls = list(rigid_balls(system))
    if not balls:
        return system
    rows: Any = [row for ball in balls for row in (ball.normal, ball.across)]  # Of the generator's own kind.
    return replace(
        system,
        parameters=(*system.parameters, *(parameter for ball in balls for parameter in ball.parameters)),
        constraints=(*system.constraints, *rows),
        switches=(*system.switches, *(switch for ball in balls for switch in ball.switches)),
    )


def rigid_contact_problems(system: System) -> Iterator[Problem]:
    """Rigid contacts beside joints with friction that sticks, whose modes are chosen by another rule."""
    contacts = [contact for contact in system.contacts if contact.rigid]
    for body in system.bodies if contacts else ():
        for coordinate in sticking_coordinates(body.joint) if body.joint is not None else ():
            yield Problem(
                f"contact '{contacts[0].name}' is rigid, and friction of '{coordinate.coordinate}' sticks",
                "modes of two kinds",
                "modes of contacts and of joints are not chosen together",
                "sticks=False at the joint, or a stiffness and bristles for the contact",
                system.origin.get(("connection", contacts[0].name), ""),
            )


def _symbol(name: str) -> Term:
    return Term(Expression("symbol", name=name))
