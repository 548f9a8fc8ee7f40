"""What is said of constraints that engage while they are not fulfilled (docs/theory/diagrams.md, section 5)."""

from __future__ import annotations

from symofros.native import native_number
from symofros.simulation.results.ends import ENDS
from symofros.simulation.results.outcome import Outcome
from symofros.simulation.settings import CLOSED
from symofros.simulation.stepping.status import Status

# Largest |phi| [m, rad], by weight, that engaging closes by moving bodies; the run ends where it is larger.
ENGAGE_TOLERANCE = native_number("stepping/state/system.c", "SYM_ENGAGE_TOLERANCE")


class EngagedApartError(Exception):
    """Constraints that engage are not fulfilled.

    Args:
        gap: |phi| by weight.
        name: Input that engages one of them.
    """

    def __init__(self, gap: float, name: str) -> None:
        super().__init__(gap, name)
        self.gap, self.name = gap, name


def engaged_apart(t: float, gap: float, name: str, notes: tuple[str, ...] = ()) -> Outcome:
    """The outcome of a run that ends because closing a gap would require moving bodies instantaneously."""
    reason = (
        f"what '{name}' engages is apart: |phi| = {gap:.3g}, above {ENGAGE_TOLERANCE:g}; closing it would move bodies "
        "within an instant, which no force does"
    )
    return ENDS[Status.ENGAGED_APART].outcome(t, notes, reason)


def engaging_notes(t: float, gap: float) -> tuple[str, ...]:
    """A remark on the largest gap that engaging has closed; none where it is rounding."""
    if not gap > CLOSED:
        return ()
    return (
        f"engaging at t = {t:.6g} s closed a gap of |phi| = {gap:.2g} by moving bodies, which no force does: momentum "
        "and energy change by as much",
    )
