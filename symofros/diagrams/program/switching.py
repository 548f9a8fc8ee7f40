"""Events of a mechanism in a diagram: what is located, what acts, which of its parameters are memory then.

They are those of `sf.simulate` (docs/theory/diagrams.md, section 9).
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from symofros.base.events import Event, with_stated
from symofros.diagrams.block import Block, EvaluationContext
from symofros.diagrams.program.model_environment import Models
from symofros.diagrams.tensor import Tensor
from symofros.errors import DescriptionError, Problem, SymofrosError
from symofros.runtime.record import ModelRecord
from symofros.simulation.actions import StatedActions
from symofros.simulation.events import mode_events, named_events


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
        contacts: State of each ball of its rigid contacts, one after the other.
        kept: Run-time parameters of the mechanism that events change, by number.
    """

    record: ModelRecord
    events: tuple[Event, ...]
    stated: StatedActions
    values: Tensor
    effects: Tensor
    poses: Mapping[str, tuple[Tensor, Tensor]]
    contacts: Tensor
    kept: tuple[int, ...]

    @property
    def groups_of_effects(self) -> tuple[Tensor, Tensor, Tensor]:
        """What says whether constraints hold; what is assigned; the most that friction takes at rest."""
        first = len(self.record.switches)
        last = first + len(self.stated.assignments)
        return self.effects[:first], self.effects[first:last], self.effects[last:]


def switching_of(models: Models, block: Block, at: EvaluationContext) -> Switching | None:
    """The events of a block's mechanism; None where there are none.

    Args:
        models: Models of the diagram.
        block: The block.
        at: Where its formulas are written; accelerations of a mechanism without constraints are known there.

    Raises:
        DescriptionError: An event can't be located, or its action done.
    """
    model = block.mechanism()
    record = models.carried(model) if model else None
    if record is None:
        return None
    try:
        stated_events = with_stated(record.events, block.mechanism_events())
        events = (*named_events(stated_events), *mode_events(record))
        stated = StatedActions.of(record, events)
    except SymofrosError as error:
        raise DescriptionError(_of_block(block, error)) from None
    if not events:
        return None
    if block.lock_inputs():
        raise DescriptionError(_said_twice(block, record, stated_events))
    u = at.inputs["u"]
    given = {"q": at.q, "v": at.v, "u": u, "t": at.t, "a": at.a, "lam": at.lam}
    formulas = _Formulas(models, model, block, at, given)
    values = formulas.values([(f"event '{event.name}'", event.formula) for event in events], reactions=True)
    named = [f"event '{event.name}', what its action sets '{to}' to" for event in events for to in event.action or {}]
    first = [f"switch of '{switch.name}'" for switch in record.switches]
    last = [f"friction of '{one.name}'" for one in record.sticking]
    effects = formulas.values(list(zip((*first, *named, *last), stated.formulas, strict=True)), reactions=False)
    touching = [(f"contact '{ball.name}'", formula) for ball in record.rigid_contacts for formula in ball.state]
    contacts = formulas.values(touching, reactions=False)
    poses = {}
    for frame in dict.fromkeys(frame for switch in record.switches if switch.rotation for frame in switch.frames):
        pose = at.call(model, "frame_pose", frame, q=at.q, u=u, t=at.t)
        poses[frame] = pose["p"], pose["R"]
    kept = {of.entry for of in stated.assignments if of.group == "par"} | {one.mode for one in record.sticking}
    for switch in record.switches:
        kept |= {*switch.rotation, *(place for _, place in switch.offsets)}
    for ball in record.rigid_contacts:
        kept |= {ball.mode, ball.apart, *ball.pushes, *ball.way} | ({ball.pole} - {-1})
    return Switching(record, events, stated, values, effects, poses, contacts, tuple(sorted(kept)))


def _said_twice(block: Block, record: ModelRecord, events: Collection[str]) -> Problem:
    """Whether constraints hold is said by an input and by what has modes of its own."""
    found = f"events: {', '.join(events)}"
    if not events:
        sticks = record.sticking
        found = (
            f"friction of '{sticks[0].name}' sticks"
            if sticks
            else f"contact of '{record.rigid_contacts[0].name}' is rigid"
        )
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
