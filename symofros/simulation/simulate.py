"""sf.simulate: a model, a first state, inputs, a method -> a Trajectory."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from symofros.runtime.model import Given, Model
from symofros.simulation.diagnosis import diagnose
from symofros.simulation.events import named_events
from symofros.simulation.inputs import Inputs, plan_inputs
from symofros.simulation.loops import run_cvode, run_own
from symofros.simulation.progress import bar
from symofros.simulation.settings import Settings, Stabilisation, check_fit, check_start, vector
from symofros.simulation.stepper import Stepper
from symofros.simulation.trajectory import Found, Statistics, Trajectory


def simulate(
    model: Model,
    q0: Given | None = None,
    v0: Given | None = None,
    t_end: float = 1.0,
    *,
    u: Inputs | None = None,
    method: str = "rk4",
    dt: float | None = None,
    t0: float = 0.0,
    par: Given | None = None,
    rtol: float = 1e-6,
    atol: float = 1e-9,
    adaptive: bool | None = None,
    max_step: float = math.inf,
    max_steps: int | None = None,
    output: float | Given | None = None,
    every: int = 1,
    events: Mapping[str, Any] | None = None,
    stabilisation: Stabilisation = "projection",
    gains: Given | None = None,
    realtime: float | bool = False,
    progress: bool | Callable[[float], None] = False,
) -> Trajectory:
    """Move a model from a state through time; the stepping loop is C.

    Args:
        model: Compiled with backend "c".
        q0: First configuration (nq), on the constraints (see `assemble`); the neutral one by default.
        v0: First speeds (nv); rest by default.
        t_end: Where to end [s].
        u: Inputs: an array (nu), a Signal of all, a mapping from input names to numbers, formulas (of coordinates,
            speeds, parameters and t, compiled to C) and Signals, or a function (t, q, v) -> (nu), called from the loop
            and hence slow. Those not given are zero, but for the rates of a prescribed motion that is a formula of t.
        method: Fixed steps: "rk4", "semi_implicit_euler", "euler"; implicit ones, for stiff beams and joints:
            "implicit_euler", "generalized_alpha"; for long conservative runs, "variational". Steps chosen by `rtol`
            and `atol`: "dopri5", "dop853" and, for stiff models, "rodas4"; SUNDIALS' "cvode" (stiff) and
            "cvode_adams" where FMPy is installed.
        dt: Step [s], 1e-3 where a fixed step needs one; for adaptive methods the first step.
        t0: Where to begin [s].
        par: Run-time parameters (npar); the model's own by default.
        rtol: Bound of the local error of adaptive methods, of the size of each coordinate and speed.
        atol: Bound alike, absolute.
        adaptive: False steps an adaptive method by `dt`.
        max_step: Longest step of adaptive methods [s].
        max_steps: End the run after so many steps; none by default.
        output: What to record: None for each `every`-th step, an interval [s], or times (n).
        every: See output.
        events: Name -> formula or Event.
        stabilisation: How constraints are kept: "projection" onto them after each step, "baumgarte" by gains, or
            "none", by accelerations alone, which drifts.
        gains: Baumgarte's, as `Model.forward_dynamics` takes them; by default both are min(20, 1/(2 dt)) [1/s].
        realtime: Keep pace with the clock: True, or seconds of motion a second. Overruns are counted.
        progress: Show a progress bar; or a function that is told the time reached [s], now and then.

    Returns:
        The Trajectory; its `outcome` says how the run ended. What went wrong in motion is an outcome, not an
        exception, so that the part before it is kept; so does Ctrl-C.

    Raises:
        ShapeError: An array does not fit.
        UnknownNameError: A formula or an input's name is unknown.
        AssemblyError: The first state does not meet the constraints.
        SymofrosError: The settings contradict each other.
    """
    settings = Settings.of(
        model, method, dt, t0, t_end, rtol, atol, adaptive, max_step, output, every, stabilisation, gains
    )
    model = model.with_precision("double")
    values = model.parameter_values if par is None else vector(model, "par", par, model.npar)
    q = model.neutral() if q0 is None else vector(model, "q0", q0, model.nq)
    v = np.zeros(model.nv) if v0 is None else vector(model, "v0", v0, model.nv)
    looked_for = named_events(events)
    inputs = plan_inputs(model, u)
    check_fit(model, settings, inputs)
    stepper = Stepper(model, settings.method, inputs, looked_for, values)
    settings.apply(stepper, t0, t_end, float(realtime))
    check_start(model, settings, t0, q, v, stepper.inputs_at(t0, q, v), np.asarray(values))
    began, worked = time.perf_counter(), time.thread_time()
    with bar(progress, t0, t_end) as show:
        drive = run_cvode if settings.method.kind == "cvode" else run_own
        recorded = drive(stepper, q, v, settings, max_steps, show)
    seconds, worked = time.perf_counter() - began, time.thread_time() - worked
    states = recorded.arrays()
    outcome = diagnose(stepper, recorded, states, settings)
    met = tuple(Found(looked_for[which].name, when, q_at, v_at) for which, when, q_at, v_at in recorded.events)
    statistics = _statistics(stepper, seconds, worked)
    t, q_all, v_all, u_all = states
    return Trajectory(model, t, q_all, v_all, u_all, np.array(values), outcome, met, statistics)


def _statistics(stepper: Stepper, seconds: float, worked: float) -> Statistics:
    run = stepper.run
    paced = max(1, int(run.paced_steps))
    ranks = (int(run.rank_min), int(run.rank_max)) if stepper.model.nc else (-1, -1)
    return Statistics(
        stepper.method.name,
        int(run.steps),
        int(run.rejected),
        int(run.evaluations),
        int(run.jacobians),
        seconds,
        int(run.late_steps),
        float(run.late_max),
        float(run.late_sum) / paced,
        *ranks,
        worked,
    )
