"""The events that a run looks for: a model's, a user's, and the ends of modes of friction and contacts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from symofros.base.events import Event, with_stated
from symofros.runtime.model import Model
from symofros.runtime.record import ModelRecord

# Of friction by the size of its mode, where 0 is smooth; of a rigid contact.
FRICTION_WORDS = ("slides", "slides", "sticks")
CONTACT_WORDS = ("opens", "slides", "sticks")


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
    """The events of a run: the model's and a user's, then the ends of modes of its friction and rigid contacts."""
    return (*named_events(with_stated(model.record.events, given)), *mode_events(model.record))


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
