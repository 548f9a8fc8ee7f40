"""Exudyn through time with any of its solvers, timed: of the processor, and stepping only.

A step that Newton's method does not finish ends the run. Left to itself Exudyn bisects such a step, in silence and up
to a thousand times: no step of the size asked for, and no time of one.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface as items
from exudyn.advancedUtilities import CreateSymbolicUserFunction

from validation.adapters.exudyn_ancf import straight_beam
from validation.geometry import Array

EXPLICIT = ("ExplicitEuler", "ExplicitMidpoint", "RK33", "RK44", "RK67", "ODE23", "DOPRI5", "DVERK6", "VelocityVerlet")
# Of those, the ones that choose their steps.
ADAPTIVE = ("ODE23", "DOPRI5", "DVERK6")


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
    """

    kind: str = "GeneralizedAlpha"
    radius: float = 0.9
    full: bool = True
    tolerance: float = 1e-6
    relative: float = 1e-8
    sparse: bool = False

    @property
    def name(self) -> str:
        """For people."""
        names = {"GeneralizedAlpha": f"generalised alpha {self.radius:g}", "TrapezoidalIndex2": "trapezoidal"}
        newton = "" if self.kind in EXPLICIT else ", full Newton" if self.full else ", modified Newton"
        return names.get(self.kind, self.kind) + newton + (", sparse" if self.sparse else "")

    def settings(self, step: float, end: float, output: float) -> Any:
        """Exudyn's settings for a run."""
        made: Any = exudyn.SimulationSettings()
        made.solution.file.write, made.solution.file.name = False, ""
        made.solution.sensors.writePeriod = output
        timed = made.timeIntegration
        timed.numberOfSteps, timed.endTime, timed.verboseMode = round(end / step), end, 0
        timed.solverType = getattr(exudyn.DynamicSolverType, self.kind)
        timed.adaptiveStep = False
        timed.automaticStepSize = self.kind in ADAPTIVE
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
        values: Of the sensors, side by side (n, k).
        seconds: Of the processor, for the steps.
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
        build: -> container, assembled system, sensors.
    """

    build: Callable[[], tuple[Any, Any, Sequence[Any]]]

    def run(self, solver: Solver, step: float, end: float, output: float) -> Recorded:
        """Step a fresh system to its end, recording at an interval that is a multiple of the step."""
        container, system, sensors = self.build()
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


@dataclass(frozen=True)
class Rod:
    """A cantilever on the axis of a hub that spins up.

    Attributes:
        length: [m].
        EI: [N m^2].
        EA: [N].
        rhoA: [kg/m].
        duration: Of the spin-up [s].
        rate: At its end [rad/s].
    """

    length: float
    EI: float
    EA: float
    rhoA: float
    duration: float
    rate: float

    def angle(self, t: Array) -> Array:
        """The hub's at times within the spin-up: its second rate is rate/duration (1 - cos(2 pi t/duration))."""
        k = 2.0 * np.pi / self.duration
        return np.asarray(self.rate / self.duration * (t**2 / 2.0 + (np.cos(k * t) - 1.0) / k**2))


def spinning(rod: Rod, elements: int) -> Timed:
    """The rod of ANCFCable2D elements on a driven hub, with the position of its tip as sensor.

    The hub's angle is one of Exudyn's symbolic functions, evaluated in its C++: a Python function in its place makes
    a run of four elements a fifth slower. Its joints with such offsets have no form of index 2.
    """

    def build() -> tuple[Any, Any, Sequence[Any]]:
        container = exudyn.SystemContainer()
        system = container.AddSystem()
        nodes = straight_beam(system, rod.length, rod.EI, rod.EA, rod.rhoA, elements)
        ground = system.AddMarker(items.MarkerBodyRigid(bodyNumber=system.AddObject(items.ObjectGround())))
        root = system.AddMarker(items.MarkerBodyRigid(bodyNumber=0))  # The first element's, where it begins.
        joint = system.AddObject(items.GenericJoint(markerNumbers=[ground, root], constrainedAxes=[1, 1, 0, 0, 0, 1]))
        k, share = 2.0 * math.pi / rod.duration, rod.rate / rod.duration
        symbolic: Any = exudyn.symbolic

        def offset(mbs: Any, t: Any, itemNumber: Any, offsets: Any) -> list[Any]:  # noqa: N803 - Exudyn's own names.
            return [0.0, 0.0, 0.0, 0.0, 0.0, share * (t * t * 0.5 + (symbolic.cos(k * t) - 1.0) * (1.0 / k**2))]

        made = CreateSymbolicUserFunction(system, offset, "offsetUserFunction", joint)
        system.SetObjectParameter(joint, "offsetUserFunction", made)
        sensor = system.AddSensor(items.SensorNode(
            nodeNumber=nodes[-1], writeToFile=False, storeInternal=True,
            outputVariableType=exudyn.OutputVariableType.Position,
        ))  # fmt: skip
        system.Assemble()
        return container, system, [sensor]

    return Timed(build)
