"""The native file's forces as pydantic models: joint elements, rotors, loads, connections."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import ConfigDict, Field, model_validator

from symofros.description.forces import Connection, Damper, Friction, JointElement, Load, Rotor, Spring, Stop
from symofros.description.yaml.fields import Entry, Formula, Name, Three, fault, three
from symofros.errors import Problem

Coordinate = Annotated[int, Field(ge=0, le=5)]


class SpringEntry(Entry):
    """F = -(stiffness x + cubic x^3), x = q - rest."""

    stiffness: Formula
    rest: Formula = 0.0
    cubic: Formula = 0.0
    coordinate: Coordinate = 0
    """Which coordinate of the joint, from 0."""

    def build(self) -> Spring:
        """The Spring."""
        return Spring(self.stiffness, self.rest, self.cubic, self.coordinate)


class DamperEntry(Entry):
    """F = -(coefficient v + quadratic v |v|)."""

    coefficient: Formula
    quadratic: Formula = 0.0
    coordinate: Coordinate = 0

    def build(self) -> Damper:
        """The Damper."""
        return Damper(self.coefficient, self.quadratic, self.coordinate)


class StopEntry(Entry):
    """A limit as penalty: a spring, and a damper against motion further out, that act beyond it only."""

    stiffness: Formula
    damping: Formula = 0.0
    lower: Formula | None = None
    upper: Formula | None = None
    coordinate: Coordinate = 0

    def build(self) -> Stop:
        """The Stop."""
        return Stop(self.stiffness, self.damping, self.lower, self.upper, self.coordinate)


class FrictionEntry(Entry):
    """Coulomb, Stribeck and viscous friction, smooth through zero speed."""

    dynamic: Formula
    static: Formula | None = None
    minimum_velocity: Formula = 0.001
    viscous: Formula = 0.0
    stribeck_velocity: Formula | None = None
    coordinate: Coordinate = 0

    def build(self) -> Friction:
        """The Friction."""
        return Friction(
            self.dynamic, self.static, self.minimum_velocity, self.viscous, self.stribeck_velocity, self.coordinate
        )


class ElementEntry(Entry):
    """One element on a joint's coordinate: exactly one of spring, damper, stop, friction."""

    model_config = ConfigDict(json_schema_extra={"minProperties": 1, "maxProperties": 1})

    spring: SpringEntry | None = None
    damper: DamperEntry | None = None
    stop: StopEntry | None = None
    friction: FrictionEntry | None = None

    @property
    def given(self) -> list[SpringEntry | DamperEntry | StopEntry | FrictionEntry]:
        """What is stated."""
        return [entry for entry in (self.spring, self.damper, self.stop, self.friction) if entry is not None]

    @model_validator(mode="after")
    def _one(self) -> Self:
        if len(self.given) != 1:
            rule = "each element is exactly one of spring, damper, stop, friction"
            raise fault(
                Problem("not exactly one element", f"{len(self.given)} of them", rule, "make a list of elements")
            )
        return self

    def build(self) -> JointElement:
        """The element."""
        return self.given[0].build()


class RotorEntry(Entry):
    """A motor's rotor that a joint speed drives."""

    inertia: Formula
    """About the spin axis [kg m^2]."""
    ratio: Formula = 1.0
    """Spin per joint speed."""
    axis: Three | None = None
    """In the carrier's body frame; the joint's own axis if not given."""
    carrier: Name | None = None
    """The body that bears it; the joint's parent if not given."""
    coordinate: Coordinate = 0

    def build(self) -> Rotor:
        """The Rotor."""
        axis = three(self.axis) if self.axis is not None else None
        return Rotor(self.inertia, self.ratio, axis, self.carrier, self.coordinate)


class LoadEntry(Entry):
    """A force and a torque on a body."""

    force: Three = [0.0, 0.0, 0.0]
    """[N]"""
    torque: Three = [0.0, 0.0, 0.0]
    """[N m]"""
    at: Name = "body"
    """`body`, `center_of_mass`, or a frame of the body."""
    axes: Literal["body", "world"] = "body"

    def build(self) -> Load:
        """The Load."""
        return Load(three(self.force), three(self.torque), self.at, self.axes)


class AnchorEntry(Entry):
    """A frame of a body."""

    body: Name
    frame: Name | None = None
    """The body frame if not given."""


class ConnectionEntry(Entry):
    """A spring and damper along the line between two frames."""

    first: AnchorEntry
    second: AnchorEntry
    stiffness: Formula = 0.0
    """[N/m]"""
    length: Formula = 0.0
    """At rest [m]."""
    damping: Formula = 0.0
    """[N s/m]"""

    def build(self, name: str) -> Connection:
        """The Connection of that name."""
        first, second = ((anchor.body, anchor.frame) for anchor in (self.first, self.second))
        return Connection(name, first, second, self.stiffness, self.length, self.damping)
