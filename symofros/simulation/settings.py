"""The settings of a run, checked before it starts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from symofros.errors import AssemblyError, Problem, ShapeError, SymofrosError, UnknownNameError, did_you_mean
from symofros.runtime.kernel import Array
from symofros.runtime.model import Given, Model
from symofros.simulation.inputs import InputPlan
from symofros.simulation.methods import METHODS, Method
from symofros.simulation.stepper import Stepper

Stabilisation = Literal["projection", "baumgarte", "none"]

_STABILISATIONS = ("projection", "baumgarte", "none")
# Gains of 20/s hold a loop through its singular posture (tests of the N-four-bar), and lose accuracy on long steps.
_GAIN, _GAIN_STEP = 20.0, 0.5


def vector(model: Model, name: str, values: Given, size: int) -> Array:
    """A vector of that size, finite.

    Raises:
        ShapeError: It is something else.
    """
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (size,) or not np.all(np.isfinite(array)):
        found = str(array.shape) if array.shape != (size,) else "a number that is not finite"
        raise ShapeError(
            Problem(
                f"model '{model.record.name}': {name} does not fit",
                found,
                f"{name} is a finite array of shape ({size},)",
                "one state a run: see model.nq, model.nv",
            )
        )
    return array


def _wrong(what: str, found: object, rule: str, remedy: str) -> SymofrosError:
    return SymofrosError(Problem(f"simulation: {what}", str(found), rule, remedy))


@dataclass(frozen=True)
class Settings:
    """What a run is to do besides its model, state and inputs.

    Attributes:
        method: The stepping method.
        adaptive: Whether it chooses its steps.
        stabilisation: How constraints are kept.
        dt: Step [s]; 0: an adaptive method finds its first.
        rtol: Of adaptive methods, as `atol`.
        max_step: Longest step [s]; 0: none.
        every: Record each so many steps; 0: at `grid` only.
        grid: Times to record at (n) [s].
        project: Whether constraints are met again after each step.
        gains: Baumgarte's (2 nc).
    """

    method: Method
    adaptive: bool
    stabilisation: str
    dt: float
    rtol: float
    atol: float
    max_step: float
    every: int
    grid: Array
    project: bool
    gains: Array

    @classmethod
    def of(
        cls,
        model: Model,
        method: str,
        dt: float | None,
        t0: float,
        t_end: float,
        rtol: float,
        atol: float,
        adaptive: bool | None,
        max_step: float,
        output: float | Given | None,
        every: int,
        stabilisation: str,
        gains: Given | None,
    ) -> Settings:
        """Settings from what `simulate` was given.

        Raises:
            UnknownNameError: No such method.
            SymofrosError: A number is out of its range, or settings contradict each other.
        """
        if method not in METHODS:
            raise UnknownNameError(
                Problem(
                    f"simulation: no method '{method}'",
                    ", ".join(METHODS),
                    "a method has one of these names",
                    did_you_mean(method, METHODS),
                )
            )
        chosen = METHODS[method]
        if not (math.isfinite(t0) and math.isfinite(t_end) and t_end >= t0):
            raise _wrong("no span of time", f"t0 = {t0}, t_end = {t_end}", "t_end is not before t0", "set t_end")
        if dt is not None and not (math.isfinite(dt) and dt > 0):
            raise _wrong("the step is not positive", dt, "dt > 0", "1e-3 s suits most arms")
        for name, value in (("rtol", rtol), ("atol", atol), ("max_step", max_step)):
            if not value > 0:
                raise _wrong(f"{name} is not positive", value, f"{name} > 0", "leave it out")
        if every < 1:
            raise _wrong("nothing would be recorded", f"every = {every}", "every >= 1", "use output= for times")
        if stabilisation not in _STABILISATIONS:
            raise _wrong(
                f"unknown stabilisation '{stabilisation}'",
                stabilisation,
                ", ".join(_STABILISATIONS),
                did_you_mean(stabilisation, _STABILISATIONS),
            )
        if gains is not None and stabilisation != "baumgarte":
            raise _wrong(
                "gains without Baumgarte",
                f"stabilisation '{stabilisation}'",
                "gains act in Baumgarte's stabilisation only",
                "stabilisation='baumgarte'",
            )
        if adaptive and not chosen.adaptive:
            raise _wrong(
                f"'{method}' does not adapt its steps",
                "adaptive=True",
                "it estimates no error",
                "use dopri5, dop853 or rodas4",
            )
        # Where all motion is given there is no error to adapt to.
        adapts = model.nv > 0 and (chosen.adaptive if adaptive is None else adaptive)
        step = dt if dt is not None else 0.0 if adapts else 1e-3
        longest = max_step if math.isfinite(max_step) else 0.0
        return cls(
            chosen,
            adapts,
            stabilisation,
            step,
            rtol,
            atol,
            longest,
            every if output is None else 0,
            _grid(output, t0, t_end),
            model.nc > 0 and stabilisation == "projection",
            _gains(model, stabilisation, gains, step),
        )

    def apply(self, stepper: Stepper, t0: float, t_end: float, realtime: float) -> None:
        """Write the settings into a run."""
        run = stepper.run
        run.t0 = run.t = t0
        run.adaptive = int(self.adaptive)
        run.t_end, run.h, run.rtol, run.atol = t_end, self.dt, self.rtol, self.atol
        run.h_max, run.every, run.project = self.max_step, self.every, int(self.project)
        run.grid, run.n_grid = stepper.numbers(self.grid), len(self.grid)
        run.pace = 1.0 / realtime if realtime else 0.0
        stepper.set_gains(self.gains)


def check_fit(model: Model, settings: Settings, inputs: InputPlan) -> None:
    """Refuse what a method can't do for a model.

    Raises:
        SymofrosError: With what can.
    """
    name = settings.method.name
    implicit = settings.method.kind in ("rosenbrock", "alpha", "variational")
    if implicit and inputs.callback is not None:
        raise _wrong(
            f"'{name}' needs the derivatives of the inputs",
            "a Python function",
            "implicit methods differentiate what they step",
            "give formulas or Signals",
        )
    if implicit and settings.stabilisation == "baumgarte" and model.nc:
        raise _wrong(
            f"'{name}' with Baumgarte's stabilisation",
            "gains",
            "implicit methods keep constraints by projection or by their equations",
            "stabilisation='projection'",
        )
    if settings.method.kind == "cvode" and (settings.project or not settings.adaptive):
        raise _wrong(
            f"'{name}' with projection or fixed steps",
            "a history of steps that would be cut",
            "CVODE chooses its steps, and keeps constraints by Baumgarte's gains",
            "stabilisation='baumgarte', or rodas4 with projection",
        )
    if settings.method.kind == "variational" and (model.nc or model.record.driven):
        raise _wrong(
            "'variational' steps trees of free motion only",
            f"model '{model.record.name}' has constraints or prescribed joints",
            "its discrete principle is written for free coordinates",
            "use generalized_alpha, or rk4 with projection",
        )


# Beyond, a first state is a mistake and not what drift leaves.
CLOSED = 1e-6


def check_start(model: Model, settings: Settings, t: float, q: Array, v: Array, u: Array, par: Array) -> None:
    """Refuse a first state that does not meet the constraints; Baumgarte's gains may pull one in.

    Raises:
        AssemblyError: With the constraint that is off most.
    """
    if not model.nc or settings.stabilisation == "baumgarte":
        return
    for what, values in (
        ("phi", model.constraint(q, u=u, par=par, t=t)),
        ("G v - b", model.constraint_rate(q, v, u=u, par=par, t=t)),
    ):
        worst = int(np.argmax(np.abs(values)))
        condition = model.names.constraints[worst]
        if not abs(values[worst]) <= CLOSED:
            raise AssemblyError(
                Problem(
                    f"model '{model.record.name}': the first state does not keep '{condition}'",
                    f"{what} = {values[worst]:.3g}",
                    f"|{what}| <= {CLOSED:g} at the start",
                    "start from sf.assemble(model, q0, v0), or pull it in by stabilisation='baumgarte'",
                )
            )


def _grid(output: float | Given | None, t0: float, t_end: float) -> Array:
    if output is None:
        return np.zeros(0)
    times = np.asarray(output, dtype=np.float64)
    if times.ndim == 0:
        interval = float(times)
        if not (math.isfinite(interval) and interval > 0):
            raise _wrong("the output interval is not positive", interval, "output > 0", "give an interval in seconds")
        count = math.floor((t_end - t0) / interval * (1 + 1e-12))
        return np.asarray(t0 + interval * np.arange(count + 1), dtype=np.float64)
    if times.ndim != 1 or not np.all(np.diff(times) > 0) or times.size == 0 or times[0] < t0 or times[-1] > t_end:
        raise ShapeError(
            Problem(
                "simulation: output times do not fit",
                f"shape {times.shape}",
                f"times (n) increase from {t0} to {t_end} at most",
                "sort them",
            )
        )
    return times


def _gains(model: Model, stabilisation: str, gains: Given | None, step: float) -> Array:
    if stabilisation != "baumgarte" or not model.nc:
        return np.zeros(2 * model.nc)
    if gains is None:
        return np.full(2 * model.nc, min(_GAIN, _GAIN_STEP / step) if step else _GAIN)
    given = np.asarray(gains, dtype=np.float64)
    given = np.repeat(given, model.nc) if given.shape == (2,) else given
    if given.shape != (2 * model.nc,) or not np.all(given >= 0):
        raise ShapeError(
            Problem(
                "simulation: gains do not fit",
                str(given.shape),
                f"(alpha, beta), or ({2 * model.nc},): alphas, then betas, none negative",
                "give two numbers",
            )
        )
    return given
