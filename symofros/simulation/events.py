"""Events: formulas whose zeros a run looks for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

from symofros.base.arguments import CheckedCalls, check_fields
from symofros.errors import Problem, SymofrosError
from symofros.runtime.model import Model
from symofros.runtime.record import ModelRecord

# Of friction by the size of its mode, where 0 is smooth; of a rigid contact.
FRICTION_WORDS = ("slides", "slides", "sticks")
CONTACT_WORDS = ("opens", "slides", "sticks")
_SIGNS = {"both": 0, "rising": 1, "falling": -1}


@dataclass(frozen=True)
class Event(metaclass=CheckedCalls):
    """A zero crossing.

    Attributes:
        formula: Formula of coordinates, speeds, inputs, parameters and t: text or SymPy expression. Also of the
            multipliers of constraints ("lam.grasp.x"), their wrenches on the second frame in world axes
            ("wrench.grasp.fx" to ".mz") and the wrenches that joints transmit to their bodies in body axes
            ("reaction.q1.fx").
        direction: Direction of the crossings that count.
        terminal: Whether the first one ends the run.
        name: Its key in the mapping that it stands in.
        action: What happens at each crossing that counts: run-time parameter or speed ("grip", "dq1") -> number, or
            formula of the state before. Then the speeds meet the constraints that hold, by a plastic impact
            (docs/theory/constraints.md, section 13). `simulate`, `simulate_batch`, steppers, packages of C and FMUs do
            them.
        once: Whether only the first crossing counts.
        restitution: Newton's coefficient e, 0 to 1, of an action that lets constraints strike: they hold for the
            instant alone, and what they take of the speeds comes back e times; parameters are then as before. With 0
            the run ends there unless forces part the bodies again, or `rests` is given.
        rests: Force of the constraint that strikes, as a formula that is above zero where the bodies press:
            "lam.floor.z". Where strikes accumulate, and after one without rebound, the contact then persists, and opens
            where the force falls to zero, an event of its own, "NAME opens" (docs/theory/constraints.md, 13).
    """

    formula: Any
    direction: Literal["both", "rising", "falling"] = "both"
    terminal: bool = False
    name: str = ""
    action: Mapping[str, Any] | None = None
    once: bool = False
    restitution: float | None = None
    rests: Any = None

    def __post_init__(self) -> None:
        """The direction must be known, restitution a share, and have an action."""
        check_fields(self)
        if self.restitution is not None and not (self.action and 0.0 <= self.restitution <= 1.0):
            found = f"restitution = {self.restitution}, action = {self.action!r:.60}"
            rule = "restitution is a number from 0 to 1, of an action that engages what strikes"
            raise SymofrosError(Problem("event: no restitution", found, rule, "action={'contact': 1}, restitution=0.8"))
        if self.rests is not None:
            self._check_contact()

    def _check_contact(self) -> None:
        """What comes to rest is one contact, that one parameter engages, and has a direction."""
        values = list((self.action or {}).values())
        fits = len(values) == 1 and isinstance(values[0], (int, float)) and values[0] == 1
        if self.restitution is None or self.direction == "both" or self.once or self.terminal or not fits:
            found = f"direction = '{self.direction}', action = {self.action!r:.60}, restitution = {self.restitution}"
            rule = "a contact that rests is engaged by one parameter set to 1, again and again, from one side"
            remedy = "Event('gap', 'falling', action={'contact': 1}, restitution=0.5, rests='lam.floor.z')"
            raise SymofrosError(Problem("event: no contact that rests", found, rule, remedy))

    @property
    def sign(self) -> int:
        """1 rising, -1 falling, 0 both."""
        return _SIGNS[self.direction]

    @property
    def coefficient(self) -> float:
        """The restitution, as C has it: below zero where constraints that engage are to hold."""
        return -1.0 if self.restitution is None else self.restitution

    @property
    def cut(self) -> int:
        """What a crossing does, as sym_system's event_terminal has it at first.

        1: it ends the run; 2: the integration, until the action is done; 0: neither; -2: neither, and counts once.
        """
        return 1 if self.terminal else 2 if self.acts else -2 * self.once

    @property
    def acts(self) -> bool:
        """Whether something happens at a crossing."""
        return bool(self.action)


@dataclass(frozen=True)
class ModeEvent(Event):
    """The end of a mode of friction that sticks, or of a rigid contact (docs/theory/constraints.md, 14 and 15).

    Attributes:
        mode: Run-time parameter that is the mode.
        words: What has begun, by the mode afterwards.
    """

    mode: int = 0
    words: tuple[str, ...] = ()

    @property
    def acts(self) -> bool:
        """True: modes are chosen anew."""
        return True

    @property
    def of_contact(self) -> bool:
        """Whether the mode is that of a rigid contact's ball."""
        return self.words == CONTACT_WORDS

    def said(self, before: Any, after: Any, *, impulse: bool = True) -> str:
        """What it came to, by the parameters (npar) before and afterwards, and by whether speeds have changed."""
        ended, begun = (self.words[round(abs(par[self.mode]))] for par in (before, after))
        unchanged = {"opens": "strikes" if impulse else "grazes", "slides": "turns"} if self.of_contact else {}
        return f"{self.name} {unchanged.get(begun, begun) if begun == ended else begun}"


def event_notes(run: Any, events: Sequence[Event]) -> tuple[str, ...]:
    """Notes on events that a run could not decide: the first of each kind.

    Args:
        run: The sym_run.
        events: Its events.
    """
    notes = []
    if run.touched_event >= 0:
        notes.append(undecided_note(events[run.touched_event].name, run.touched_t))
    if run.unresolved_event >= 0:
        notes.append(unresolved_note(events[run.unresolved_event].name, run.unresolved_t))
    return tuple(notes)


def undecided_note(name: str, t: float) -> str:
    """Note on an event that may get to zero at t [s], or not."""
    return f"event '{name}' turns at t = {t:.6g} s so near to zero that the steps cannot tell whether it gets there"


def unresolved_note(name: str, t: float) -> str:
    """Note on an event that was not followed in the step from t [s] on."""
    return (
        f"event '{name}' changes too often in the step from t = {t:.6g} s on to be followed: zeros may be missing;"
        " take shorter steps"
    )


def events_of(model: Model, given: Mapping[str, Any] | None) -> tuple[Event, ...]:
    """The events of a run: a user's by name, then the ends of modes of a model's friction and rigid contacts."""
    return (*named_events(given), *mode_events(model.record))


def mode_events(record: ModelRecord) -> tuple[ModeEvent, ...]:
    """The ends of modes of a model's friction that sticks, and of its rigid contacts, two a ball."""
    stated = [(one.watch, one.name, one.mode, FRICTION_WORDS) for one in record.sticking]
    stated += [(watch, one.name, one.mode, CONTACT_WORDS) for one in record.rigid_contacts for watch in one.watched]
    return tuple(ModeEvent(watch, "falling", name=name, mode=mode, words=words) for watch, name, mode, words in stated)


def named_events(given: Mapping[str, Any] | None) -> tuple[Event, ...]:
    """Events by name; a bare formula is an event in both directions that ends nothing.

    Behind one of a contact that rests there is that of its opening. While the contact holds, the strike's formula is
    away from zero by one, as that of the opening is while it does not.
    """
    named: list[Event] = []
    for name, event in (given or {}).items():
        one = replace(event if isinstance(event, Event) else Event(event), name=name)
        if one.rests is None:
            named.append(one)
            continue
        (held,) = one.action or {}
        formula = f"({one.formula}) {'-' if one.sign > 0 else '+'} {held}"
        opening = Event(f"({one.rests}) + 1 - {held}", "falling", name=f"{name} opens", action={held: 0})
        named += [replace(one, formula=formula), opening]
    return tuple(named)


def opens_of(events: Sequence[Event]) -> list[int]:
    """Index of the event at which the contact of each one opens; -1: of none."""
    return [-1 if event.rests is None else i + 1 for i, event in enumerate(events)]
