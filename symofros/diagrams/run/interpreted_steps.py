"""Steps of an interpreted run, and crossings within them, located by the search that compiled ones use.

docs/theory/diagrams.md, section 5; docs/theory/simulation.md, section 2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.program.lowered_block import watched
from symofros.diagrams.run.block_functions import Blocks
from symofros.diagrams.run.projection import project_all
from symofros.diagrams.run.recording import Crossed
from symofros.runtime.manifold import chart_rate, retract
from symofros.simulation.events import unresolved_note
from symofros.simulation.stepping.event_search import StepSearch
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.tableaus import Tableau

# Stops at one instant after which crossings are said to bring each other about without end, as of compiled runs.
STOPS_AT_ONCE = 100


@dataclass(frozen=True)
class Stepped:
    """A step that was made.

    Attributes:
        t: Its start [s].
        h: Its length [s].
        q: Configuration at its start (nq).
        v: Speeds at its start (nv).
        slope: Rates of the chart's coordinates and of the speeds at its start (2 nv).
        end: Chart's coordinates and speeds at its end (2 nv), before they are projected.
    """

    t: float
    h: float
    q: Array
    v: Array
    slope: Array
    end: Array


class NotFiniteError(Exception):
    """An acceleration, a rate or a state that is no finite number ends an interpreted run."""


def step(blocks: Blocks, tableau: Tableau, h: float, projects: bool) -> Stepped:
    """One step of an explicit Runge-Kutta method, all parts together.

    Raises:
        NotFiniteError: The motion has no finite rate at a stage, where the blocks then are.
    """
    segments, nv = blocks.resolved.layout.segments, len(blocks.v)
    t, q, v = float(blocks.t[0]), blocks.q.copy(), blocks.v.copy()
    k: list[Array] = []

    def increments(weights: Array) -> tuple[Array, Array]:
        total = np.zeros(2 * nv)
        for weight, slope in zip(weights, k, strict=False):
            if weight != 0.0:
                total += weight * slope
        return h * total[:nv], h * total[nv:] + v

    blocks.step_end = t + h
    for i in range(tableau.stages):
        theta, speeds = increments(tableau.a[i])
        blocks.t[0] = t + tableau.c[i] * h
        blocks.q[:], blocks.v[:] = retract(segments, q, theta), speeds
        blocks.signals()
        blocks.accelerate()
        if not np.isfinite(blocks.a).all():
            raise NotFiniteError
        k.append(np.concatenate([chart_rate(segments, theta, speeds), blocks.a]))
    theta, speeds = increments(tableau.b)
    blocks.t[0] = t + h
    blocks.q[:], blocks.v[:] = retract(segments, q, theta), speeds
    if projects:
        project_all(blocks)
    blocks.step_end = math.inf
    return Stepped(t, h, q, v, k[0], np.concatenate([theta, speeds]))


class Crossings:
    """The crossings of a diagram's blocks.

    Args:
        blocks: The diagram's.
        projects: Whether states are projected onto constraints.

    Attributes:
        met: Those that were met.
        stops: How often the run has stopped at its present instant.
        notes: Note on the first crossing that was not followed within a step.
    """

    def __init__(self, blocks: Blocks, projects: bool) -> None:
        self._blocks, self._projects = blocks, projects
        self._watched = watched(blocks.resolved.pieces)
        self._directions = [event.sign for event in blocks.resolved.crossings]
        self._search = StepSearch(self._directions, self._evaluate) if self._watched else None
        self._number = 0
        self._step: Stepped
        self._ends: tuple[float, Array, Array]
        self._end_slope: Array | None = None
        self.met, self.notes = list[Crossed](), tuple[str, ...]()
        self.stops, self._stopped = 0, np.nan

    def restart(self) -> None:
        """The present values are those that the next step begins with."""
        if self._search is not None:
            self._search.restart()
            self._blocks.signals()
            self._blocks.crossing_values(self._search.values[0])

    def begin_span(self) -> None:
        """Steps are counted anew, as at each instant."""
        self._number = 0

    def stop(self, step: Stepped) -> list[int]:
        """The crossings that a step meets first, if any; the blocks are then at that instant.

        Args:
            step: The step; the blocks are at its end.
        """
        if self._search is None:
            return []
        blocks, search = self._blocks, self._search
        self._step, self._ends, self._end_slope = step, (float(blocks.t[0]), blocks.q.copy(), blocks.v.copy()), None
        way = step.h * float(np.abs(np.concatenate([step.v, step.end[len(step.v) :]])).max(initial=0.0))
        met, first = list[int](), 2.0
        blocks.step_end = step.t + step.h
        for which, x in search.arrivals(step.t, step.h, way, self._number):
            if x > first:
                break
            met, first = [*met, which], x
        self._number += 1
        if not self.notes and search.noted.unresolved >= 0:
            self.notes = (unresolved_note(".".join(self._watched[search.noted.unresolved]), step.t),)
        if met:
            self._place(first)
            self._read(search.values[0])
            met += [i for i, value in enumerate(search.values[0]) if search.is_met(i, first, float(value))]
            self._number = 0
        else:
            search.end_step()
            self._place(1.0)
        blocks.step_end = np.inf
        return met

    def execute(self, met: list[int]) -> bool:
        """Do what crossings change, one after the other; whether they do not bring each other about without end.

        What that carries through zero of others is met where the next step begins.
        """
        blocks = self._blocks
        self.stops = self.stops + 1 if float(blocks.t[0]) == self._stopped else 0
        self._stopped = float(blocks.t[0])
        blocks.signals()
        if len(blocks.lam):
            blocks.accelerate()
        for i in met:
            blocks.signals()
            blocks.cross(*self._watched[i])
            self.met.append(Crossed(*self._watched[i], float(blocks.t[0])))
        if self._projects:
            project_all(blocks)
        self.look_anew(met)
        return self.stops <= STOPS_AT_ONCE

    def look_anew(self, executed: list[int] | None = None) -> None:
        """Begin the search anew after a change, with what it carries through zero still to be met."""
        if self._search is None:
            return
        before = self._search.values[0].copy()
        before[executed or []] = 0.0
        self.restart()
        now = self._search.values[0]
        for i, direction in enumerate(self._directions):
            rises, falls = before[i] < 0.0 <= now[i], before[i] > 0.0 >= now[i]
            if (rises and direction >= 0) or (falls and direction <= 0):
                now[i] = before[i]

    def _evaluate(self, x: float, values: Array) -> int:
        self._place(x)
        self._read(values)
        return int(Status.RUNNING)

    def _read(self, values: Array) -> None:
        self._blocks.signals()
        self._blocks.crossing_values(values)

    def _place(self, x: float) -> None:
        """The blocks at x of the step: at its ends, or on the cubic through ends and slopes, projected as steps are."""
        blocks, step, segments = self._blocks, self._step, self._blocks.resolved.layout.segments
        if x in (0.0, 1.0):
            t, q, v = (step.t, step.q, step.v) if x == 0.0 else self._ends
            blocks.t[0], blocks.q[:], blocks.v[:] = t, q, v
            return
        nv, f0, f1 = len(step.v), step.h * step.slope, step.h * self._slope_at_end()
        y0 = np.concatenate([np.zeros(nv), step.v])
        d = step.end - y0
        y = y0 + x * (f0 + x * ((3.0 * d - 2.0 * f0 - f1) + x * (f0 + f1 - 2.0 * d)))
        blocks.t[0] = step.t + x * step.h
        blocks.q[:], blocks.v[:] = retract(segments, step.q, y[:nv]), y[nv:]
        if self._projects:
            project_all(blocks)

    def _slope_at_end(self) -> Array:
        """Rates of the chart's coordinates and of the speeds at the end of the step (2 nv)."""
        if self._end_slope is None:
            blocks, nv = self._blocks, len(self._step.v)
            self._place(1.0)
            blocks.signals()
            blocks.accelerate()
            rate = chart_rate(blocks.resolved.layout.segments, self._step.end[:nv], blocks.v)
            self._end_slope = np.concatenate([rate, blocks.a])
        return self._end_slope
