"""Actions of events: parameters and speeds that change, constraints that engage (docs/theory/constraints.md, 13).

What is said here compiles into the tables of `native/stepping/events/actions.c`, which every loop of steps executes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.base.events import Event
from symofros.errors import SymofrosError
from symofros.runtime.calls import Kernel
from symofros.runtime.model import Model
from symofros.runtime.record import ModelRecord
from symofros.simulation.events import ModeEvent


class Assignment(NamedTuple):
    """An assignment by one action.

    Attributes:
        event: Index of the event.
        group: "par" or "v".
        entry: Index of the parameter or speed.
    """

    event: int
    group: str
    entry: int


class StatedActions(NamedTuple):
    """Actions of the events of one model, before anything is compiled.

    Attributes:
        assignments: In the order in which they are stated.
        formulas: Of what says whether constraints hold, of the assignments, then of the most that friction takes at
            rest.
        first_mode: The event at which the first mode of friction that sticks ends; those after it are of others.
    """

    assignments: tuple[Assignment, ...]
    formulas: tuple[Any, ...]
    first_mode: int

    @classmethod
    def of(cls, record: ModelRecord, events: Sequence[Event]) -> StatedActions:
        """The actions of events.

        Args:
            record: Names and switches of the model.
            events: All events, ends of modes last.

        Raises:
            UnknownNameError: An action names no run-time parameter or speed.
            SymofrosError: An action sets one thing twice, or the pose that a constraint holds.
        """
        assignments, values, named = list[Assignment](), list[Any](), record.set_by_actions
        for i, event in enumerate(events):
            assignments += [Assignment(i, *place) for place in named.targets(event.name, event.action or {})]
            values += (event.action or {}).values()
        engaged = (switch.engaged for switch in record.switches)
        breakaway = (one.breakaway for one in record.sticking)
        first_mode = sum(not isinstance(event, ModeEvent) for event in events)
        return cls(tuple(assignments), (*engaged, *values, *breakaway), first_mode)


@dataclass(frozen=True)
class Actions:
    """The actions of the events of one run.

    Attributes:
        record: Names and switches of what moves.
        stated: What they do.
        kernel: Its formulas, compiled.
    """

    record: ModelRecord
    stated: StatedActions
    kernel: Kernel

    @property
    def places(self) -> list[tuple[int, int, int, int]]:
        """Rows of sym_assignment: event, whether a speed is set, index of what is set, index of the formula."""
        return places_of(self.record, self.stated)

    def engaging(self, par: Array, par_set: Array, state: tuple[float, Array, Array, Array]) -> tuple[str, ...]:
        """Names of the constraints that engage where parameters par (npar) change to others, at t, q, v, u."""
        switches, (t, q, v, u) = self.record.switches, state
        given = {"t": np.array([t]), "q": q, "v": v, "u": u}
        inputs = [given[group][np.newaxis] for group, _ in self.kernel.signature.inputs]
        before, after = (
            np.asarray(self.kernel.run(1, self.kernel.prepare(values[np.newaxis]), inputs)[0], dtype=float).reshape(-1)
            for values in (par, par_set)
        )
        return tuple(switch.name for i, switch in enumerate(switches) if after[i] > before[i])


def places_of(record: ModelRecord, stated: StatedActions) -> list[tuple[int, int, int, int]]:
    """Rows of sym_assignment, as of `Actions.places`."""
    first = len(record.switches)
    return [(of.event, int(of.group == "v"), of.entry, first + k) for k, of in enumerate(stated.assignments)]


def plan_actions(model: Model, events: Sequence[Event]) -> Actions | None:
    """The actions of a run's events; None where they have none.

    Raises:
        UnknownNameError: An action names no run-time parameter or speed, or a formula no name of the model.
        SymofrosError: An action sets one thing twice, or the pose that a constraint holds.
    """
    if not any(event.acts for event in events):
        return None
    stated = StatedActions.of(model.record, events)
    try:
        kernel = model.formulas(stated.formulas, derivatives=False)
    except SymofrosError as error:
        raise next(_wrong_formulas(model, events), error) from None
    return Actions(model.record, stated, kernel)


def _wrong_formulas(model: Model, events: Sequence[Event]) -> Iterator[SymofrosError]:
    """What is wrong with a formula of an action, said of the event."""
    stated = [(event.name, name, formula) for event in events for name, formula in (event.action or {}).items()]
    for event, name, formula in stated:
        try:
            model.formulas([formula], derivatives=False)
        except SymofrosError as error:
            of = f"event '{event}', what its action sets '{name}' to"
            yield type(error)([replace(problem, what=f"{of}: {problem.what}") for problem in error.problems])


def refuse_actions(events: Sequence[Event], what: str, remedy: str) -> None:
    """Refuse events with actions where these can't be done.

    Raises:
        SymofrosError: One has an action.
    """
    named = [event.name for event in events if event.action]
    if named:
        rule = "an action begins the motion anew in the middle of a run, which one-step methods do"
        raise SymofrosError(f"{what}: event '{named[0]}' has an action", "action", rule, remedy)
