"""An assembled Exudyn system as functions of its state, without its solvers (github.com/jgerstm/EXUDYN)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface as items

from ...mechanics.geometry import Array

VERSION: str = exudyn.__version__


def new_system() -> tuple[Any, Any]:
    """A container, which owns its system and must outlive it, and that system."""
    container = exudyn.SystemContainer()
    return container, container.AddSystem()


def silent_settings() -> Any:
    """Settings of solvers that write no file and say nothing."""
    settings: Any = exudyn.SimulationSettings()
    settings.solution.file.write, settings.solution.file.name = False, ""
    settings.timeIntegration.verboseMode = settings.staticSolver.verboseMode = 0
    return settings


def weigh(system: Any, body: Any, acceleration: Iterable[float]) -> None:
    """Load a body by its weight at an acceleration of gravity (3)."""
    marker = system.AddMarker(items.MarkerBodyMass(bodyNumber=body))
    system.AddLoad(items.LoadMassProportional(markerNumber=marker, loadVector=list(acceleration)))


@dataclass(frozen=True)
class ExudynSystem:
    """What Exudyn computes of its second-order coordinates, which are counted from the reference configuration.

    Attributes:
        container: Owns the system, and must outlive it.
        system: An assembled main system.
        solver: Initialised for it.
    """

    container: Any
    system: Any
    solver: Any

    def at(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Mass matrix (n, n) and the forces on the right-hand side (n,)."""
        self._set(q, v)
        self.solver.ComputeMassMatrix(self.system)
        M = np.array(self.solver.GetSystemMassMatrix())
        self.solver.ComputeODE2RHS(self.system)
        # What follows the forces belongs to constraints, and is not computed here.
        return M, np.array(self.solver.GetSystemResidual())[: len(q)]

    def stiffness(self, q: Array) -> Array:
        """Minus the derivative of the forces with respect to q, at rest (n, n)."""
        self._set(q, np.zeros_like(q))
        self.solver.ComputeJacobianODE2RHS(self.system, scalarFactor_ODE2=-1.0, scalarFactor_ODE2_t=0.0)
        return np.array(self.solver.GetSystemJacobian())[: len(q), : len(q)]

    def _set(self, q: Array, v: Array) -> None:
        data, current = self.system.systemData, exudyn.ConfigurationType.Current
        data.SetODE2Coordinates(q, configuration=current)
        data.SetODE2Coordinates_t(v, configuration=current)


def assembled(container: Any, system: Any) -> ExudynSystem:
    """A container's system that has all its nodes and objects, ready to be evaluated."""
    system.Assemble()
    settings = silent_settings()
    # What has no inertia in some direction is no obstacle: nothing is solved for here.
    settings.timeIntegration.generalizedAlpha.computeInitialAccelerations = False
    solver: Any = exudyn.MainSolverImplicitSecondOrder()
    # Its advice on large systems is about solving them.
    exudyn.config.suppressWarnings = True
    solver.InitializeSolver(system, settings)
    exudyn.config.suppressWarnings = False
    return ExudynSystem(container, system, solver)
