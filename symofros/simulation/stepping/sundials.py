"""SUNDIALS' CVODE and IDA behind the interface of our own methods: variable order, for smooth, stiff or closed systems.

The solvers come with scikit-sundae (the extra `sundials`). States are y = (q, v), for IDA with multipliers behind them:
docs/theory/simulation.md, section 7. Quaternions are made of unit length where they are used and not in y, so that the
solvers' history stays smooth.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np

from symofros.errors import Problem, SymofrosError
from symofros.runtime.calls.kernel import Array
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper

# Values of SUNDIALS' return flags, the same for both solvers: an event was reached; error tests or the accuracy asked
# for fail at the smallest step; Newton's iterations do not converge.
_ROOT = 2
_STATUS = {-1: Status.STEP_TOO_SMALL, -2: Status.STEP_TOO_SMALL, -3: Status.STEP_TOO_SMALL, -4: Status.NO_CONVERGENCE}
# Multipliers are no part of the motion: a bound this large takes them out of the error test.
_UNTESTED = 1e100
# Times the bound of the error that a jump of rates makes in the last step, beyond which the solver begins anew: a step
# is tried seven times before the solver gives up, and may be shortened to a fifth each time.
_JUMP = 1e4
# Times the way to the next instant that the last step was long, beyond which its history is left.
_LONGER = 2.0
# Instants that differ by less, relative to themselves, are one: SUNDIALS' own share.
_SAME_INSTANT = 1e-13
# Share of the way between two instants that the first step covers.
_FIRST_SHARE = 0.4
# Rows of G count as dependent below this share of the largest remaining row; as RANK of assembly.
_DEPENDENT = 1e-9
# Conditions left out because others implied them may drift this far before they count as lost.
_LOST = 1e-6


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
        self._reached = 0.0
        self._stop = math.nan  # The instant at which the step under way has to end, or the last one ended.
        self._answer: Any = None
        self._last_step = 0.0
        self._before = 0, 0  # Evaluations, and of Jacobians, before the solver began anew.
        self._method = stepper.method.name

    def start(self, q: Array, v: Array) -> int:
        """Place the run at its first state; returns a status."""
        status = self.stepper.start(q, v, 1)
        self.stepper.take_records()
        if status == Status.RUNNING:
            self._reached = float(self.stepper.run.t0)
            y = np.concatenate([q, v])
            self._begin(y)  # The solver evaluates its functions elsewhere, too.
            self._place_solver(self._reached, y)
            status = self.stepper.place(self._reached, y)
        return status

    @abstractmethod
    def _begin(self, y: Array) -> None:
        """Create the solver for motions from the first state y = (q, v)."""

    @abstractmethod
    def _place_solver(self, t: float, y: Array) -> None:
        """Place the solver at a state y = (q, v), without a history."""

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
                self.stepper.run.evaluations = self._before[0] + int(answer.nfev)
                self.stepper.run.jacobians = self._before[1] + int(answer.njev)
                if int(answer.status) == _ROOT:
                    met = [i for i, sign in enumerate(np.atleast_2d(answer.i_events)[-1]) if sign]
                    return self._placed(self._reached, answer.y), met
                if t is None:
                    return self._placed(self._reached, answer.y), []
        except _InputFailedError:
            return Status.CALLBACK_FAILED, []

    def _step(self, end: float) -> Any:
        """The solver's answer to one step, which ends where an input jumps or bends: no pulse is stepped over.

        From such an instant the first step covers a part of the way to the next one only: steps are judged by their
        ends, where a pulse may have no force.
        """
        t = self._reached
        stop = self.stepper.next_stop(t, self.stepper.inputs.next_corner(t, end))
        if math.isclose(t, self._stop, rel_tol=_SAME_INSTANT):
            self._begin_anew(t, stop)
            first = t + _FIRST_SHARE * (stop - t)
        else:
            first, self._stop = stop, stop
        self.stepper.begin_step(t, first)
        try:
            self._answer = self._solver.step(end, "onestep", first)
        finally:
            self.stepper.end_step()
        self._last_step = float(self._answer.t) - t
        return self._answer

    def _begin_anew(self, t: float, stop: float) -> None:
        """Leave the solver's history at an instant t, where it is that of another function or of much longer steps.

        Accelerations may jump at t, by so much that no step of an old history is short enough; and error estimates that
        rest on steps far longer than the way to the next instant `stop` take no notice of what begins there.
        """
        y = np.array(self._answer.y, dtype=np.float64).reshape(-1)[: self.size]
        before, after = np.zeros(self.size), np.zeros(self.size)
        self.stepper.begin_step(t - self._last_step, t)
        self.stepper.slope(t, y, before)
        self.stepper.begin_step(t, stop)
        self.stepper.slope(t, y, after)
        bound = float(self.stepper.run.atol) + float(self.stepper.run.rtol) * np.abs(y)
        jumps = np.abs(after - before) * self._last_step > _JUMP * bound
        if jumps.any() or self._last_step > _LONGER * (stop - t):
            self._before = self._before[0] + int(self._answer.nfev), self._before[1] + int(self._answer.njev)
            self._place_solver(t, y)

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

    def _place_solver(self, t: float, y: Array) -> None:
        self._solver.init_step(t, y)

    def _event_function(self) -> Any:
        return lambda t, y, values: self._evaluate_events(t, y, values)

    def _slope(self, t: float, y: Array, rate: Array) -> None:
        if self.stepper.slope(t, y, rate) == Status.CALLBACK_FAILED:
            raise _InputFailedError


class Ida(_Run):
    """One run by IDA, on the equations of motion with their multipliers, index 2 (simulation.md, (10)).

    Conditions that others imply at the start are left out, since their multipliers would be undetermined; where they
    stop being implied, the run ends.
    """

    def _begin(self, y: Array) -> None:
        stepper, model = self.stepper, self.stepper.model
        bind = model.bind
        self._residual, self._jacobian = bind("residual", par=stepper.par), bind("constraint_jacobian", par=stepper.par)
        t, q = float(stepper.run.t0), y[: model.nq]
        G = model.constraint_jacobian(q, u=stepper.inputs_at(t, q, y[model.nq :]), par=stepper.par, t=t)
        self._rows = independent_rows(G)
        on_speeds = [name in model.record.speed_conditions for name in model.names.constraints]
        self._closed = np.array([i for i in self._rows if not on_speeds[i]], dtype=np.intp)
        bounds = np.full(self.size + len(self._rows) + len(self._closed), _UNTESTED)
        bounds[: self.size] = float(stepper.run.atol)
        options = self._options() | {"atol": bounds, "algebraic_idx": np.arange(self.size, len(bounds))}
        self._solver = _solver("ida", "IDA")(self._residuals, **options)

    def _place_solver(self, t: float, y: Array) -> None:
        stepper, model = self.stepper, self.stepper.model
        if stepper.place(t, y) != Status.RUNNING:
            raise _InputFailedError
        now, q, v = stepper.state
        u = stepper.inputs_now
        a, lam = model.forward_dynamics(q, v, u, par=stepper.par, t=now, multipliers=True)
        G = model.constraint_jacobian(q, u=u, par=stepper.par, t=now)
        # The multipliers of the rows that are kept, of all rows' forces.
        lam = np.linalg.lstsq(G[self._rows].T, G.T @ lam, rcond=None)[0] if len(self._rows) else np.zeros(0)
        first = np.concatenate([y, lam, np.zeros(len(self._closed))])
        rate = np.concatenate([stepper.configuration_rate(y[: model.nq], v), a, np.zeros(len(first) - self.size)])
        self._solver.init_step(t, first, rate)

    def _event_function(self) -> Any:
        return lambda t, y, rate, values: self._evaluate_events(t, y, values)

    def _residuals(self, t: float, y: Array, rate: Array, residual: Array) -> None:
        """Residual of (10) at a point."""
        model, nq, nv = self.stepper.model, self.stepper.model.nq, self.stepper.model.nv
        if self.stepper.place(t, y[: self.size]) != Status.RUNNING:
            raise _InputFailedError
        t, q, v = self.stepper.state
        n = self.size + len(self._rows)
        lam, mu = np.zeros(model.nc), y[n:]
        lam[self._rows] = y[self.size : n]
        values = {"q": q, "v": v, "a": rate[nq : self.size], "u": self.stepper.inputs_now, "lam": lam, "t": t}
        outputs = _evaluated(self._residual, values)
        G = _evaluated(self._jacobian, values)["G"] if model.nc else np.zeros((0, nv))
        residual[:nq] = rate[:nq] - self.stepper.configuration_rate(y[:nq], v + G[self._closed].T @ mu)
        residual[nq : self.size] = outputs["R"]
        residual[self.size : n] = outputs["phi_rate"][self._rows]
        residual[n:] = outputs["phi"][self._closed]

    def _placed(self, t: float, y: Array) -> int:
        status = super()._placed(t, np.asarray(y, dtype=np.float64).reshape(-1)[: self.size])
        if status == Status.RUNNING and len(self._rows) < self.stepper.model.nc:
            t, q, v = self.stepper.state
            inputs: dict[str, Any] = {"u": self.stepper.inputs_now, "par": self.stepper.par, "t": t}
            phi = self.stepper.model.constraint(q, **inputs)
            rate = self.stepper.model.constraint_rate(q, v, **inputs)
            if max(np.abs(phi).max(), np.abs(rate).max() * _LOST) > _LOST:
                return Status.PROJECTION_FAILED
        return status


def _evaluated(function: Any, values: dict[str, Any]) -> dict[str, Array]:
    """Outputs of a bound function at the values of its inputs."""
    for name, memory in function.inputs.items():
        memory[...] = values[name]
    function()
    outputs: dict[str, Array] = function.outputs
    return outputs


def independent_rows(G: Array) -> Array:
    """Indices of rows of G (nc, nv) that are independent and span all: by pivoting, each row judged by its own size."""
    scale = np.linalg.norm(G, axis=1)
    left = np.divide(G, scale[:, None], out=np.zeros_like(G), where=scale[:, None] > 0)
    rows: list[int] = []
    for _ in range(min(G.shape)):
        sizes = np.linalg.norm(left, axis=1)
        row = int(np.argmax(sizes))
        if sizes[row] <= _DEPENDENT:
            break
        rows.append(row)
        direction = left[row] / sizes[row]
        left = left - np.outer(left @ direction, direction)
        left[row] = 0.0
    return np.array(sorted(rows), dtype=np.intp)
