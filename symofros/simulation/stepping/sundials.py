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

from symofros.errors import Problem, SymofrosError
from symofros.runtime.calls.kernel import Array
from symofros.simulation.stepping.event_search import EventSearch, MetEvent
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper

# Values of SUNDIALS' return flags, the same for both solvers: error tests or the accuracy asked for fail at the
# smallest step; Newton's iterations do not converge.
_STATUS = {-1: Status.STEP_TOO_SMALL, -2: Status.STEP_TOO_SMALL, -3: Status.STEP_TOO_SMALL, -4: Status.NO_CONVERGENCE}
# Multipliers are no part of the motion: a bound this large takes them out of the error test.
_UNTESTED = 1e100
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
    """One run by SUNDIALS: from step to step, with interpolation at the times that are recorded, and at events.

    Attributes:
        stepper: Model, inputs and events, bound; its own loop stays unused.
        steps: Number of steps so far.
        met: Events of the last step that are still to be returned.
    """

    def __init__(self, stepper: Stepper) -> None:
        self.stepper, self.steps = stepper, 0
        self.met: list[MetEvent] = []
        self._events = EventSearch(stepper) if stepper.events else None
        self._end: Array | None = None  # The state at the end of a step, where it is still to be returned.
        self._last = np.zeros(0)
        self.size = stepper.model.nq + stepper.model.nv
        self._solver: Any = None
        self._reached = 0.0
        self._method = stepper.method.name

    def start(self, q: Array, v: Array) -> int:
        """Place the run at its first state; returns a status."""
        status = self.stepper.start(q, v, 1)
        self.stepper.take_records()
        if status == Status.RUNNING:
            self._reached = float(self.stepper.run.t0)
            y = np.concatenate([q, v])
            self._last = y
            self._begin(y)  # The solver evaluates its functions elsewhere, too.
            status = self.stepper.place(self._reached, y)
            if status == Status.RUNNING and self._events is not None:
                status = self._events.start(self._reached, y)
        return status

    @abstractmethod
    def _begin(self, y: Array) -> None:
        """Create the solver and place it at the first state y = (q, v)."""

    def _options(self) -> dict[str, Any]:
        """Options that both solvers take."""
        run = self.stepper.run
        return {
            "rtol": float(run.rtol),
            "first_step": float(run.h),
            "max_step": float(run.max_step),
            "max_num_steps": 100_000_000,
        }

    def advance(self, t: float | None) -> tuple[int, int | None]:
        """Advance to a time, or by one step; to the next event at most. Returns a status, and the event met there."""
        end = float(self.stepper.run.t_end)
        try:
            while True:
                if self.met and (t is None or self.met[0].t <= t):
                    event = self.met.pop(0)
                    return self._placed(event.t, event.y), event.which
                if t is None and self._end is not None:
                    y, self._end = self._end, None
                    return self._placed(self._reached, y), None
                if t is not None and self._reached >= t:
                    return self._placed(t, self._state(t)), None
                status = self._step(end)
                if status != Status.RUNNING:
                    return status, None
        except _InputFailedError:
            return Status.CALLBACK_FAILED, None

    def _state(self, t: float) -> Array:
        """The state within the last step, by the solver's interpolation."""
        y: Array = self._solver.step(t, "normal").y
        return y

    def _step(self, end: float) -> int:
        """Make one step, which ends where a held input changes: no pulse is stepped over. Returns a status."""
        t0, y0, stop = self._reached, self._last, self.stepper.inputs.next_jump(self._reached, end)
        self.stepper.begin_step(stop)
        try:
            answer = self._solver.step(end, "onestep", stop)
            if answer.success and float(answer.t) <= t0:  # After an interpolation it gives the last end again.
                answer = self._solver.step(end, "onestep", stop)
            if not answer.success:
                return _STATUS.get(int(answer.status), Status.DIVERGED)
            t1, y1 = float(answer.t), np.array(answer.y, dtype=np.float64).reshape(-1)
            self.steps, self._reached, self._last, self._end = self.steps + 1, t1, y1, y1
            self.stepper.run.evaluations = int(answer.nfev)
            self.stepper.run.jacobians = int(answer.njev)
            status = int(Status.RUNNING)
            if self._events is not None and np.all(np.isfinite(y1)):
                ends = {t0: y0, t1: y1}
                status, self.met = self._events.find(t0, t1, lambda t: ends[t] if t in ends else self._state(t))
            return status
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
        t, q, v = float(stepper.run.t0), y[: model.nq], y[model.nq :]
        u = stepper.inputs_at(t, q, v)
        a, lam = model.forward_dynamics(q, v, u, par=stepper.par, t=t, multipliers=True)
        G = model.constraint_jacobian(q, u=u, par=stepper.par, t=t)
        self._rows = independent_rows(G)
        on_speeds = [name in model.record.speed_conditions for name in model.names.constraints]
        self._closed = np.array([i for i in self._rows if not on_speeds[i]], dtype=np.intp)
        # The multipliers of the rows that are kept, of all rows' forces.
        lam = np.linalg.lstsq(G[self._rows].T, G.T @ lam, rcond=None)[0] if len(self._rows) else np.zeros(0)
        first = np.concatenate([y, lam, np.zeros(len(self._closed))])
        rate = np.concatenate([stepper.configuration_rate(q, v), a, np.zeros(len(first) - self.size)])
        bounds = np.full(len(first), _UNTESTED)
        bounds[: self.size] = float(stepper.run.atol)
        options = self._options() | {"atol": bounds, "algebraic_idx": np.arange(self.size, len(first))}
        self._solver = _solver("ida", "IDA")(self._residuals, **options)
        self._solver.init_step(t, first, rate)

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
