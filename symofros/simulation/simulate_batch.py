"""sf.simulate_batch: a model, many first states, inputs and parameters -> Trajectories."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.base.arguments import checked
from symofros.base.arrays import Array, real_array
from symofros.errors import ShapeError, SymofrosError
from symofros.runtime.calls import flat
from symofros.runtime.manifold import at_unit_length
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.kinematics.facing import facings
from symofros.simulation.batch_inputs import Shape, sort_inputs
from symofros.simulation.events import events_of
from symofros.simulation.inputs import Inputs
from symofros.simulation.options import USUAL, SimulationOptions
from symofros.simulation.prescribed_motions import (
    Contradiction,
    Jump,
    contradiction,
    rated_inputs,
    refuse_contradiction,
)
from symofros.simulation.results.examination.batch_examination import BatchExamination
from symofros.simulation.results.trajectories import Trajectories, of_stated
from symofros.simulation.settings import CLOSED, Settings
from symofros.simulation.stepping.batch_stepper import BatchResults, BatchStepper, InitialStates, run_batch_steppers
from symofros.simulation.stepping.methods import METHODS
from symofros.simulation.stepping.status import Status


@checked
def simulate_batch(
    model: Model,
    q0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    t_end: float = 1.0,
    *,
    z0: ArrayLike | None = None,
    u: Inputs | None = None,
    par: ArrayLike | None = None,
    events: Mapping[str, Any] | None = None,
    threads: int | None = None,
    options: SimulationOptions | None = None,
    **changes: Any,
) -> Trajectories:
    """Move a model from many states through time, in C, several trajectories in the lanes of a vector.

    Of a model in single precision (`Model.with_precision`) states stay in double precision, and accelerations of trees
    are taken in single precision. Starts may lie in memory as they like; they are copied once.

    Each trajectory takes the steps that `simulate` would take, of its own length where the method adapts them, and has
    the same states within rounding; it does not depend on the others, nor on the number of threads, to the last bit.
    One that goes wrong ends with its outcome, and the others go on.

    Args:
        model: Compiled with backend "c".
        q0: First configurations (..., nq), on the constraints; the neutral one by default.
        v0: First speeds (..., nv); rest by default.
        t_end: End time [s].
        z0: First states of forces (..., nz); the neutral ones, zeros, by default.
        u: Inputs: an array (..., nu); a Signal of all, whose values are (n, nu), or (..., n, nu) where they differ; or
            a mapping from names to numbers, arrays (...), formulas, and Signals of values (n) or (..., n, 1).
        par: Run-time parameters (..., npar); the model's own by default.
        events: Name -> formula or Event, as of `simulate`, looked for in each trajectory; `Trajectories.events` has
            what was met. Actions change the parameters of their own trajectory.
        threads: Number of threads; by default that of the model (`Model.with_threads`).
        options: Options as of `simulate`; methods are explicit: "rk4", "semi_implicit_euler", "euler", "dopri5",
            "dop853".
            `output` is the last state alone by default.
        changes: Fields of SimulationOptions by name, which replace those of `options`.

    Returns:
        The Trajectories, whose batch dimensions are those of q0, v0, u and par broadcast together.

    Raises:
        ShapeError: An array does not fit, or batch dimensions do not broadcast.
        UnknownNameError: The name of an option, an input or in a formula is unknown.
        SymofrosError: The options contradict each other, are those of single runs, or the method is implicit.
    """
    chosen = (options or USUAL).changed(changes)
    rule = "a batch records at `output`, and is not paced"
    chosen.refuse(("realtime", "every"), "simulate_batch: an option of single runs", rule)
    if chosen.output is None:
        chosen = replace(chosen, output=[t_end])
    settings = Settings.of(model, chosen, t_end)
    _check_batch(settings)
    count = model.threads if threads is None else threads
    if count < 1:
        raise SymofrosError("simulate_batch: no thread to work", f"threads = {threads}", "threads >= 1", "leave it out")
    stated, model = model, model.carried
    q0, v0 = stated.carry(q0, v0, z0)
    given = sort_inputs(model, u)
    parameters = model.parameter_values if par is None else model.checked_parameters(par)
    rows = {
        "q0": _rows(model, "q0", model.neutral() if q0 is None else q0, model.nq),
        "v0": _rows(model, "v0", np.zeros(model.nv) if v0 is None else v0, model.nv),
        "par": _rows(model, "par", parameters, model.npar),
    }
    rows["q0"] = at_unit_length(model.record, "q", rows["q0"], "q0")
    shape = _batch_shape(rows, given.shapes)
    n = math.prod(shape)
    count = min(count, max(n, 1))
    inputs = given.spread(model, shape)
    q, v, values = (flat(array, shape) for array in rows.values())
    initial = InitialStates(q, v, values, inputs, n, settings.t0, events_of(model, events))
    results = BatchResults.empty(model, n, len(settings.grid))
    began = time.perf_counter(), time.process_time()
    steppers = [BatchStepper(model, settings, initial, results, i, count) for i in range(count if n else 0)]
    if steppers:
        refuse_contradiction(_contradiction(model, settings, initial, steppers[0]))
        results.status[_off(model, settings, initial, steppers[0])] = Status.PROJECTION_FAILED
        infinite = ~np.isfinite(initial.inputs.constant).all(axis=1)
        results.status[np.broadcast_to(infinite, n)] = Status.CALLBACK_FAILED
        began = time.perf_counter(), time.process_time()
        run_batch_steppers(steppers)
    seconds = time.perf_counter() - began[0], time.process_time() - began[1]
    own = rows["par"].copy()  # The caller's array may be another batch's next.
    shared = own if own.ndim == 1 else np.broadcast_to(own, (*shape, model.npar))
    kept = replace(initial, q=initial.q.copy(), v=initial.v.copy(), par=values.copy())
    runs = Trajectories(
        **results.shaped(shape),
        model=model,
        t=settings.grid,
        par=shared,
        method=settings.method.name,
        seconds=seconds[0],
        processor_seconds=seconds[1],
        met=tuple(met for stepper in steppers for met in stepper.met),
        examination=BatchExamination(model, settings, kept),
    )
    return of_stated(stated, runs)


def _check_batch(settings: Settings) -> None:
    """Refuse methods that only single runs can have."""
    name = settings.method.name
    if not settings.method.family.batched:
        explicit = ", ".join(name for name, method in METHODS.items() if method.family.batched)
        what, rule = f"simulate_batch: '{name}' is no explicit method", f"batches take {explicit}"
        raise SymofrosError(what, name, rule, "run sf.simulate for each state")


def _rows(model: Model, name: str, values: ArrayLike, size: int) -> Array:
    array = real_array(model.by_name(name, values))
    if array is None or array.ndim == 0 or array.shape[-1] != size:
        raise ShapeError(
            f"model '{model.record.name}': {name} has the wrong shape",
            f"{type(values).__name__} {values!r:.60}" if array is None else str(array.shape),
            f"{name} has shape (..., {size}), of real numbers",
            "one row a trajectory, or one for all",
        )
    return array


def _batch_shape(rows: dict[str, Array], inputs: list[Shape]) -> Shape:
    try:
        return np.broadcast_shapes(*(array.shape[:-1] for array in rows.values()), *inputs)
    except ValueError:
        shapes = [f"{name} {array.shape}" for name, array in rows.items()] + [f"inputs {shape}" for shape in inputs]
        raise ShapeError(
            "simulate_batch: batch dimensions do not broadcast",
            ", ".join(shapes),
            "all but the last dimension of each array broadcast together",
            "give each array the same leading dimensions, or none",
        ) from None


def _contradiction(
    model: Model, settings: Settings, initial: InitialStates, stepper: BatchStepper
) -> Contradiction | Jump | None:
    """The first prescribed motion whose inputs contradict each other: of the first trajectory, and of constants."""
    q, v, plan = initial.q[0], initial.v[0], initial.inputs.plan
    sampled = {index for index, *_ in plan.signals} | plan.formulas.keys()
    for rated in rated_inputs(model.record):
        if sampled.isdisjoint((*rated.position, *rated.rate)):  # What stays has no rate.
            stated = initial.inputs.constant[:, list(rated.rate)]
            if np.nanmax(np.abs(stated), initial=0.0) > 0.0:
                k, axis = (int(i) for i in np.unravel_index(int(np.nanargmax(np.abs(stated))), stated.shape))
                named = rated.names(model.names.u, axis)
                return Contradiction(*named, settings.t0, float(stated[k, axis]), 0.0, rated.follows)
    return contradiction(model, plan, lambda at: stepper.single.inputs_at(at, q, v), (settings.t0, settings.t_end))


def _off(model: Model, settings: Settings, initial: InitialStates, stepper: BatchStepper) -> npt.NDArray[np.bool_]:
    """Trajectories (n) that start off the constraints; as `check_start`, which refuses a single one."""
    n = initial.n
    if not model.nc:
        return np.zeros(n, dtype=np.bool_)
    u = initial.inputs.constant
    if model.record.driven:  # The motions of joints are inputs, by formulas too.
        q, v = np.broadcast_to(initial.q, (n, model.nq)), np.broadcast_to(initial.v, (n, model.nv))
        u = np.array([stepper.single.inputs_at(initial.t, q[i], v[i]) for i in range(n)])
    off = starts_off(model, settings, initial.q, initial.v, u, initial.par, initial.t)
    return np.broadcast_to(off, n) if len(off) == 1 else off


def starts_off(
    model: Model, settings: Settings, q: Array, v: Array, u: Array, par: Array, t: Array | float
) -> npt.NDArray[np.bool_]:
    """Whether each initial state is off the constraints (n); arrays have a row per state, or one for all."""
    exact = model.with_precision("double")  # As states are.
    off = np.zeros(max(map(len, (q, v, u, par))), dtype=np.bool_)
    for facing in facings(exact, q, u, par):
        off |= facing.cosines < 0.0
    if settings.stabilisation == "baumgarte":
        return off
    phi = exact.constraint(q, u=u, par=par, t=t)
    rate = exact.constraint_rate(q, v, u=u, par=par, t=t)
    for values in (phi, rate):
        off |= ~np.all(np.abs(values) <= CLOSED, axis=-1)
    return off
