"""The native file's constraints as pydantic models."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import ConfigDict, Field, model_validator

from symofros.description.constraints import (
    AXES,
    AxisName,
    Closure,
    KnifeEdge,
    Nonholonomic,
    Rod,
    Rolling,
)
from symofros.description.yaml.fields import Entry, Formula, Name, fault
from symofros.description.yaml.schema_forces import AnchorEntry
from symofros.errors import Problem

Directions = Annotated[list[AxisName], Field(max_length=3)]


class ClosureEntry(Entry):
    """Two frames that stay together in some directions, or at a distance."""

    first: AnchorEntry
    """The reference: directions are along its axes."""
    second: AnchorEntry
    translations: Directions | None = None
    """Blocked directions; all three if not given."""
    rotations: Directions | None = None
    """Blocked rotations; none if not given."""
    length: Formula | None = None
    """Of a massless rod between the frames' origins [m]; then no directions are blocked."""

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        if self.length is not None and (self.translations or self.rotations):
            rule = "a rod keeps a distance; a closure blocks directions"
            raise fault(Problem("both a rod and a closure", "length with translations or rotations", rule, "keep one"))
        if self.length is None and self.translations == [] and not self.rotations:
            raise fault(
                Problem(
                    "blocks nothing",
                    "no directions",
                    "a closure blocks at least one direction",
                    "name translations, rotations or both",
                )
            )
        return self

    def build(self, name: str) -> Closure | Rod:
        """The Closure or the Rod of that name."""
        first, second = ((anchor.body, anchor.frame) for anchor in (self.first, self.second))
        if self.length is not None:
            return Rod(name, first, second, self.length)
        blocked = AXES if self.translations is None else tuple(self.translations)
        return Closure(name, first, second, blocked, tuple(self.rotations or ()))


class KnifeEdgeEntry(AnchorEntry):
    """A frame whose origin does not move along one of its axes."""

    axis: AxisName = "y"


class RollingEntry(AnchorEntry):
    """A disc or sphere that rolls on a horizontal plane; the frame is at its centre, a disc's axis is z."""

    radius: Formula
    shape: Literal["disc", "sphere"] = "disc"
    height: Formula = 0.0
    """Of the plane [m]."""


class NonholonomicEntry(Entry):
    """A condition on speeds: exactly one of a knife edge, a rolling contact, coefficients by formula."""

    model_config = ConfigDict(json_schema_extra={"minProperties": 1})

    knife_edge: KnifeEdgeEntry | None = None
    rolling: RollingEntry | None = None
    coefficients: Annotated[dict[Name, Formula], Field(min_length=1, max_length=1000)] | None = None
    """Speed (`dq1`) -> coefficient, by formula of coordinates, parameters and t."""
    right: Formula | None = None
    """What the sum of coefficient times speed equals; 0 if not given."""

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        kinds = [key for key in ("knife_edge", "rolling", "coefficients") if getattr(self, key) is not None]
        if len(kinds) != 1 or (self.right is not None and kinds != ["coefficients"]):
            rule = "exactly one of knife_edge, rolling, coefficients; right goes with coefficients"
            raise fault(Problem("not exactly one kind of condition", ", ".join(kinds) or "none", rule, "keep one"))
        return self

    def build(self, name: str) -> KnifeEdge | Rolling | Nonholonomic:
        """The constraint of that name."""
        if self.knife_edge is not None:
            edge = self.knife_edge
            return KnifeEdge(name, (edge.body, edge.frame), edge.axis)
        if self.rolling is not None:
            wheel = self.rolling
            return Rolling(name, (wheel.body, wheel.frame), wheel.radius, wheel.shape, wheel.height)
        pairs = tuple((self.coefficients or {}).items())
        return Nonholonomic(name, pairs, 0.0 if self.right is None else self.right)
