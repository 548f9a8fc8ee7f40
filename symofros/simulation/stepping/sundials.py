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
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.base.measures import Measures
from symofros.errors import SymofrosError
from symofros.runtime.constrained import eliminate, natural_sizes
from symofros.simulation.stepping.event_search import EventSearch, MetEvent
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper

# Values of SUNDIALS' return flags, the same for both solvers: error tests or the accuracy asked for fail at the
# smallest step; Newton's iterations do not converge.
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
        raise SymofrosError.of_extra(
            f"simulation: {name} is not installed",
            str(error),
            "SUNDIALS comes with the package scikit-sundae",
            "sundials",
            "use rodas4 or dop853",
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
        self._last = np.zeros(0)  # The solver's variables there, which begin with y = (q, v).
        self.size = stepper.model.nq + stepper.model.nv
        self._solver: Any = None
        self._reached, self._last_step = 0.0, 0.0
        self._stop = math.nan  # The instant at which the step under way has to end, or the last one ended.
        self._spent = np.zeros(2, dtype=np.int64)  # Evaluations, and of Jacobians, before the solver began anew.
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
            if status == Status.RUNNING and self._events is not None:
                status = self._events.start(self._reached, y)
        return status

    @abstractmethod
    def _begin(self, y: Array) -> None:
        """Make ready for motions from the first state y = (q, v)."""

    @abstractmethod
    def _place(self, t: float, y: Array) -> None:
        """Place the solver at a state y = (q, v), without a history."""

    def _place_solver(self, t: float, y: Array) -> None:
        run = self.stepper.run
        self._spent[:] = int(run.evaluations), int(run.jacobians)
        self._place(t, y)
        self._last = y

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
        """Make one step, which ends where an input jumps or bends: no pulse is stepped over. Returns a status.

        From such an instant the first step covers a part of the way to the next one only: steps are judged by their
        ends, where a pulse may have no force.
        """
        t0 = self._reached
        stop = self.stepper.next_stop(t0, self.stepper.inputs.next_corner(t0, end))
        if math.isclose(t0, self._stop, rel_tol=_SAME_INSTANT):
            self._begin_anew(t0, stop)
            first = t0 + _FIRST_SHARE * (stop - t0)
        else:
            first, self._stop = stop, stop
        y0 = self._last
        self.stepper.begin_step(t0, first)
        try:
            answer = self._solver.step(end, "onestep", first)
            if answer.success and float(answer.t) <= t0:  # After an interpolation it gives the last end again.
                answer = self._solver.step(end, "onestep", first)
            if not answer.success:
                return _STATUS.get(int(answer.status), Status.DIVERGED)
            t1, y1 = float(answer.t), np.array(answer.y, dtype=np.float64).reshape(-1)
            self.steps, self._reached, self._last, self._end = self.steps + 1, t1, y1, y1
            self._last_step = t1 - t0
            run = self.stepper.run
            run.evaluations, run.jacobians = (self._spent + [int(answer.nfev), int(answer.njev)]).tolist()
            status = int(Status.RUNNING)
            if self._events is not None and np.all(np.isfinite(y1)):
                ends = {t0: y0, t1: y1}
                status, self.met = self._events.find(t0, t1, lambda t: ends[t] if t in ends else self._state(t))
            return status
        finally:
            self.stepper.end_step()

    def _begin_anew(self, t: float, stop: float) -> None:
        """Leave the solver's history at an instant t, where it is that of another function or of much longer steps.

        Accelerations may jump at t, by so much that no step of an old history is short enough; and error estimates that
        rest on steps far longer than the way to the next instant `stop` take no notice of what begins there.
        """
        y = self._last[: self.size]
        before, after = np.zeros(self.size), np.zeros(self.size)
        self.stepper.begin_step(t - self._last_step, t)
        self.stepper.slope(t, y, before)
        self.stepper.begin_step(t, stop)
        self.stepper.slope(t, y, after)
        bound = float(self.stepper.run.atol) + float(self.stepper.run.rtol) * np.abs(y)
        jumps = np.abs(after - before) * self._last_step > _JUMP * bound
        if jumps.any() or self._last_step > _LONGER * (stop - t):
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

    def _place(self, t: float, y: Array) -> None:
        self._solver.init_step(t, y)

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

    def _place(self, t: float, y: Array) -> None:
        stepper, model = self.stepper, self.stepper.model
        if stepper.place(t, y) != Status.RUNNING:
            raise _InputFailedError
        now, q, v = stepper.state
        u = stepper.inputs_now
        a, lam = model.forward_dynamics(q, v, u, par=stepper.par, t=now, multipliers=True)
        G = model.constraint_jacobian(q, u=u, par=stepper.par, t=now)
        on_speeds = np.array([name in model.record.speed_conditions for name in model.names.constraints], dtype=bool)
        self._kept, self._closed = (combinations(G, model.record.measures, of) for of in (on_speeds | True, ~on_speeds))
        self._strength = _least_size(self._kept @ G)
        # The multipliers of what is kept, of all rows' forces.
        lam = np.asarray(np.linalg.lstsq((self._kept @ G).T, G.T @ lam, rcond=None)[0] if len(self._kept) else [])
        first = np.concatenate([y, lam, np.zeros(len(self._closed))])
        rate = np.concatenate([stepper.configuration_rate(y[: model.nq], v), a, np.zeros(len(first) - self.size)])
        bounds = np.full(len(first), _UNTESTED)
        bounds[: self.size] = float(stepper.run.atol)
        options = self._options() | {"atol": bounds, "algebraic_idx": np.arange(self.size, len(first))}
        self._solver = _solver("ida", "IDA")(self._residuals, **options)
        self._solver.init_step(t, first, rate)

    def _step(self, end: float) -> int:
        self._choose_anew()
        return super()._step(end)

    def _choose_anew(self) -> None:
        """Start anew with other combinations where those that are kept have become weak."""
        stepper, model = self.stepper, self.stepper.model
        if len(self._kept) == model.nc:
            return
        t, q, v = self._reached, self._last[: model.nq], self._last[model.nq : self.size]
        inputs: dict[str, Any] = {"u": stepper.inputs_at(t, q, v), "par": stepper.par, "t": t}
        if _least_size(self._kept @ model.constraint_jacobian(q, **inputs)) < _WEAK * self._strength:
            q, v, _ = model.project(q, v, **inputs)
            self._place_solver(t, np.concatenate([q, v]))

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
