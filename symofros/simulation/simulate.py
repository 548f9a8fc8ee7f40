"""sf.simulate: a model, a first state, inputs, a method -> a Trajectory."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import numpy as np

from symofros.base.arguments import checked
from symofros.base.arrays import Array
from symofros.runtime.calls import native_library, native_library_is_loaded
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.events import event_notes, named_events
from symofros.simulation.inputs import Inputs, plan_inputs
from symofros.simulation.options import SimulationOptions
from symofros.simulation.prescribed_motions import contradiction, recorded_notes, refuse_contradiction
from symofros.simulation.progress import bar
from symofros.simulation.results.examination.diagnosis import diagnose
from symofros.simulation.results.trajectory import Found, Statistics, Trajectory
from symofros.simulation.settings import Settings, check_fit, check_start, first_configuration, vector
from symofros.simulation.stepping.loops import run_own, run_sundials
from symofros.simulation.stepping.stepper import Stepper


@checked
def simulate(
    model: Model,
    q0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    t_end: float = 1.0,
    *,
    u: Inputs | None = None,
    par: ArrayLike | None = None,
    events: Mapping[str, Any] | None = None,
    options: SimulationOptions | None = None,
    progress: bool | Callable[[float], None] = False,
    **changes: Any,
) -> Trajectory:
    """Move a model from a state through time; the stepping loop is C.

    Args:
        model: Compiled with backend "c".
        q0: First configuration (nq), or values by name, on the constraints (see `assemble`); the neutral one by
            default.
        v0: First speeds (nv), or values by name; rest by default.
        t_end: End time [s].
        u: Inputs: an array (nu), a Signal of all, a mapping from input names to numbers, formulas (of coordinates,
            speeds, parameters and t, compiled to C) and Signals, or a function (t, q, v) -> (nu), called from the loop
            and hence slow; after a run of fixed steps, but not in real time, it is called about a few states again, and
            where it gives the same, a short run in doubt is made once more with half the step.
            Those not given are zero, but for the rates of a prescribed motion that is a formula of t.
        par: Run-time parameters (npar), or values by name; the model's own by default.
        events: Name -> formula or Event.
        options: Options of stepping, stabilisation and recording; those of `SimulationOptions()` by default.
        progress: Show a progress bar; or a function that is called with the time reached [s], now and then.
        changes: Fields of SimulationOptions by name, which replace those of `options`: method="dopri5", dt=1e-4, ...

    Returns:
        The Trajectory; its `outcome` says how the run ended. What went wrong in motion is an outcome, not an
        exception, so that the part before it is kept; so does Ctrl-C.

    Raises:
        ShapeError: An array does not fit, or a quaternion is no rotation.
        UnknownNameError: The name of an option, an input or in a formula is unknown.
        AssemblyError: The first state does not meet the constraints.
        SymofrosError: The options contradict each other, or inputs that prescribe a motion.
    """
    settings = Settings.of(model, (options or SimulationOptions()).changed(changes), t_end)
    model = model.with_precision("double")
    values = model.parameter_values
    if par is not None:
        values = vector(model, "par", model.checked_parameters(par), model.npar)
    q = first_configuration(model, q0)
    v = np.zeros(model.nv) if v0 is None else vector(model, "v0", v0, model.nv)
    looked_for = named_events(events)
    inputs = plan_inputs(model, u)
    check_fit(model, settings, inputs)
    prepare_run(model, settings)
    stepper = Stepper(model, settings.method, inputs, looked_for, values)
    settings.apply(stepper)
    span = settings.t0, settings.t_end
    refuse_contradiction(contradiction(model, inputs, lambda at: stepper.inputs_at(at, q, v), span))
    check_start(model, settings, q, v, stepper.inputs_at(settings.t0, q, v), np.asarray(values))
    with bar(progress, settings.t0, t_end) as show:
        return run_to_its_end(stepper, settings, q, v, show)


def run_to_its_end(
    stepper: Stepper, settings: Settings, q: Array, v: Array, show: Callable[[float], None] = lambda t: None
) -> Trajectory:
    """Run a prepared stepper to its end; returns the trajectory with its outcome.

    Args:
        stepper: Stepper to which the settings were applied.
        settings: Settings of the run.
        q: First configuration (nq).
        v: First speeds (nv).
        show: Called with the time reached [s], now and then.
    """
    model, inputs, looked_for = stepper.model, stepper.inputs, stepper.events
    began, worked = time.perf_counter(), time.thread_time()
    drive = run_sundials if settings.method.family.multistep else run_own
    recorded = drive(stepper, q, v, settings, show)
    seconds, worked = time.perf_counter() - began, time.thread_time() - worked
    states = recorded.arrays()
    outcome, bendings = diagnose(stepper, recorded, states, settings, (q, v))
    outcome = replace(outcome, notes=(*outcome.notes, *event_notes(stepper.run, looked_for)))
    if inputs.callback is not None:
        outcome = replace(outcome, notes=(*outcome.notes, *recorded_notes(model.record, states[0], states[3])))
    met = tuple(Found(looked_for[which].name, when, q_at, v_at) for which, when, q_at, v_at in recorded.events)
    statistics = _statistics(stepper, seconds, worked)
    t, q_all, v_all, u_all = states
    return Trajectory(model, t, q_all, v_all, u_all, np.array(stepper.par), outcome, met, statistics, bendings)


def prepare_run(model: Model, settings: Settings | None = None) -> None:
    """Compile the functions of a run and its diagnosis in parallel; the integrator is compiled once per machine.

    Args:
        model: Model.
        settings: Settings of the run; those by default if not given.
    """
    settings = settings or Settings.of(model, SimulationOptions(), 1.0)
    names = ["forward_dynamics", *settings.method.family.functions, "kinetic_energy"]
    names += ["project", "constraint"] if model.nc else []
    names += ["dynamics"] if settings.judged else []
    if native_library_is_loaded():  # A thread would take longer than a short run.
        model.prepare(*names)
        return
    with ThreadPoolExecutor(1) as pool:
        integrator = pool.submit(native_library)
        model.prepare(*names)
        integrator.result()


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
