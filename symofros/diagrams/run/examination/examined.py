"""A run of a diagram as its steps are examined: its records, parts of it made once more, what finer steps change.

docs/theory/diagrams.md, section 7; docs/theory/simulation.md, (17).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.program.compiled import Resolved
from symofros.diagrams.program.layout import Layout
from symofros.runtime.constrained import STILL
from symofros.runtime.manifold import difference, retract
from symofros.runtime.model import Model
from symofros.simulation.results.examination.energy_balance import EXPLODED
from symofros.simulation.results.examination.finer_steps import (
    HALVINGS,
    TIGHTENINGS,
    Part,
    States,
    change_of_states,
    percent,
)
from symofros.simulation.results.examination.paths import Numbers
from symofros.simulation.results.examination.run import MOST_STEPS
from symofros.simulation.results.examination.switched_motion import SwitchedMotion, whole_run_note
from symofros.simulation.stepping.methods import Method
from symofros.simulation.stepping.resolution import TOLERANCE
from symofros.simulation.stepping.windows import Window

# Differences of displacements count by this share: coordinates may be larger than how they change.
_POSITIONS = 3.0
# Share of the tolerance that is allowed where external blocks do not answer to the change.
_UNANSWERED = 0.08
# Share of a step: a record that is nearer to a jump may be from before it or after it.
_AT_JUMP = 1e-3
# A power is a difference of energies over this share of the time between records, or of the time in which the largest
# speed arises where that is shorter.
_MOMENT = 1e-3
# Records whose rates are asked for: fewer than are evaluated by vectors. Steps between records from which on these may
# show a state at one phase alone.
_SOME, _SPARSE = 32, 8.0
# Methods that show whether steps of order 1, and of a higher one, decide rightly at samples; operations that decide.
_DECIDING = "rk4", "dop853"
_DECISIONS = frozenset({"sign", "step", "floor"})


class Repeat(Protocol):
    """Makes a part of a run once more."""

    def __call__(self, first: int, t_end: float, refinements: int, method: str | None = None) -> States | None:
        """The records from record `first` to `t_end`; None where it does not get there.

        Args:
            first: Number of the record from which it goes on.
            t_end: Where it ends [s].
            refinements: How often steps are refined: they are half as long each time, or have a hundredth of the
                tolerances; below zero they are longer, or have wider tolerances.
            method: Stepping method of fixed steps; None: that of the run.
        """


# Records (n, m) of a vector -> its size.
Norm = Callable[[Array], float]


def _largest(rows: Array) -> float:
    """Largest norm of a row."""
    return float(np.sqrt(np.square(rows).sum(axis=1)).max(initial=0.0))


def _mean(rows: Array) -> float:
    """Root mean square of the rows: where speeds jump, an instant earlier or later is no other motion."""
    return float(np.sqrt(np.square(rows).sum(axis=1).mean()))


# Accelerations (n, nv) at some of the records, by number.
Accelerations = Callable[[Numbers], Array]


@dataclass(frozen=True)
class Energies:
    """The energies of the mechanisms of a diagram.

    Attributes:
        resolved: Diagram.
        par: Run-time parameters (npar).
        model_of: Name of a mechanism's description -> a model that has its energies.
    """

    resolved: Resolved
    par: Array
    model_of: Callable[[str], Model]

    def of(self, name: str, states: States) -> tuple[Array, Array]:
        """Kinetic and total energy (n) [J] of a block's mechanism, by the parameters that events have set by then.

        Args:
            name: Block of the mechanism.
            states: States of the diagram: t (n), q (n, nq), v (n, nv), and u (n, nu) where events act.
        """
        (t, q, v), layout, mechanism = states[:3], self.resolved.layout, self.resolved.pieces[name].block.mechanism()
        present = layout.present(self.par, states[3]) if layout.kept else self.par
        model, par = self.model_of(mechanism), layout.parameters_of(name, mechanism, present)
        q, v = (np.ascontiguousarray(x[:, places[name].slice]) for x, places in ((q, layout.q), (v, layout.v)))
        kinetic = model.kinetic_energy(q, v, par=par)
        return kinetic, kinetic + model.potential_energy(q, par=par, t=t, z=model.states_of(v))

    def powers(self, name: str, states: States, a: Array) -> Array:
        """Power of all forces without a potential (n) [W]: the rate of the energy along the motion.

        Args:
            name: Block of the mechanism.
            states: States of the diagram, as of `of`.
            a: Accelerations (n, nv).
        """
        (t, q, v), at = states[:3], self.resolved.layout.v[name].slice
        fastest = np.linalg.norm(v[:, at], axis=1).max(initial=0.0)
        pace = fastest / np.maximum(np.linalg.norm(a[:, at], axis=1), 1e-300)
        moment = _MOMENT * np.minimum(pace, np.diff(t).max())
        ends = []
        for s in (moment, -moment):
            q_s = retract(self.resolved.layout.segments, q, s[:, np.newaxis] * v)
            ends.append(self.of(name, [t + s, q_s, v + s[:, np.newaxis] * a, *states[3:]])[1])
        return np.asarray((ends[0] - ends[1]) / np.maximum(2.0 * moment, 1e-300))


@dataclass(frozen=True)
class Examined(SwitchedMotion):
    """A run that has come to its end.

    Each mechanism is judged by itself, in its own speeds, and so are continuous states of each block: those of others
    may be of another size.

    Attributes:
        energies: Energies of its mechanisms.
        states: Records of the run: t (n), q (n, nq), v (n, nv), u (n, nu).
        dt: Step [s]; 0: it adapts.
        method: Stepping method.
        bounds: Relative and absolute bound of the local error of adaptive steps.
        steps: Number of steps.
        repeat: Makes a part of the run once more, from a record to a time, as it was or with finer steps.
        accelerations: Accelerations at records.
        acted: Instants at which events have acted (k) [s], in order; of each the run has records from before and after.
        parts: Number of its parts between crossings and actions of events.
        spacing: Shortest time between two instants, where steps end [s]; 0: it is not held as a whole.
    """

    energies: Energies
    states: States
    dt: float
    method: Method
    bounds: tuple[float, float]
    steps: int
    repeat: Repeat
    accelerations: Accelerations
    acted: Array = field(default_factory=lambda: np.zeros(0))
    parts: int = 1
    spacing: float = 0.0
    longer = math.inf  # A loop through samples amplifies errors by no power of time: no shorter part tells.

    @property
    def h(self) -> float:
        """Step [s]; 0: it adapts."""
        return self.dt

    @property
    def method_order(self) -> int:
        """Order of the method."""
        return self.method.order

    @property
    def rtol(self) -> float:
        """Relative bound of the local error, where steps adapt."""
        return self.bounds[0]

    @property
    def switched(self) -> str:
        """The run's crossings, in words."""
        return {1: "all of the run", 2: "what a crossing does"}.get(self.parts, f"what {self.parts - 1} crossings do")

    @property
    def tight(self) -> bool:
        """Whether it is held against coarser steps first, which no instant forbids."""
        return super().tight and 2.0 * self.mean_step <= self.spacing

    @property
    def layout(self) -> Layout:
        """Layout of the diagram's vectors."""
        return self.energies.resolved.layout

    @cached_property
    def external(self) -> str:
        """The first external block that answers to the motion, one with inputs and outputs; "" where there is none.

        In what is made once more it answers as it did, so that a smaller change counts.
        """
        resolved = self.energies.resolved
        wired, listening = resolved.wired, {block for block, _ in resolved.wired.sources}
        outside = (name for name, piece in resolved.pieces.items() if piece.is_external and wired.ports[name].outputs)
        return next((name for name in outside if name in listening), "")

    @property
    def tolerance(self) -> float:
        """Relative change above which a note is made."""
        return (_UNANSWERED if self.external else 1.0) * TOLERANCE

    @cached_property
    def _jumps(self) -> Numbers:
        """Numbers of the records after which something has jumped."""
        return jumps_at(self.states)

    @cached_property
    def _sizes(self) -> Array:
        """Size of each speed and state in the run (nv): half its range, and what its rate makes of it between records.

        Few records may show a state at one phase alone: then its value counts, too.
        """
        t, v = self.states[0], self.states[2]
        rates = np.abs(self.accelerations(np.unique(np.linspace(0, len(t) - 1, _SOME).astype(int)))).max(axis=0)
        apart = float(t[-1] - t[0]) / max(1, len(t) - 1)
        sizes = np.maximum(0.5 * np.ptp(v, axis=0), rates * apart)
        if apart > _SPARSE * self.mean_step:
            sizes = np.maximum(sizes, np.abs(v).max(axis=0))
        return np.asarray(np.maximum(sizes, STILL))

    @cached_property
    def sides(self) -> tuple[Numbers, Numbers]:
        """The first record and the last one at each instant at which events have acted (k), by number."""
        t = self.states[0]
        return np.searchsorted(t, self.acted, "left"), np.searchsorted(t, self.acted, "right") - 1

    def coarse(self, window: Window, every: int) -> States | None:
        """The window's records; recomputed if the window contains none."""
        t, first = self.states[0], window.first
        last = window.last if window.last is not None else int(np.searchsorted(t, window.t_end, side="right")) - 1
        if last > first:
            return [x[first : last + 1] for x in self.states]
        return self.repeat(first, window.t_end, 0)

    def fine(self, window: Window, refinements: int, every: int) -> States | None:
        """The window's records by steps that are refined so many times; None where these do not get there.

        A window that ends as something jumps is compared up to there: finer steps may jump a little earlier.
        """
        states, jumps = self.repeat(window.first, window.t_end, refinements), self._jumps
        if states is None or window.last is None or window.last not in jumps:
            return states
        within, earlier = np.sum((window.first <= jumps) & (jumps < window.last)), jumps_at(states)
        if len(earlier) <= within:
            return states
        t, *others = (x[: earlier[within] + 1] for x in states)
        return [np.append(t[:-1], window.t_end), *others]

    def halvings(self, part: Part) -> int:
        """Number of halvings: more for windows of fixed steps, which may all err in the same way over a contact."""
        if not self.h:
            return TIGHTENINGS if part == "whole" else 1
        return HALVINGS if part != "part" and (part != "whole" or self.short) else 1

    def jumps(self, fine: States) -> bool:
        """Whether the speed of a mechanism changes by half of its largest from one record to the next."""
        v = fine[2]
        with np.errstate(all="ignore"):
            return any(
                2.0 * _largest(np.diff(v[:, places.slice], axis=0)) > _largest(v[:, places.slice])
                for places in self.layout.v.values()
            )

    def change(self, coarse: States, fine: States, part: Part) -> tuple[float, str]:
        """Relative change of the mechanism, or of the states of the block, that changes most; and its name."""
        run, norm = None if part == "run" else self.states, _mean if part == "part" else _largest
        coarse, fine = at_equal_times(coarse, fine, _AT_JUMP * self.mean_step)
        if part == "whole":
            shares = [(_whole_change(self.layout, name, coarse, fine), name) for name in self.layout.v]
        else:
            shares = [(_change(self.layout, name, run, coarse, fine, norm), name) for name in self.layout.v]
        with np.errstate(all="ignore"):  # What has exploded overflows.
            apart = np.abs(coarse[2] - fine[2]).mean(axis=0) / self._sizes
        shares += [
            (float(apart[place.slice].max(initial=0.0)), name) for (name, _), place in self.layout.states.items()
        ]
        return max(shares, key=lambda one: one[0] if one[0] >= 0.0 else np.inf)


def jumps_at(states: States) -> Numbers:
    """Numbers of the records (k) after which something has jumped: the next is another state at the same time."""
    t, q, v = states[:3]
    moved = (np.diff(q, axis=0) != 0.0).any(axis=1) | (np.diff(v, axis=0) != 0.0).any(axis=1)
    return np.flatnonzero((np.diff(t) == 0.0) & moved)


def before_jump(states: States) -> int:
    """Number of the last record before something jumps after the first time; of the last of all where nothing does."""
    jumped = jumps_at(states)
    later = jumped[states[0][jumped] > states[0][0]]
    return int(later[0]) if len(later) else len(states[0]) - 1


def at_equal_times(coarse: States, fine: States, near: float) -> tuple[States, States]:
    """Records of both at the times that they have in common: crossings are met at times of their own.

    Those within `near` [s] of an instant at which either jumps are left out: one of them may have jumped already.
    """
    t, i, j = np.intersect1d(coarse[0], fine[0], return_indices=True)
    jumped = np.sort(np.concatenate([states[0][jumps_at(states)] for states in (coarse, fine)]))
    after = np.searchsorted(jumped, t)
    ends = np.concatenate([[-np.inf], jumped, [np.inf]])
    apart = np.minimum(t - ends[after], ends[after + 1] - t)
    clear = apart > near
    clear[:1] = True
    return [x[i[clear]] for x in coarse[:3]], [x[j[clear]] for x in fine[:3]]


def whole_note(run: Examined) -> str:
    """Note on what finer steps change of all of a run; "" where that is little, or would take too many steps.

    External blocks that answer to the motion would answer to another one.
    """
    if not run.spacing or run.external or not (run.tight or run.steps <= MOST_STEPS):
        return ""
    return whole_run_note(run)[0] or _decisions_note(run)


def _decisions_note(run: Examined) -> str:
    """Note on a run with samples that a better method changes by the same steps: half of them may decide as wrongly."""
    better = run.method_order > 1
    pieces = (piece for piece in run.energies.resolved.pieces.values() if piece.is_discrete)
    decides = any(not (better and _DECISIONS.isdisjoint(piece.g.op)) for piece in pieces)
    method = _DECIDING[better]  # Errors of an order above 1 become large by jumps alone.
    if not decides or not run.h or run.method.name == method or run.steps > MOST_STEPS:
        return ""
    states, exact = run.coarse(run.window, 1), run.repeat(0, run.window.t_end, 0, method)
    share, name = run.change(states, exact, "whole") if states is not None and exact is not None else (0.0, "")
    if not share > run.tolerance_of("whole"):
        return ""
    return (
        f"steps of {run.h:.4g} s do not determine the motion of '{name}': their error changes what is decided at a"
        f" sample, and '{method}' with the same steps changes it by {percent(share)};"
        f" method='{method}', or a smaller dt"
    )


def _whole_change(layout: Layout, block: str, coarse: States, fine: States) -> float:
    """Difference of a mechanism's displacements at any instant, of speeds at the end and in the mean (18g)."""
    moved = layout.moved(block)[1]
    at, of_forces = moved.slice, slice(moved.slice.stop, layout.v[block].slice.stop)
    (_, q, v), (t, q_fine, v_fine) = coarse[:3], fine[:3]
    with np.errstate(all="ignore"):  # What has exploded overflows.
        steps = np.broadcast_to(q_fine[0], q_fine.shape), q
        far, apart = (np.linalg.norm(difference(layout.segments, x, q_fine)[:, at], axis=1) for x in steps)
        fast, faster = (np.linalg.norm(x[:, at], axis=1) for x in (v_fine, v - v_fine))
        reach, speed = max(float(far.max()), STILL * float(t[-1] - t[0]), 1e-300), max(float(fast.max()), STILL)
        states = change_of_states(*(x[:, of_forces] for x in (v_fine, v, v_fine)))
        return max(float(apart.max()) / reach, max(float(faster[-1]), float(faster.mean())) / speed, states)


def _change(layout: Layout, block: str, run: States | None, coarse: States, fine: States, norm: Norm) -> float:
    """Difference of a mechanism's speeds and displacements, relative to the size of each.

    Args:
        layout: Layout of the diagram's vectors.
        block: Block of the mechanism.
        run: Records of the whole run, where these are of a window: its largest speed counts, and what that makes of
            the window's time, up to its largest displacement.
        coarse: Records by the step.
        fine: Records by half of it, at the same times.
        norm: What counts of the records.
    """
    at = layout.moved(block)[1].slice  # Speeds of the motion: states of forces have other units.
    with np.errstate(all="ignore"):  # What has exploded overflows.
        q, v, q_half, v_half = (*coarse[1:3], *fine[1:3])
        moved = difference(layout.segments, np.broadcast_to(q_half[0], q_half.shape), q_half)[:, at]
        apart = difference(layout.segments, q_half, q)[:, at]
        fastest, faster = norm(v_half[:, at]), norm((v - v_half)[:, at])
        span = float(fine[0][-1] - fine[0][0])
        reach = norm(moved)
        if run is not None:
            largest = norm(run[2][:, at])
            # What a motion grows to later is no measure of it, nor of its start where it grows without bounds.
            by_then = max(fastest, norm(run[2][: np.searchsorted(run[0], fine[0][-1], side="right"), at]))
            if fine[0][0] > run[0][0] or largest > EXPLODED * by_then:
                largest = by_then
            wide = norm(difference(layout.segments, np.broadcast_to(run[1][0], run[1].shape), run[1])[:, at])
            # What goes to and fro comes no farther, however long the window is.
            fastest, reach = max(fastest, largest), max(reach, min(largest * span, wide))
        of_forces = slice(at.stop, layout.v[block].slice.stop)
        whole = v_half if run is None else run[2]
        states = change_of_states(*(x[:, of_forces] for x in (whole, v, v_half)))
        return max(faster / max(fastest, STILL), norm(apart) / max(reach, STILL * span, 1e-300) / _POSITIONS, states)
