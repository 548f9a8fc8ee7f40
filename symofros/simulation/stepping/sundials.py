"""SUNDIALS' CVODE and IDA behind the interface of our own methods: variable order, for smooth, stiff or closed systems.

The solvers come with scikit-sundae (the extra `sundials`). States are y = (q, v), for IDA with multipliers behind them:
docs/theory/simulation.md, section 7. Quaternions are made of unit length where they are used and not in y, so that the
solvers' history stays smooth.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.base.measures import Measures
from symofros.errors import Problem, SymofrosError
from symofros.runtime.calls.kernel import Array
from symofros.runtime.constrained import eliminate, natural_sizes
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper

# Values of SUNDIALS' return flags, the same for both solvers: an event was reached; error tests or the accuracy asked
# for fail at the smallest step; Newton's iterations do not converge.
_ROOT = 2
_STATUS = {-1: Status.STEP_TOO_SMALL, -2: Status.STEP_TOO_SMALL, -3: Status.STEP_TOO_SMALL, -4: Status.NO_CONVERGENCE}
# Multipliers are no part of the motion: a bound this large takes them out of the error test.
_UNTESTED = 1e100
# Share of what combinations of conditions were independent by when they were chosen, below which others are.
_WEAK = 0.3
# Conditions that combinations leave out may drift this far before they count as lost, or by some of the tolerance that
# is asked for, to which those that are kept are met as well.
_LOST, _LOST_TOLERANCES = 1e-6, 10.0


def _solver(module: str, name: str) -> Callable[..., Any]:
    """A solver class of scikit-sundae.

    Raises:
        SymofrosError: The package is not installed.
    """
    try:
        solver: Callable[..., Any] = getattr(import_module(f"sksundae.{module}"), name)
    except (ImportError, OSError, AttributeError) as error:
        raise SymofrosError(
            Problem.of_extra(
                f"simulation: {name} is not installed",
                str(error),
                "SUNDIALS comes with the package scikit-sundae",
                "sundials",
                "use rodas4 or dop853",
            )
        ) from None
    return solver


class _InputFailedError(Exception):
    """A Python function of inputs has failed; the stepper holds what it raised."""


class _Run(ABC):
    """One run by SUNDIALS: from step to step, with interpolation at the times that are recorded.

    Attributes:
        stepper: Model, inputs and events, bound; its own loop stays unused.
        steps: Number of steps so far.
    """

    def __init__(self, stepper: Stepper) -> None:
        self.stepper, self.steps = stepper, 0
        self.size = stepper.model.nq + stepper.model.nv
        self._solver: Any = None
        self._reached, self._spent = 0.0, (0, 0)
        self._method = stepper.method.name

    def start(self, q: Array, v: Array) -> int:
        """Place the run at its first state; returns a status."""
        status = self.stepper.start(q, v, 1)
        self.stepper.take_records()
        if status == Status.RUNNING:
            self._reached = float(self.stepper.run.t0)
            y = np.concatenate([q, v])
            self._begin(y)  # The solver evaluates its functions elsewhere, too.
            status = self.stepper.place(self._reached, y)
        return status

    @abstractmethod
    def _begin(self, y: Array) -> None:
        """Create the solver and place it at the first state y = (q, v)."""

    def _options(self) -> dict[str, Any]:
        """Options that both solvers take."""
        run, events = self.stepper.run, self.stepper.events
        options: dict[str, Any] = {
            "rtol": float(run.rtol),
            "first_step": float(run.h),
            "max_step": float(run.max_step),
            "max_num_steps": 100_000_000,
        }
        if events:
            values = self._event_function()
            values.direction = [event.sign for event in events]
            options |= {"eventsfn": values, "num_events": len(events)}
        return options

    @abstractmethod
    def _event_function(self) -> Any:
        """A function of the solver's arguments that evaluates the events; not a method, which takes no attributes."""

    def _evaluate_events(self, t: float, y: Array, values: Array) -> None:
        if self.stepper.event_values(t, y, values) != Status.RUNNING:
            raise _InputFailedError

    def advance(self, t: float | None) -> tuple[int, list[int]]:
        """Advance to a time, or by one step; to the next event at most. Returns a status, and the events met there."""
        end = float(self.stepper.run.t_end)
        try:
            while True:
                if t is not None and self._reached >= t:
                    answer = self._solver.step(t, "normal")  # Interpolates within the last step.
                    return self._placed(float(answer.t), answer.y), []
                answer = self._step(end)
                if not answer.success:
                    return _STATUS.get(int(answer.status), Status.DIVERGED), []
                self.steps, self._reached = self.steps + 1, float(answer.t)
                self.stepper.run.evaluations = self._spent[0] + int(answer.nfev)
                self.stepper.run.jacobians = self._spent[1] + int(answer.njev)
                if int(answer.status) == _ROOT:
                    met = [i for i, sign in enumerate(np.atleast_2d(answer.i_events)[-1]) if sign]
                    return self._placed(self._reached, answer.y), met
                if t is None:
                    return self._placed(self._reached, answer.y), []
        except _InputFailedError:
            return Status.CALLBACK_FAILED, []

    def _step(self, end: float) -> Any:
        """The solver's answer to one step, which ends where a held input changes: no pulse is stepped over."""
        stop = self.stepper.inputs.next_jump(self._reached, end)
        self.stepper.begin_step(stop)
        try:
            return self._solver.step(end, "onestep", stop)
        finally:
            self.stepper.end_step()

    def _placed(self, t: float, y: Array) -> int:
        """Make a state the run's own; returns a status."""
        state = np.asarray(y, dtype=np.float64).reshape(-1)
        if not np.all(np.isfinite(state)):
            return Status.DIVERGED
        return self.stepper.place(t, state) or self.stepper.judge_beams()


class Cvode(_Run):
    """One run by CVODE, on (9): BDF, or Adams' methods where the name says so."""

    def _begin(self, y: Array) -> None:
        method = "Adams" if self._method == "cvode_adams" else "BDF"
        options = self._options() | {"atol": float(self.stepper.run.atol), "method": method}
        self._solver = _solver("cvode", "CVODE")(self._slope, **options)
        self._solver.init_step(float(self.stepper.run.t0), y)

    def _event_function(self) -> Any:
        return lambda t, y, values: self._evaluate_events(t, y, values)

    def _slope(self, t: float, y: Array, rate: Array) -> None:
        if self.stepper.slope(t, y, rate) == Status.CALLBACK_FAILED:
            raise _InputFailedError


class Ida(_Run):
    """One run by IDA, on the equations of motion with their multipliers, index 2 (simulation.md, (10)).

    Of conditions that repeat others, independent combinations are kept, since multipliers would be undetermined. Where
    the motion makes these weak, it starts anew with others; where the conditions contradict each other, it ends.
    """

    def _begin(self, y: Array) -> None:
        bind, par = self.stepper.model.bind, self.stepper.par
        self._residual, self._jacobian = bind("residual", par=par), bind("constraint_jacobian", par=par)
        self._begin_at(float(self.stepper.run.t0), y)

    def _begin_at(self, t: float, y: Array) -> None:
        """Create the solver at a state y = (q, v)."""
        stepper, model = self.stepper, self.stepper.model
        q, v = y[: model.nq], y[model.nq :]
        u = stepper.inputs_at(t, q, v)
        a, lam = model.forward_dynamics(q, v, u, par=stepper.par, t=t, multipliers=True)
        G = model.constraint_jacobian(q, u=u, par=stepper.par, t=t)
        on_speeds = np.array([name in model.record.speed_conditions for name in model.names.constraints], dtype=bool)
        self._kept, self._closed = (combinations(G, model.record.measures, of) for of in (on_speeds | True, ~on_speeds))
        self._strength, self._last = _least_size(self._kept @ G), y
        # The multipliers of what is kept, of all rows' forces.
        lam = np.asarray(np.linalg.lstsq((self._kept @ G).T, G.T @ lam, rcond=None)[0] if len(self._kept) else [])
        first = np.concatenate([y, lam, np.zeros(len(self._closed))])
        rate = np.concatenate([stepper.configuration_rate(q, v), a, np.zeros(len(first) - self.size)])
        bounds = np.full(len(first), _UNTESTED)
        bounds[: self.size] = float(stepper.run.atol)
        options = self._options() | {"atol": bounds, "algebraic_idx": np.arange(self.size, len(first))}
        self._solver = _solver("ida", "IDA")(self._residuals, **options)
        self._solver.init_step(t, first, rate)

    def _step(self, end: float) -> Any:
        self._choose_anew()
        answer = super()._step(end)
        self._last = np.array(answer.y, dtype=np.float64).reshape(-1)[: self.size]
        return answer

    def _choose_anew(self) -> None:
        """Start anew with other combinations where those that are kept have become weak."""
        stepper, model = self.stepper, self.stepper.model
        if len(self._kept) == model.nc:
            return
        t, q, v = self._reached, self._last[: model.nq], self._last[model.nq :]
        inputs: dict[str, Any] = {"u": stepper.inputs_at(t, q, v), "par": stepper.par, "t": t}
        if _least_size(self._kept @ model.constraint_jacobian(q, **inputs)) < _WEAK * self._strength:
            q, v, _ = model.project(q, v, **inputs)
            self._spent = int(stepper.run.evaluations), int(stepper.run.jacobians)
            self._begin_at(t, np.concatenate([q, v]))

    def _event_function(self) -> Any:
        return lambda t, y, rate, values: self._evaluate_events(t, y, values)

    def _residuals(self, t: float, y: Array, rate: Array, residual: Array) -> None:
        """Residual of (10) at a point."""
        model, nq, nv = self.stepper.model, self.stepper.model.nq, self.stepper.model.nv
        if self.stepper.place(t, y[: self.size]) != Status.RUNNING:
            raise _InputFailedError
        t, q, v = self.stepper.state
        n = self.size + len(self._kept)
        lam, mu = self._kept.T @ y[self.size : n], y[n:]
        values = {"q": q, "v": v, "a": rate[nq : self.size], "u": self.stepper.inputs_now, "lam": lam, "t": t}
        outputs = _evaluated(self._residual, values)
        G = _evaluated(self._jacobian, values)["G"] if model.nc else np.zeros((0, nv))
        residual[:nq] = rate[:nq] - self.stepper.configuration_rate(y[:nq], v + (self._closed @ G).T @ mu)
        residual[nq : self.size] = outputs["R"]
        residual[self.size : n] = self._kept @ outputs["phi_rate"]
        residual[n:] = self._closed @ outputs["phi"]

    def _placed(self, t: float, y: Array) -> int:
        status = super()._placed(t, np.asarray(y, dtype=np.float64).reshape(-1)[: self.size])
        if status == Status.RUNNING and len(self._kept) < self.stepper.model.nc:
            t, q, v = self.stepper.state
            inputs: dict[str, Any] = {"u": self.stepper.inputs_now, "par": self.stepper.par, "t": t}
            phi = self.stepper.model.constraint(q, **inputs)
            rate = self.stepper.model.constraint_rate(q, v, **inputs)
            lost = max(_LOST, _LOST_TOLERANCES * float(self.stepper.run.rtol))
            if max(np.abs(phi).max(), np.abs(rate).max() * _LOST) > lost:
                return Status.PROJECTION_FAILED
        return status


def _evaluated(function: Any, values: dict[str, Any]) -> dict[str, Array]:
    """Outputs of a bound function at the values of its inputs."""
    for name, memory in function.inputs.items():
        memory[...] = values[name]
    function()
    outputs: dict[str, Array] = function.outputs
    return outputs


def combinations(G: Array, measures: Measures, of: npt.NDArray[np.bool_]) -> Array:
    """Independent combinations (k, nc) of some rows of G (nc, nv) that span them all; the rows themselves, if these do.

    Args:
        G: Jacobian of the constraints.
        measures: Measures of its rows and columns, by which its rank is judged.
        of: Which rows count (nc).
    """
    chosen = np.eye(len(of))[of]
    rows = measures.of_rows(np.flatnonzero(of).tolist())
    rank = eliminate(G[of], rows, np.ones(G.shape[1])).rank
    if rank == len(chosen):
        return chosen
    sizes = natural_sizes(G[of], rows).max(axis=1, initial=0.0)
    scale = np.divide(1.0, sizes, out=np.zeros_like(sizes), where=sizes > 0.0)
    left = np.linalg.svd(scale[:, None] * G[of], full_matrices=False)[0]
    return np.asarray(left[:, :rank].T * scale @ chosen, dtype=np.float64)


def _least_size(G: Array) -> float:
    """Least singular value; infinite of no rows."""
    return float(np.linalg.svd(G, compute_uv=False)[-1]) if min(G.shape, default=0) else np.inf
