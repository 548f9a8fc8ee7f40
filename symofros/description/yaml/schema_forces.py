"""The native file's forces as pydantic models: joint elements, rotors, loads, connections."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Self

from pydantic import ConfigDict, Field, model_validator

from symofros.description.contacts import Contact
from symofros.description.forces import (
    Brake,
    Connection,
    Damper,
    Friction,
    Hysteresis,
    JointElement,
    Load,
    LuGre,
    Rotor,
    Spring,
    Stop,
)
from symofros.description.yaml.derived import NounEntry
from symofros.description.yaml.fields import Formula, PartEntry, Three, fault
from symofros.errors import DescriptionError, Problem

Coordinate = Annotated[int, Field(ge=0, le=5)]


class SpringEntry(NounEntry, noun=Spring):
    coordinate: Coordinate = 0


class DamperEntry(NounEntry, noun=Damper):
    coordinate: Coordinate = 0


class StopEntry(NounEntry, noun=Stop):
    coordinate: Coordinate = 0


class FrictionEntry(NounEntry, noun=Friction):
    coordinate: Coordinate = 0


class BrakeEntry(PartEntry):
    """A brake: friction that sticks, up to a torque at which it slips, while it is engaged."""

    torque: Formula
    """Torque or force at which it slips [N m or N]: number or formula of parameters."""
    engaged: Formula = 1.0
    """Formula of parameters: 1 where the brake is shut, 0 where it is open; what lies between is partly shut."""
    coordinate: Coordinate = 0
    """Index of the speed of the joint, from 0."""

    def build(self) -> Friction:
        """The brake."""
        return Brake(self.torque, self.engaged, self.coordinate)


class LuGreEntry(NounEntry, noun=LuGre, checked=True):
    coordinate: Coordinate = 0


class HysteresisEntry(NounEntry, noun=Hysteresis):
    coordinate: Coordinate = 0


# Elements by what files call them; one that is written goes by its class, a brake as friction that sticks.
ELEMENTS: dict[str, type[NounEntry]] = {
    "spring": SpringEntry,
    "damper": DamperEntry,
    "stop": StopEntry,
    "friction": FrictionEntry,
    "lugre": LuGreEntry,
    "hysteresis": HysteresisEntry,
}
_KINDS = (*ELEMENTS, "brake")


class ElementEntry(PartEntry):
    """One element on a joint's coordinate: exactly one of spring, damper, stop, friction, lugre, hysteresis, brake."""

    model_config = ConfigDict(json_schema_extra={"minProperties": 1, "maxProperties": 1})

    spring: SpringEntry | None = None
    damper: DamperEntry | None = None
    stop: StopEntry | None = None
    friction: FrictionEntry | None = None
    lugre: LuGreEntry | None = None
    hysteresis: HysteresisEntry | None = None
    brake: BrakeEntry | None = None

    @property
    def given(self) -> list[NounEntry | BrakeEntry]:
        """The elements that are stated."""
        return [entry for name in _KINDS if (entry := getattr(self, name)) is not None]

    @model_validator(mode="after")
    def _one(self) -> Self:
        if len(self.given) != 1:
            rule = f"each element is exactly one of {', '.join(_KINDS)}"
            raise fault(
                Problem("not exactly one element", f"{len(self.given)} of them", rule, "make a list of elements")
            )
        return self

    def build(self) -> JointElement:
        """The element."""
        element: JointElement = self.given[0].build()
        return element


class RotorEntry(NounEntry, noun=Rotor):
    coordinate: Coordinate = 0


class LoadEntry(NounEntry, noun=Load):
    pass


class ConnectionEntry(NounEntry, noun=Connection, without=("name",)):
    pass


class ContactEntry(NounEntry, noun=Contact, without=("name",)):
    points: Annotated[list[Three], Field(max_length=1000)] = [[0.0, 0.0, 0.0]]

    @model_validator(mode="after")
    def _possible(self) -> Self:
        try:
            self.build(name="")
        except DescriptionError as error:
            problem = error.problem
            raise fault(replace(problem, what=problem.what.removeprefix("contact '': "))) from None
        return self
