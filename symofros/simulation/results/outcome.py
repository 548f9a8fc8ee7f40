"""How a run ended: when, where, why, and what to try."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

Kind = Literal[
    "finished",
    "event",
    "interrupted",
    "diverged",
    "singular",
    "step too small",
    "input failed",
    "not converged",
    "constraints lost",
    "beyond theory",
]


@dataclass(frozen=True)
class Outcome:
    """How a run ended.

    Attributes:
        kind: "finished" at the end asked for, "event" at a terminal one, or what went wrong.
        t: Time of the end [s].
        reason: One sentence.
        advice: Remedy to try; empty where nothing is wrong.
        notes: Remarks on what was met without ending the run, such as a singular posture.
        failure: Exception that a function of the user's raised, with its traceback; None where none did.
    """

    kind: Kind
    t: float
    reason: str
    advice: str = ""
    notes: tuple[str, ...] = ()
    failure: BaseException | None = field(default=None, compare=False)

    @property
    def ok(self) -> bool:
        """Whether the run came to its end, or to an event that was meant to end it."""
        return self.kind in ("finished", "event")

    def as_data(self) -> dict[str, Any]:
        """The outcome as plain data, for JSON."""
        named = {name: getattr(self, name) for name in ("kind", "t", "reason", "advice")}
        return {**named, "notes": list(self.notes)}

    def __str__(self) -> str:
        """Human-readable summary: how and when the run ended, advice, and notes."""
        lines = [f"{self.kind} at t = {self.t:.6g} s: {self.reason}"]
        lines += [f"  try: {self.advice}"] if self.advice else []
        return "\n".join([*lines, *(f"  note: {note}" for note in self.notes)])
