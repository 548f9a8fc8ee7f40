"""Exudyn through time with any of its solvers, timed: of the processor, and stepping only.

A step that Newton's method does not finish ends the run, or may be cut a few times where that is asked for. Left to
itself Exudyn bisects such a step in silence down to 1e-8 s: no step of the size asked for, and no time of one.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import exudyn
import numpy as np

from ...mechanics.geometry import Array
from .system import new_system, silent_settings

EXPLICIT = ("ExplicitEuler", "ExplicitMidpoint", "RK33", "RK44", "RK67", "ODE23", "DOPRI5", "VelocityVerlet")
# Of a step that is cut.
_PARTS = 32.0
# Of the explicit ones, those that choose their steps.
ADAPTIVE = ("ODE23", "DOPRI5")


@dataclass(frozen=True)
class Solver:
    """One of Exudyn's solvers, with its settings.

    Attributes:
        kind: Exudyn's name of it.
        radius: Spectral radius of generalised alpha.
        full: Whether Newton's method factors the Jacobian in each iteration.
        tolerance: Newton's, of forces [N].
        relative: Newton's; of an adaptive explicit solver, that of its local error.
        sparse: Whether it solves by sparse matrices.
        bisecting: Whether it may cut a step that is not finished, down to a 32nd.
    """

    kind: str = "GeneralizedAlpha"
    radius: float = 0.9
    full: bool = True
    tolerance: float = 1e-6
    relative: float = 1e-8
    sparse: bool = False
    bisecting: bool = False

    @property
    def name(self) -> str:
        """Human-readable name of the solver and its options."""
        names = {"GeneralizedAlpha": f"generalised alpha {self.radius:g}", "TrapezoidalIndex2": "trapezoidal"}
        newton = "" if self.kind in EXPLICIT else ", full Newton" if self.full else ", modified Newton"
        return (
            names.get(self.kind, self.kind)
            + newton
            + (", sparse" if self.sparse else "")
            + (", bisecting" if self.bisecting else "")
        )

    def settings(self, step: float, end: float, output: float) -> Any:
        """Exudyn's settings for a run."""
        made = silent_settings()
        made.solution.sensors.writePeriod = output
        timed = made.timeIntegration
        timed.numberOfSteps, timed.endTime = round(end / step), end
        timed.solverType = getattr(exudyn.DynamicSolverType, self.kind)
        timed.adaptiveStep, timed.minimumStepSize = self.bisecting, step / _PARTS
        timed.automaticStepSize = self.kind in ADAPTIVE
        if self.kind in ADAPTIVE:
            timed.adaptiveStep, timed.minimumStepSize = True, 1e-10
        timed.relativeTolerance = timed.absoluteTolerance = self.relative
        timed.newton.useModifiedNewton = not self.full
        timed.newton.absoluteTolerance, timed.newton.relativeTolerance = self.tolerance, self.relative
        timed.generalizedAlpha.spectralRadius = self.radius
        if self.kind == "TrapezoidalIndex2":
            timed.generalizedAlpha.useNewmark = timed.generalizedAlpha.useIndex2Constraints = True
        if self.sparse:
            made.linearSolver.solverType = exudyn.LinearSolverType.EigenSparse
        return made


@dataclass(frozen=True)
class Recorded:
    """A run.

    Attributes:
        t: Output times (n).
        values: Values of the sensors, side by side (n, k).
        seconds: Processor time of the steps.
        ended: Why the solver gave up; "" if it did not.
    """

    t: Array
    values: Array
    seconds: float
    ended: str = ""


@dataclass(frozen=True)
class Timed:
    """A system that can be built again for each run.

    Attributes:
        build: Fills a system, and gives its sensors.
    """

    build: Callable[[Any], Sequence[Any]]

    def run(self, solver: Solver, step: float, end: float, output: float) -> Recorded:
        """Step a fresh system to its end, recording at an interval that is a multiple of the step."""
        container, system = new_system()
        sensors = self.build(system)
        system.Assemble()
        settings = solver.settings(step, end, output)
        explicit = solver.kind in EXPLICIT
        made: Any = exudyn.MainSolverExplicit() if explicit else exudyn.MainSolverImplicitSecondOrder()
        ended = ""
        try:
            made.InitializeSolver(system, settings)
            began = time.thread_time()
            came = made.SolveSteps(system, settings)
            seconds = time.thread_time() - began
            made.FinalizeSolver(system, settings)
            ended = "" if came else "a step was not finished"
        except (ValueError, RuntimeError) as error:  # How its solver reports what it refuses.
            return Recorded(np.zeros(0), np.zeros((0, 0)), math.nan, _first(error))
        tables = [np.array(system.GetSensorStoredData(sensor)) for sensor in sensors]
        del container  # Owns the system, and must outlive it.
        return Recorded(tables[0][:, 0], np.hstack([table[:, 1:] for table in tables]), seconds, ended)


def _first(error: Exception) -> str:
    return str(error).strip().splitlines()[0].partition("[Python file")[0].strip()[:160]
