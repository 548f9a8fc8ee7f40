"""A run held against finer steps: all of a short one, windows of a longer one, ever longer parts where errors add up.

docs/theory/simulation.md, section 8; docs/theory/diagrams.md, section 7.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Literal

import numpy as np

from symofros.base.arrays import Array
from symofros.simulation.stepping.resolution import TOLERANCE
from symofros.simulation.stepping.windows import WHOLE, Window, windows

# Steps are halved, or tolerances over a whole run tightened, up to so many times while this share of the tolerance is
# still added; fractions of the step and of the tolerances in words.
HALVINGS, TIGHTENINGS, SETTLED = 4, 2, 0.1
FRACTIONS = ("all", "half", "a quarter", "an eighth", "a sixteenth")
_TIGHTER = ("all", "a hundredth", "a ten-thousandth")
# Power of time with which the change in a window may grow over the run, (17b); parts that show by how much it does grow
# are so many times as long, each; the longest in steps; states that are compared in one, about; the least change.
_GROWTH, _LONGER, _LONGEST, _COMPARED, _LEAST = 2.0, 8.0, 20_000, 256, 1e-300
# Share of TOLERANCE below which what is to come is left at that; of the tolerance, by which a whole run may change.
_SURE, _WHOLE = 0.3, 0.3
# Share of a state that is rounding.
_ROUNDING = 1e-11
# What the change in a window may grow to where external blocks answer to the motion, so that no part is made once more.
_ADDS_UP = 0.3

# Records of a run: t (n), q (n, nq), v (n, nv), and what else is kept.
States = Sequence[Array]
# What is made once more of a run: all of a short one, a window of a longer one, a part from its start; the whole, over
# all that switches, (18g).
Part = Literal["run", "window", "part", "whole"]


@dataclass(frozen=True)
class Changed:
    """Change of a part of a run by finer steps.

    Attributes:
        share: Change of speeds or displacements, relative to those of the run.
        t: Time at which the part begins [s].
        steps: Length of the part, in steps.
        name: Mechanism that they change most, where there are several.
        refinements: Number of times that the steps were refined.
        arrived: Whether finer steps come to the end of the part.
    """

    share: float
    t: float
    steps: int
    name: str = ""
    refinements: int = 1
    arrived: bool = True

    @property
    def size(self) -> float:
        """The change, one that is not a number above all."""
        return self.share if self.share >= 0.0 else math.inf


class HeldRun(ABC):
    """A run, parts of which are held against finer steps.

    Attributes:
        states: Records of the run.
        steps: Number of steps.
    """

    states: States
    steps: int
    longer: ClassVar[float] = _LONGER  # So many times as long is each part that shows what adds up.

    @property
    @abstractmethod
    def h(self) -> float:
        """Step [s]; 0: it adapts, and has its tolerances tightened instead."""

    @property
    def external(self) -> str:
        """External source that can't be evaluated again; "" where there is none."""
        return ""

    @property
    def tolerance(self) -> float:
        """Change that is worth a note."""
        return TOLERANCE

    def tolerance_of(self, part: Part) -> float:
        """Change of a part that is worth a note: of the whole, what it errs by at the end, less than of a window."""
        return self.tolerance * (_WHOLE if part == "whole" else 1.0)

    @abstractmethod
    def coarse(self, window: Window, every: int) -> States | None:
        """The run in a window, every so many of its steps where it has records of them."""

    @abstractmethod
    def fine(self, window: Window, refinements: int, every: int) -> States | None:
        """The same by steps that are refined so many times; None where these do not come to its end."""

    @abstractmethod
    def change(self, coarse: States, fine: States, part: Part) -> tuple[float, str]:
        """The largest change, relative to the size of the motion, and the mechanism that changes so."""

    def halvings(self, part: Part) -> int:
        """Maximum number of refinements."""
        return HALVINGS if self.h and part == "run" else 1

    def jumps(self, fine: States) -> bool:
        """Whether speeds jump, so that half the step may err in the same way as the step."""
        return False

    @property
    def span(self) -> float:
        """Time from the first record to the last [s]."""
        return float(self.states[0][-1] - self.states[0][0])

    @property
    def mean_step(self) -> float:
        """The step, or the mean of steps that adapt [s]."""
        return self.h or self.span / self.steps

    @property
    def length(self) -> int:
        """The span in steps."""
        return max(1, round(self.span / self.mean_step))

    def changed(self, window: Window, part: Part, every: int = 1) -> Changed:
        """Change of a window by finer steps, refined until the change converges to a fraction of the noted size."""
        t = float(self.states[0][window.first])
        worst = Changed(0.0, t, max(1, round((window.t_end - t) / self.mean_step)))
        coarse, before, tolerance = self.coarse(window, every), 0.0, self.tolerance_of(part)
        for k in range(1, 1 + self.halvings(part)):
            fine = self.fine(window, k, every)
            if coarse is None or fine is None:
                return replace(worst, refinements=k, arrived=False)
            share, name = self.change(coarse, fine, part)
            worst = max(worst, replace(worst, share=share, name=name, refinements=k), key=lambda one: one.size)
            settled = abs(share - before) <= SETTLED * tolerance and (k > 1 or not self.jumps(fine))
            if settled or worst.size > tolerance:
                break
            before = share
        return worst

    def may_add_up_to(self, worst: Changed) -> float:
        """Bound of the accumulated change over the run, growing at most with the square of time."""
        return float(worst.share * (self.length / worst.steps) ** _GROWTH)

    def added_up(self, worst: Changed) -> Changed:
        """Accumulated change over the run, from ever longer parts of it from its start, (17b).

        Args:
            worst: The window that finer steps change most.
        """
        if worst.share > self.tolerance or not self.may_add_up_to(worst) > TOLERANCE:
            return worst
        before, t, most = worst, self.states[0], min(self.length, _LONGEST)
        while before.steps < most:
            count = int(min(self.longer * before.steps, most))
            window = Window(0, None, min(float(t[0]) + count * self.mean_step, float(t[-1])))
            changed = self.changed(window, "part", max(1, count // _COMPARED))
            if not changed.arrived or changed.size > self.tolerance:
                return changed
            growth = math.log(max(changed.share, _LEAST) / max(before.share, _LEAST)) / math.log(count / before.steps)
            growth = min(max(growth, 1.0), _GROWTH)  # A part that is shorter than a period may show less.
            if not max(changed.share, worst.share) * (self.length / count) ** growth > _SURE * TOLERANCE:
                break
            before = changed
        return worst


def change_of_states(run: Array, coarse: Array, fine: Array) -> float:
    """Mean difference of a state of a force or a block, relative to half of its range in the run, of the worst.

    Means: where a state jumps, as that of bristles which turn over, an instant earlier or later is no other motion.

    Args:
        run: States at the records of the run (n, k).
        coarse: States in a part of it (m, k).
        fine: The same by finer steps.
    """
    if not coarse.size:
        return 0.0
    with np.errstate(all="ignore"):  # What has exploded overflows.
        far = np.maximum(0.5 * np.ptp(run, axis=0), _ROUNDING * np.abs(run).max(axis=0))
        return float((np.abs(coarse - fine).mean(axis=0) / np.maximum(far, _LEAST)).max())


def finer_steps_note(run: HeldRun) -> str:
    """Note on the change of a run by finer steps; "" where it is small.

    Args:
        run: The run. Where something external answers to the motion, all of it would show nothing of what that makes of
            errors from one call to the next: windows are looked at.
    """
    stepping, cure = (f"steps of {run.h:.4g} s", "a smaller dt") if run.h else ("the tolerances", "tighter tolerances")
    t, short = run.states[0], run.steps <= WHOLE and not run.external
    worst = Changed(0.0, float(t[0]), 1)
    for window in windows(t, run.states[2], run.mean_step, run.steps if short else max(run.steps, WHOLE + 1)):
        changed = run.changed(window, "run" if short else "window")
        if not changed.arrived:
            return other_end_note(run, changed, "" if short else f" from t = {changed.t:.6g} s", stepping, cure)
        worst = max(worst, changed, key=lambda one: one.size)
    if not (short or worst.size > run.tolerance) and run.external:
        if not run.may_add_up_to(worst) > _ADDS_UP:
            return ""
        return (
            f"{stepping} are not held against {finer_words(run, worst)} over all of the run, as '{run.external}' is not"
            f" called again: {worst.steps * run.mean_step:.3g} s of the motion of '{worst.name}' change by"
            f" {100.0 * worst.share:.2g} % (seen at t = {worst.t:.4g} s), which adds up; compare with {cure}"
        )
    if not short:
        worst = run.added_up(worst)
        if not worst.arrived:
            return other_end_note(run, worst, "", stepping, cure)
    if not worst.size > run.tolerance:
        return ""
    of = f" of '{worst.name}'" if worst.name else ""
    seen = "" if short else f" (seen at t = {worst.t:.4g} s)"
    same = ", even where external blocks answer as they did" if run.external else ""
    return (
        f"{stepping} do not determine the motion{of}: {finer_words(run, worst)} changes it by {percent(worst.share)}"
        f"{seen}{same}; {cure}"
    )


def other_end_note(run: HeldRun, changed: Changed, begin: str, stepping: str, cure: str) -> str:
    """Note on finer steps that do not come to the end of a part.

    Args:
        run: The run.
        changed: The part.
        begin: What is said of where it begins.
        stepping: Its steps, in words.
        cure: What to try.
    """
    unlike = f"with {finer_words(run, changed)} it does not come to this end{begin}"
    return f"{stepping} do not show the motion: {unlike}; {cure}"


def finer_words(run: HeldRun, changed: Changed) -> str:
    """The finest steps that a part was held against, in words."""
    return f"{FRACTIONS[changed.refinements]} of that" if run.h else f"{_TIGHTER[changed.refinements]} of them"


def percent(share: float) -> str:
    """A share in words."""
    return f"{100.0 * share:.2g} %" if share < 1.0 else "more than 100 %"
