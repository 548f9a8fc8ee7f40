"""Running a scene: models compiled for nothing else, trials compared with what is right, costs counted."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from symofros.base.arrays import Array
from symofros.base.names import coordinate_of, speed_of
from symofros.base.options import Options
from symofros.compiler import Compilation, compile_system
from symofros.description import System
from symofros.errors import (
    AssemblyError,
    BeamTheoryError,
    InconsistentModelWarning,
    SymofrosError,
    UnknownNameError,
)
from symofros.errors import did_you_mean as near
from symofros.runtime.beams import BeamBending, largest_bending
from symofros.runtime.model import Model
from symofros.simulation.analysis.kinematics.starts import closed_start, stated_names
from symofros.simulation.results.trajectory import Trajectory
from symofros.simulation.simulate import simulate
from symofros.simulation.stepping.methods import METHODS
from symofros.studio.advice.scene import Scene

# Runs that take more steps than this are given up: no scene that asks for them is worth the wait.
MOST_STEPS = 200_000
# Tolerances of runs that count as exact are tightened until two runs differ by less than this share of what is allowed.
EXACT = 0.02
_LADDER = (1e-5, 1e-7, 1e-9, 1e-11)


@dataclass(frozen=True)
class Stepping:
    """A method with its step [s], or with its relative tolerance; the absolute one is a thousandth of it."""

    method: str
    dt: float | None = None
    rtol: float | None = None

    @property
    def settings(self) -> dict[str, float]:
        """Keyword arguments for `sf.simulate`."""
        tight = {} if self.rtol is None else {"rtol": self.rtol, "atol": 1e-3 * self.rtol}
        return tight if self.dt is None else {**tight, "dt": self.dt}

    def __str__(self) -> str:
        """Text such as "rk4, dt = 0.01 s"."""
        size = f"dt = {self.dt:.3g} s" if self.dt is not None else f"rtol = {self.rtol:.0e}"
        return f"{self.method}, {size}"


@dataclass(frozen=True)
class Cost:
    """What a run takes.

    Attributes:
        per_evaluation: Operations of one evaluation of the accelerations, or of an implicit step's residual.
        evaluations: Number of evaluations.
        per_jacobian: Operations of the derivatives, and of a factorisation of the matrix made of them.
        jacobians: Number of Jacobians.
        seconds: Measured, in the stepping loop.
    """

    per_evaluation: int
    evaluations: int
    per_jacobian: int
    jacobians: int
    seconds: float

    @property
    def total(self) -> int:
        """Operations of the run."""
        return self.per_evaluation * self.evaluations + self.per_jacobian * self.jacobians


@dataclass(frozen=True)
class Trial:
    """One run of one model.

    Attributes:
        run: The trajectory at the scene's times; None where there is none.
        failure: Why there is none; "" otherwise.
        values: Output's name -> it over time (n, k).
        beyond: Bending of the beam that ended the run beyond its theory.
    """

    run: Trajectory | None
    failure: str
    values: Mapping[str, Array]
    beyond: BeamBending | None = None


class SceneRunner:
    """Runs a scene with any model."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.runs = 0
        self._models: dict[str, Model] = {}
        self._counts: dict[str, dict[str, int]] = {}
        self._exact: dict[str, tuple[Trial, Stepping]] = {}

    @property
    def given(self) -> Stepping:
        """Time stepping for a model without speeds: all motion is prescribed, and any step is exact."""
        return Stepping("rk4", dt=self.scene.t_end / self.scene.samples)

    def functions(self, system: System, method: str) -> tuple[str, ...]:
        """Functions of a model that a run by a method calls, and `frame_pose` if the scene observes frames."""
        needed = ["forward_dynamics", *METHODS[method].family.functions]
        if system.constraints:
            needed += ["project", "constraint", "constraint_rate", "constraint_jacobian"]
        return (*needed, "frame_pose") if self.scene.frames else tuple(needed)

    def model(self, system: System, method: str = "rk4") -> Model:
        """The system compiled for a method."""
        functions = self.functions(system, method)
        key = f"{functions}{system!r}"
        if key not in self._models:
            # Loops are closed by functions that are not stepped with, so those are made when they are called.
            options = Options() if system.constraints else Options(functions, self.scene.frames)
            with warnings.catch_warnings():
                warnings.simplefilter(
                    "ignore", InconsistentModelWarning
                )  # It is tried all the same: a candidate that can't be compiled is listed with the reason.
                self._models[key] = compile_system(system, options)
        return self._models[key]

    def first(self, model: Model) -> tuple[Array, Array]:
        """The state that the scene starts from, its loops closed.

        Raises:
            UnknownNameError: The scene sets a coordinate that the model lacks.
        """
        q, v, names = model.neutral(), np.zeros(model.nv), model.names
        for name, value in self.scene.start.items():
            if coordinate := coordinate_of(name, names.q):
                q[names.q.index(coordinate)] = value
            elif speed := speed_of(name, names.v):
                v[names.v.index(speed)] = value
            else:
                known = (*names.q, *(f"d{speed}" for speed in names.v))
                raise UnknownNameError(
                    f"scene: start: no coordinate or speed '{name}'",
                    ", ".join(known[:12]),
                    "a start is of coordinates, and of speeds with a d before",
                    near(name, known),
                )
        start = closed_start(model, q, v, *stated_names(names.q, names.v, self.scene.start))
        return start.q, start.v

    def trial(self, system: System, stepping: Stepping, most_steps: int = MOST_STEPS) -> Trial:
        """Run the scene; a model that can't be compiled, or does not get to the end, fails with the reason."""
        self.runs += 1
        try:
            model = self.model(system, stepping.method)
            q, v = self.first(model)
            if model.nv == 0:
                stepping = self.given
            run = simulate(
                model,
                q,
                v,
                self.scene.t_end,
                u=dict(self.scene.inputs) or None,
                method=stepping.method,
                output=self.scene.times,
                max_steps=most_steps,
                **stepping.settings,  # type: ignore[arg-type]
            )
            if not run.outcome.ok:
                beyond = largest_bending(run.bendings) if run.outcome.kind == "beyond theory" else None
                return Trial(None, f"{run.outcome.kind} at t = {run.outcome.t:.3g} s: {run.outcome.reason}", {}, beyond)
            if run.t[-1] < self.scene.t_end:  # Runs that end elsewhere are not compared.
                return Trial(None, f"{run.outcome.kind} at t = {run.outcome.t:.3g} s: {run.outcome.reason}", {})
            return Trial(run, "", {output.name: output.values(run) for output in self.scene.outputs})
        except AssemblyError as error:
            return Trial(None, str(error).splitlines()[0], {})

    def exact(self, system: System) -> tuple[Trial, Stepping]:
        """A run whose own error does not count, and how it was stepped.

        Raises:
            SymofrosError: No method gets there.
        BeamTheoryError: A beam bends beyond second-order theory.
        """
        key = repr(system)
        if key not in self._exact:
            self._exact[key] = self._converged(system)
        return self._exact[key]

    def _converged(self, system: System) -> tuple[Trial, Stepping]:
        failures: list[str] = []
        for method in ("dop853", "rodas4"):
            before: Trial | None = None
            for rtol in _LADDER:
                stepping = Stepping(method, rtol=rtol)
                trial = self.trial(system, stepping)
                if trial.beyond is not None:
                    raise _beyond_theory(system, trial.beyond)
                if trial.run is None:
                    failures.append(f"{stepping}: {trial.failure}")
                    break
                if before is not None and self.error(before, trial) <= EXACT:
                    return trial, stepping
                before = trial
        what = f"advise: the motion of '{system.name}' can't be computed to its tolerance"
        if failures:
            raise SymofrosError(
                what,
                "; ".join(failures),
                f"runs reach the end within {MOST_STEPS} steps, and two of different tolerance agree",
                "loosen the tolerance, shorten the scene, or find by sf.simulate what ends it there",
            )
        raise SymofrosError(
            what,
            f"runs that reach the end differ, as far as rtol = {_LADDER[-1]:g}",
            "two runs of different tolerance agree",
            "loosen the tolerance or shorten the scene; a chaotic motion has no exact one",
        )

    def error(self, trial: Trial, reference: Trial) -> float:
        """The largest error of an output, in units of what is allowed; infinite where there was no motion."""
        return max(self.errors(trial, reference).values())

    def errors(self, trial: Trial, reference: Trial) -> dict[str, float]:
        """Output's name -> its largest error in units of what is allowed."""
        shares = {}
        for output in self.scene.outputs:
            right = reference.values[output.name]
            if trial.run is None:
                shares[output.name] = math.inf
                continue
            with np.errstate(over="ignore"):  # What diverges may be too far away to be squared.
                off = float(np.linalg.norm(trial.values[output.name] - right, axis=1).max())
            bound = output.bound(right)
            if bound == 0.0:
                shares[output.name] = 0.0 if off == 0.0 else math.inf
            else:
                shares[output.name] = off / bound if math.isfinite(off) else math.inf
        return shares

    def operations(self, system: System, functions: tuple[str, ...]) -> dict[str, int]:
        """Operations a call of some functions of the whole model, by name."""
        known = self._counts.setdefault(repr(system), {})
        new = [name for name in functions if name not in known]
        if new:
            counted = Compilation(system, Options(tuple(new))).operations
            known.update({name: counted[name, ""].total for name in new})
        return {name: known[name] for name in functions}

    def cost(self, system: System, trial: Trial, method: str) -> Cost:
        """Arithmetic operations of a run, per evaluation and per Jacobian, with their numbers and the time taken."""
        assert trial.run is not None
        statistics, kind = trial.run.statistics, METHODS[method].kind
        n = trial.run.model.nv + trial.run.model.nc
        solve, factor = 2 * n**2, 2 * n**3 // 3
        of_step = "residual" if kind == "alpha" else "forward_dynamics"
        each = self.operations(system, (of_step,))[of_step]
        if statistics.jacobians == 0:
            # Trees have their factorisation in the generated code; constraints are solved for by a routine.
            extra = solve + factor if trial.run.model.nc else 0
            return Cost(each + extra, statistics.evaluations, 0, 0, statistics.seconds)
        slopes = self.operations(system, ("implicit_terms",))["implicit_terms"] + factor
        return Cost(each + solve, statistics.evaluations, slopes, statistics.jacobians, statistics.seconds)

    def timed(self, system: System, stepping: Stepping, repeats: int = 3) -> Cost:
        """The cost of a run, with the shortest time of some."""
        runs = [self.trial(system, stepping) for _ in range(repeats)]
        seconds = [one.run.statistics.seconds for one in runs if one.run is not None]
        return replace(self.cost(system, runs[0], stepping.method), seconds=min(seconds))


def _beyond_theory(system: System, bending: BeamBending) -> BeamTheoryError:
    return BeamTheoryError(
        f"advise: '{system.name}' leaves the theory of its beams in this scene",
        str(bending),
        "advice compares models of second-order theory, all of which have the same error there",
        bending.remedy,
    )


@dataclass(frozen=True)
class ReferenceSolution:
    """What is right: the richer model's motion, and what follows from it."""

    system: System
    trial: Trial

    @cached_property
    def run(self) -> Trajectory:
        """The motion."""
        assert self.trial.run is not None
        return self.trial.run
