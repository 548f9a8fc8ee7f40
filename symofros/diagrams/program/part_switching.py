"""Events of all mechanisms of a part as one table, which native/stepping/events/actions.c executes.

docs/theory/diagrams.md, section 9.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from symofros.base.events import Event
from symofros.diagrams.program.layout import Layout, Part
from symofros.diagrams.program.lowered_block import Piece
from symofros.runtime.record import RigidContactRecord, StickingRecord, SwitchRecord
from symofros.simulation.actions import Assignment, StatedActions
from symofros.simulation.events import ModeEvent


class CrossingEvent(Event):
    """A crossing of a block, which stops the motion for the block's task."""

    @property
    def cut(self) -> int:
        """The integration ends, the run does not."""
        return 2


class Owner(NamedTuple):
    """Whose an event of a part is: block, number among the events of its mechanism."""

    block: str
    number: int


@dataclass(frozen=True)
class PartSwitching:
    """The events of all mechanisms of a part, as one table.

    Attributes:
        events: Crossings of blocks, events of mechanisms, ends of modes of all.
        owners: Of those that are events of mechanisms, in order.
        stated: What they do, in the part's numbers; its formulas are those of the part's function "actions".
        switches: In the part's numbers.
        sticking: In the part's numbers.
        contacts: Balls of rigid contacts, in the part's numbers.
        frames: Frames whose poses are asked for, (block, frame).
    """

    events: tuple[Event, ...]
    owners: tuple[Owner, ...]
    stated: StatedActions
    switches: tuple[SwitchRecord, ...]
    sticking: tuple[StickingRecord, ...]
    contacts: tuple[RigidContactRecord, ...]
    frames: tuple[tuple[str, str], ...]

    def owner(self, which: int) -> Owner | None:
        """Whose an event is; None of a crossing of a block."""
        first = len(self.events) - len(self.owners)
        return self.owners[which - first] if which >= first else None


def owners_of(pieces: Mapping[str, Piece], part: Part) -> tuple[Owner, ...]:
    """The events of the mechanisms of a part: stated ones, then ends of modes of friction, then those of contacts."""
    every = [(Owner(name, i), event) for name in part.blocks for i, event in enumerate(_events(pieces[name]))]
    return tuple(owner for owner, event in sorted(every, key=lambda one: _rank(one[1])))


def _rank(event: Event) -> int:
    """Place of its kind among the events of a part, as native/stepping/events/actions.c has them."""
    return 0 if not isinstance(event, ModeEvent) else 2 if event.of_contact else 1


def _events(piece: Piece) -> tuple[Event, ...]:
    return piece.switching.events if piece.switching is not None else ()


def part_switching(
    pieces: Mapping[str, Piece], layout: Layout, part: Part, crossings: Sequence[Event]
) -> PartSwitching | None:
    """The events of a part's mechanisms; None where they have none."""
    owners = owners_of(pieces, part)
    if not owners:
        return None
    numbers = {owner: len(crossings) + i for i, owner in enumerate(owners)}
    blocks = [name for name in part.blocks if pieces[name].switching is not None]
    places = {name: _Places.of(layout, part, name) for name in blocks}
    events, assignments = list[Event](crossings), list[Assignment]()
    for name, i in owners:
        event = _events(pieces[name])[i]
        renamed = replace(event, name=f"{name}.{event.name}")
        if isinstance(renamed, ModeEvent):
            renamed = replace(renamed, mode=places[name].par(renamed.mode))
        events.append(renamed)
    switches, sticking, contacts = list[SwitchRecord](), list[StickingRecord](), list[RigidContactRecord]()
    frames: dict[tuple[str, str], None] = {}
    for name, at in places.items():
        switching = pieces[name].switching
        assert switching is not None
        for of in switching.stated.assignments:
            entry = at.par(of.entry) if of.group == "par" else at.v + of.entry
            assignments.append(Assignment(numbers[Owner(name, of.event)], of.group, entry))
        switches += [at.switch(switch) for switch in switching.record.switches]
        sticking += [at.sticking(one) for one in switching.record.sticking]
        contacts += [at.contact(ball) for ball in switching.record.rigid_contacts]
        frames |= dict.fromkeys((name, frame) for frame in switching.poses)
    first_mode = sum(not isinstance(event, ModeEvent) for event in events)
    stated = StatedActions(tuple(assignments), (), first_mode)
    return PartSwitching(
        tuple(events), owners, stated, tuple(switches), tuple(sticking), tuple(contacts), tuple(frames)
    )


class _Places(NamedTuple):
    """Places of the data of a block's mechanism in a part.

    Attributes:
        block: The block.
        q: First index in the part's q, as v in its v, row among its conditions.
        v: As said of q.
        row: As said of q.
        kept: Parameters of the mechanism that are kept, and the first of them among the diagram's parameters.
    """

    block: str
    q: int
    v: int
    row: int
    kept: tuple[tuple[int, ...], int]

    @classmethod
    def of(cls, layout: Layout, part: Part, name: str) -> _Places:
        """The places of a block."""
        kept = layout.kept[name]
        q, v = layout.q[name].start - part.q.start, layout.v[name].start - part.v.start
        return cls(name, q, v, layout.lam[name].start - part.conditions.start, (kept.numbers, kept.par.start))

    def par(self, index: int) -> int:
        """A parameter of the mechanism that is kept, among the diagram's."""
        entries, first = self.kept
        return first + entries.index(index)

    def switch(self, of: SwitchRecord) -> SwitchRecord:
        """A switch, by the part's indices of rows, coordinates and parameters."""
        offsets = tuple((self.row + row, self.par(place)) for row, place in of.offsets)
        rotation, frames = tuple(map(self.par, of.rotation)), tuple(f"{self.block}.{frame}" for frame in of.frames)
        return of._replace(name=f"{self.block}.{of.name}", offsets=offsets, rotation=rotation, frames=frames)

    def sticking(self, of: StickingRecord) -> StickingRecord:
        """A coordinate with friction that sticks, by the part's indices of rows, coordinates and parameters."""
        name, q, v = f"{self.block}.{of.name}", self.q + of.q, self.v + of.v
        return of._replace(name=name, q=q, v=v, mode=self.par(of.mode), row=self.row + of.row)

    def contact(self, of: RigidContactRecord) -> RigidContactRecord:
        """A ball of a rigid contact, by the part's indices of rows, coordinates and parameters."""
        pushes, way = tuple(map(self.par, of.pushes)), tuple(map(self.par, of.way))
        rows, name = tuple(self.row + row for row in of.rows), f"{self.block}.{of.name}"
        apart, pole = self.par(of.apart), -1 if of.pole < 0 else self.par(of.pole)
        return of._replace(name=name, mode=self.par(of.mode), pushes=pushes, way=way, apart=apart, pole=pole, rows=rows)
