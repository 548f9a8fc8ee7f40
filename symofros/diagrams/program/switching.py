"""Events of mechanisms in a diagram: what is located, what acts, what of the parameters is memory then.

One mechanism's events are those of `sf.simulate` (docs/theory/diagrams.md, section 6). Those of all mechanisms become one
table of the part that moves them, which native/stepping/actions.c executes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

from symofros.diagrams.block import Block, EvaluationContext, Terms
from symofros.diagrams.tensor import Tensor
from symofros.errors import DescriptionError, Problem, SymofrosError
from symofros.runtime.record import ModelRecord, StickingRecord, SwitchRecord
from symofros.simulation.actions import Assignment, StatedActions
from symofros.simulation.events import Event, ModeEvent, mode_events, named_events

if TYPE_CHECKING:
    from symofros.diagrams.program.layout import Layout, Part
    from symofros.diagrams.program.lowered_block import Piece
    from symofros.diagrams.program.model_environment import Models


@dataclass(frozen=True)
class Switching:
    """The events of one block's mechanism.

    Attributes:
        record: Names, switches and friction that sticks, of the mechanism.
        events: Its events, ends of modes last.
        stated: What they do, in the mechanism's own numbers.
        values: What falls or rises through zero, of each event (n).
        effects: Values of the formulas of `stated`.
        poses: Frame -> p and R of it, of those whose relative rotation is held.
        kept: Run-time parameters of the mechanism that events change, by number.
    """

    record: ModelRecord
    events: tuple[Event, ...]
    stated: StatedActions
    values: Tensor
    effects: Tensor
    poses: Mapping[str, tuple[Tensor, Tensor]]
    kept: tuple[int, ...]

    @property
    def groups_of_effects(self) -> tuple[Tensor, Tensor, Tensor]:
        """What says whether constraints hold; what is assigned; the most that friction takes at rest."""
        first = len(self.record.switches)
        last = first + len(self.stated.assignments)
        return self.effects[:first], self.effects[first:last], self.effects[last:]


def switching_of(models: Models, block: Block, at: EvaluationContext, terms: Terms) -> Switching | None:
    """The events of a block's mechanism; None where there are none.

    Args:
        models: Models of the diagram.
        block: The block.
        at: Where its formulas are written; accelerations of a mechanism without constraints are known there.
        terms: Terms of its motion.

    Raises:
        DescriptionError: An event can't be located, or its action done.
    """
    model = block.mechanism()
    record = models.record(model) if model else None
    if record is None or not (block.mechanism_events() or record.sticking):
        return None
    if block.lock_inputs():
        raise DescriptionError(_said_twice(block, record))
    events = (*named_events(block.mechanism_events()), *mode_events(record))
    try:
        stated = StatedActions.of(record, events)
    except SymofrosError as error:
        raise DescriptionError(_of_block(block, error)) from None
    u = at.inputs["u"]
    given = {"q": at.q, "v": at.v, "u": u, "t": at.t, "a": at.a, "lam": at.lam}
    formulas = _Formulas(models, model, block, at, given)
    values = formulas.values([(f"event '{event.name}'", event.formula) for event in events], reactions=True)
    named = [f"event '{event.name}', what its action sets '{to}' to" for event in events for to in event.action or {}]
    first = [f"switch of '{switch.name}'" for switch in record.switches]
    last = [f"friction of '{one.name}'" for one in record.sticking]
    effects = formulas.values(list(zip((*first, *named, *last), stated.formulas, strict=True)), reactions=False)
    poses = {}
    for frame in dict.fromkeys(frame for switch in record.switches if switch.rotation for frame in switch.frames):
        pose = at.call(model, "frame_pose", frame, q=at.q, u=u, t=at.t)
        poses[frame] = pose["p"], pose["R"]
    kept = {of.entry for of in stated.assignments if of.group == "par"} | {one.mode for one in record.sticking}
    for switch in record.switches:
        kept |= {*switch.rotation, *(place for _, place in switch.offsets)}
    return Switching(record, events, stated, values, effects, poses, tuple(sorted(kept)))


def _said_twice(block: Block, record: ModelRecord) -> Problem:
    """Whether constraints hold is said by an input and by what has modes of its own."""
    found = "events" if block.mechanism_events() else f"friction of '{record.sticking[0].name}' sticks"
    rule = "which constraints hold is said by an input of the block, or by events and modes of its mechanism"
    remedy = "state the constraints as switches (sf.Switch) that events act on, in place of `engaged`"
    return Problem(f"block '{block.name}': engaged constraints beside events", found, rule, remedy)


def _of_block(block: Block, error: SymofrosError, of: str = "") -> list[Problem]:
    """What is wrong, said of a block."""
    where = f"block '{block.name}'{f', {of}' if of else ''}"
    return [replace(problem, what=f"{where}: {problem.what}") for problem in error.problems]


class _Formulas(NamedTuple):
    """Formulas over a mechanism's names, in the graph of its block."""

    models: Models
    model: str
    block: Block
    at: EvaluationContext
    given: Mapping[str, Tensor]

    def values(self, named: Sequence[tuple[str, Any]], *, reactions: bool) -> Tensor:
        """Their values (n).

        Raises:
            DescriptionError: One is no formula of the mechanism; says whose.
        """
        try:
            return self._written([formula for _, formula in named], reactions)
        except SymofrosError as error:
            raise next(self._wrong(named, reactions), DescriptionError(error.problems)) from None

    def _written(self, formulas: Sequence[Any], reactions: bool) -> Tensor:
        return self.models.formulas(self.at.g, self.model, formulas, reactions, **self.given)

    def _wrong(self, named: Sequence[tuple[str, Any]], reactions: bool) -> Iterator[DescriptionError]:
        for name, formula in named:
            try:
                self._written([formula], reactions)
            except SymofrosError as error:
                yield DescriptionError(_of_block(self.block, error, name))


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
        frames: Frames whose poses are asked for, (block, frame).
    """

    events: tuple[Event, ...]
    owners: tuple[Owner, ...]
    stated: StatedActions
    switches: tuple[SwitchRecord, ...]
    sticking: tuple[StickingRecord, ...]
    frames: tuple[tuple[str, str], ...]

    def owner(self, which: int) -> Owner | None:
        """Whose an event is; None of a crossing of a block."""
        first = len(self.events) - len(self.owners)
        return self.owners[which - first] if which >= first else None


def owners_of(pieces: Mapping[str, Piece], part: Part) -> tuple[Owner, ...]:
    """The events of the mechanisms of a part, ends of modes last."""
    every = [
        (Owner(name, i), isinstance(event, ModeEvent))
        for name in part.blocks
        for i, event in enumerate(_events(pieces[name]))
    ]
    return tuple(owner for wanted in (False, True) for owner, is_mode in every if is_mode == wanted)


def _events(piece: Piece) -> tuple[Event, ...]:
    return piece.switching.events if piece.switching is not None else ()


def part_switching(
    pieces: Mapping[str, Piece], layout: Layout, part: Part, crossings: Sequence[Event]
) -> PartSwitching | None:
    """The events of a part's mechanisms; None where they have none.

    Args:
        pieces: Blocks of the diagram.
        layout: Layout of its vectors.
        part: The part.
        crossings: Crossings of all blocks.
    """
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
        is_mode = isinstance(renamed, ModeEvent)
        events.append(replace(renamed, mode=places[name].par(renamed.mode)) if is_mode else renamed)  # type: ignore
    switches, sticking = list[SwitchRecord](), list[StickingRecord]()
    frames: dict[tuple[str, str], None] = {}
    for name, at in places.items():
        switching = pieces[name].switching
        assert switching is not None
        for of in switching.stated.assignments:
            entry = at.par(of.entry) if of.group == "par" else at.v + of.entry
            assignments.append(Assignment(numbers[Owner(name, of.event)], of.group, entry))
        switches += [at.switch(switch) for switch in switching.record.switches]
        sticking += [at.sticking(one) for one in switching.record.sticking]
        frames |= dict.fromkeys((name, frame) for frame in switching.poses)
    first_mode = sum(not isinstance(event, ModeEvent) for event in events)
    stated = StatedActions(tuple(assignments), (), first_mode)
    return PartSwitching(tuple(events), owners, stated, tuple(switches), tuple(sticking), tuple(frames))


class _Places(NamedTuple):
    """Where what belongs to a block's mechanism lies in a part.

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
        return cls(name, q, v, layout.lam[name].start - part.conditions.start, (kept.index, kept.par.start))

    def par(self, index: int) -> int:
        """A parameter of the mechanism that is kept, among the diagram's."""
        entries, first = self.kept
        return first + entries.index(index)

    def switch(self, of: SwitchRecord) -> SwitchRecord:
        """A switch, in the part's numbers."""
        offsets = tuple((self.row + row, self.par(place)) for row, place in of.offsets)
        rotation, frames = tuple(map(self.par, of.rotation)), tuple(f"{self.block}.{frame}" for frame in of.frames)
        return of._replace(name=f"{self.block}.{of.name}", offsets=offsets, rotation=rotation, frames=frames)

    def sticking(self, of: StickingRecord) -> StickingRecord:
        """A coordinate with friction that sticks, in the part's numbers."""
        name, q, v = f"{self.block}.{of.name}", self.q + of.q, self.v + of.v
        return of._replace(name=name, q=q, v=v, mode=self.par(of.mode), row=self.row + of.row)
