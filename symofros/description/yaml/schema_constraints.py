"""The native file's constraints as pydantic models."""

from __future__ import annotations

from typing import Annotated, Any, Self

from pydantic import ConfigDict, Field, model_validator

from symofros.description.constraints import (
    AXES,
    AxisName,
    Closure,
    KnifeEdge,
    Nonholonomic,
    Rod,
    Rolling,
    Switch,
)
from symofros.description.yaml.derived import NounEntry
from symofros.description.yaml.fields import AnchorEntry, Entry, Formula, Name, fault
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
        first, second = self.first.build(), self.second.build()
        if self.length is not None:
            return Rod(name, first, second, self.length)
        blocked = AXES if self.translations is None else tuple(self.translations)
        return Closure(name, first, second, blocked, tuple(self.rotations or ()))


class _AtAnchor(NounEntry):
    """A condition of one frame, whose body and frame stand beside its other entries."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    body: Name
    frame: Name | None = None
    """The body frame if not given."""

    def build(self, **given: Any) -> Any:
        """The noun, with its anchor."""
        values = self.stated() | given
        anchor = values.pop("body"), values.pop("frame")
        return self.noun(anchor=anchor, **values)


class KnifeEdgeEntry(_AtAnchor, noun=KnifeEdge, without=("name", "anchor")):
    pass


class RollingEntry(_AtAnchor, noun=Rolling, without=("name", "anchor")):
    pass


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
        contact = self.knife_edge or self.rolling
        if contact is not None:
            condition: KnifeEdge | Rolling = contact.build(name=name)
            return condition
        pairs = tuple((self.coefficients or {}).items())
        return Nonholonomic(name, pairs, 0.0 if self.right is None else self.right)


class SwitchEntry(NounEntry, noun=Switch, without=("constraint",)):
    pass
