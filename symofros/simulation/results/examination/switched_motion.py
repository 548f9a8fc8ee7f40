"""A run in which something switches, held as a whole against finer steps: errors go on from one part into the next.

docs/theory/simulation.md, section 8, (18f) to (18i); docs/theory/diagrams.md, section 7.
"""

from __future__ import annotations

import math
from abc import abstractmethod

from symofros.simulation.results.examination.finer_steps import HeldRun, finer_words, other_end_note, percent
from symofros.simulation.stepping.windows import WHOLE, Window

# Refinement by which steps are four times as long. Tolerances are divided, or multiplied, by so much, down to the
# tightest; from the loosest on they are not held against wider ones.
COARSER, _TIGHTER, _TIGHTEST, _LOOSEST = -2, 100.0, 1e-13, 1e-4
# Orders of convergence that are lower than the method's by more are stated, and give the error, where changes are below
# what shows any; from this share of the tolerance on, as half the step changes half of what a run of order one errs by.
_LOST, _SEEN, _DOUBTED, _LEAST = 0.5, 0.5, 0.5, 1.0
# Share of the tolerance by which a coarser run may differ: where forces bend, both may err by more than they differ.
_AGREED = 0.3


class SwitchedMotion(HeldRun):
    """A run in which something may switch, and that is of several parts where it has."""

    parts: int

    @property
    @abstractmethod
    def method_order(self) -> int:
        """Order of the method."""

    @property
    @abstractmethod
    def rtol(self) -> float:
        """Relative bound of the local error, where steps adapt."""

    @property
    @abstractmethod
    def switched(self) -> str:
        """What has switched, in words."""

    @property
    def short(self) -> bool:
        """Whether its parts are short in the mean."""
        return self.steps <= WHOLE * self.parts

    @property
    def window(self) -> Window:
        """All of it."""
        return Window(0, len(self.states[0]) - 1, float(self.states[0][-1]))

    @property
    def tight(self) -> bool:
        """Whether it is held against coarser steps first."""
        return not self.short if self.h else self.rtol < _LOOSEST

    def error(self, share: float, refinements: int, order: float = math.nan) -> float:
        """Error of the run, by its change where steps are refined so many times (18h), by the order if that is seen."""
        return share * self.own_share(refinements, order)

    def own_share(self, refinements: int, order: float = math.nan) -> float:
        """Share of a difference from other steps, refined or coarser, that is the error of its own."""
        if self.h:
            order = max(order, _LEAST) if self.loses(order) else self.method_order
            return 1.0 / abs(1.0 - 2.0 ** (-order * refinements))
        return 1.0 if refinements > 0 else 1.0 / _TIGHTER

    def order(self) -> float:
        """Order of convergence, by what two refinements change one after the other (18i); NaN where none is seen."""
        run, half, quarter = self.coarse(self.window, 1), self.fine(self.window, 1, 1), self.fine(self.window, 2, 1)
        if run is None or half is None or quarter is None:
            return math.nan
        first, second = self.change(run, half, "whole")[0], self.change(half, quarter, "whole")[0]
        return math.log2(first / second) if first > 0.0 and second > 0.0 else math.nan

    def loses(self, order: float) -> bool:
        """Whether an order that is seen is lower than that of the method."""
        return order < self.method_order - _LOST

    def agrees(self) -> bool:
        """Whether a run by coarser steps is the same within a share of the tolerance."""
        run, states = self.coarse(self.window, 1), self.fine(self.window, COARSER, 1)
        return (
            run is not None
            and states is not None
            and self.change(run, states, "whole")[0] <= _AGREED * self.tolerance_of("whole")
        )


def tolerances(rtol: float, atol: float, refinements: int) -> tuple[float, float]:
    """Relative and absolute tolerance of a run by finer steps, or by coarser ones."""
    refined = min(rtol, max(_TIGHTEST, rtol / _TIGHTER**refinements)) if refinements > 0 else rtol * _TIGHTER
    return refined, refined / rtol * atol


def whole_run_note(run: SwitchedMotion) -> tuple[str, int]:
    """Note on what finer steps change of a run as a whole, "" where that is little; the refinement that shows it."""
    if run.tight and run.agrees():
        return "", COARSER
    stepping, cure = (f"steps of {run.h:.4g} s", "a smaller dt") if run.h else ("the tolerances", "tighter tolerances")
    worst, tolerance = run.changed(run.window, "whole"), run.tolerance_of("whole")
    if not worst.arrived:
        return other_end_note(run, worst, f" over {run.switched}", stepping, cure), 1
    doubted = run.method_order > _LEAST and _DOUBTED * tolerance < worst.size < _SEEN
    order = run.order() if run.h and doubted else math.nan
    error = run.error(worst.size, worst.refinements, order)
    if not error > tolerance:
        return "", 1
    of = f" of '{worst.name}'" if worst.name else ""
    lost = f", with the order {max(order, 0.0):.1f} in place of {run.method_order}" if run.loses(order) else ""
    about = f", so that it errs by {'about ' * (error < 1.0)}{percent(error)}" if run.h else ""
    return (
        f"{stepping} do not determine the motion{of} over {run.switched}: {finer_words(run, worst)}"
        f" changes it by {percent(worst.size)}{about}{lost}; {cure}"
    ), 1
