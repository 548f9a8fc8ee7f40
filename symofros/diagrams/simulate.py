"""Run a compiled diagram: parts, instants and recording in one loop of C."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from symofros.diagrams.block import Block
from symofros.diagrams.compiled import CompiledDiagram, Resolved, fuser
from symofros.diagrams.layout import Place
from symofros.diagrams.loop import RECORD, Loop, Stage
from symofros.diagrams.rates import Schedule, schedule
from symofros.diagrams.result import Cost, Crossed, DiagramRun
from symofros.diagrams.wiring import surroundings
from symofros.errors import AssemblyError, Problem, SymofrosError, UnknownNameError, did_you_mean
from symofros.runtime.kernel import Array
from symofros.runtime.library import CompiledKernel
from symofros.runtime.model import Model
from symofros.simulation import stepper as native
from symofros.simulation.events import Event
from symofros.simulation.inputs import InputPlan
from symofros.simulation.outcome import Outcome
from symofros.simulation.progress import bar
from symofros.simulation.settings import CLOSED, Settings, Stabilisation
from symofros.simulation.stepper import Stepper

# Seconds that C may run before Python looks up, for progress and Ctrl-C.
_SPELL = 0.05
# Recorded by default at about so many times.
_RECORDS = 2000


def run_compiled(
    compiled: CompiledDiagram,
    t_end: float,
    *,
    t0: float = 0.0,
    method: str = "rk4",
    dt: float | None = None,
    record: float | None = None,
    rtol: float = 1e-6,
    atol: float = 1e-9,
    parameters: Mapping[str, Any] | None = None,
    stabilisation: Stabilisation = "projection",
    gains: Any = None,
    realtime: float | bool = False,
    threads: int = 1,
    progress: bool = False,
) -> DiagramRun:
    """Run a compiled diagram from its first state.

    Args:
        compiled: By `compile_diagram`.
        t_end: Where to end [s].
        t0: Where to begin [s]; instants are counted from it.
        method: An explicit method of `sf.simulate`: rk4, euler, semi_implicit_euler, dopri5, dop853.
        dt: Step [s]; steps also end at instants.
        record: Interval of recording [s]; by default about 2000 times in all. Steps end at recorded times, too.
        rtol: Of adaptive methods, as `atol`.
        atol: See rtol.
        parameters: Run-time parameters by name, such as {"pd.kp": [100, 80, 50], "plant.m_load": 0.8}.
        stabilisation: How constraints are kept, as in `sf.simulate`.
        gains: Baumgarte's.
        realtime: Keep pace with the clock: True, or seconds of motion a second.
        threads: How many share the parts that meet at samples only; results do not depend on it.
        progress: Show a progress bar.

    Raises:
        SymofrosError: The settings contradict each other, or name what the diagram lacks.
        AssemblyError: The first state does not meet the constraints.
    """
    resolved = compiled.resolved
    layout = resolved.layout
    if compiled.toolchain is None:
        raise SymofrosError(
            str(
                Problem(
                    f"diagram '{resolved.wired.name}': the loop is C",
                    "interpreted functions",
                    "run_compiled calls compiled functions",
                    "use interpret",
                )
            )  # fmt: skip
        )
    par = parameter_values(resolved, parameters or {})
    interval = record_interval(record, t0, t_end, dt)
    plan = schedule([*resolved.rates(), (RECORD, interval, 0.0)], resolved.wired.name)
    u0 = np.array(layout.u0, dtype=np.float64)
    steppers = []
    for part, model in zip(layout.parts, compiled.parts, strict=True):
        settings = Settings.of(model, method, dt, t0, t_end, rtol, atol, None, math.inf, None, 1, stabilisation,
                               gains)  # fmt: skip
        if settings.method.kind not in ("explicit", "semi_implicit"):
            raise SymofrosError(
                str(
                    Problem(
                        f"diagram: method '{method}'",
                        "an implicit method",
                        "diagrams step by explicit methods",
                        "use rk4, dopri5 or dop853",
                    )
                )  # fmt: skip
            )
        watched = resolved_events(compiled) if part.blocks else []
        stepper = Stepper(model, settings.method, InputPlan(u0.copy(), list(layout.signals)), watched, par)
        settings.apply(stepper, t0, t_end, 0.0)
        stepper.run.every = 0
        q, v = np.array(layout.q0[part.q]), np.array(layout.v0[part.v])
        if model.nc and settings.stabilisation != "baumgarte":
            q, v = _close(model, resolved.wired.name, t0, q, v, u0, par)
        steppers.append((stepper, q, v))
    names = list(dict.fromkeys(name for due in resolved.schedule.sets for name in _opaque(compiled, due)))
    blocks = [resolved.wired.blocks[name] for name in names]
    places = [[layout.held[name, port.name] for port in resolved.wired.ports[name].outputs] for name in names]
    loop = Loop(
        layout, [stepper for stepper, _, _ in steppers], plan, _stages(compiled, plan, names),
        [Stage(_kernel(compiled, f"crossed_{i}")) for i in range(len(_watched(compiled)))], par, u0,
        lambda which, t, heard: _called(compiled, names[which], t, heard), places,
        [_hears(compiled, name) for name in names], any(layout.condition_names),
    )  # fmt: skip
    opened = []
    try:
        for block in blocks:
            block.learn(surroundings(resolved.wired, block.name))
            block.begin()
            opened.append(block)
        for stepper, q, v in steppers:
            status = stepper.start(q, v, 1)
            if status < 0:
                raise SymofrosError(f"diagram '{resolved.wired.name}': the first accelerations are not finite")
        run = _drive(compiled, loop, plan, interval, t0, t_end, par, float(realtime), threads, progress)
        return replace(run, kept=kept_by(opened))
    finally:
        loop.close()
        for block in opened:
            block.end()


def kept_by(blocks: Iterable[Block]) -> dict[str, dict[str, Array]]:
    """What each block kept of a run, those left out that keep nothing."""
    return {block.name: dict(found) for block in blocks if (found := block.kept())}


def _drive(
    compiled: CompiledDiagram, loop: Loop, plan: Schedule, interval: float, t0: float, t_end: float, par: Array,
    realtime: float, threads: int, progress: bool,
) -> DiagramRun:  # fmt: skip
    span = float(plan.base) * plan.cycle
    instants = int((t_end - t0) / span + 2) * len(plan.instants)
    loop.start(t0, t_end, realtime, threads, instants)
    portions: list[list[Array]] = []
    met: list[tuple[float, int]] = []
    status, spell, interrupted = native.GOING, 64, False
    began, worked = time.perf_counter(), time.thread_time()
    with bar(progress, t0, t_end) as show:
        try:
            while status in (native.GOING, native.FULL):
                before = time.perf_counter()
                status = loop.advance(spell)
                took = time.perf_counter() - before
                spell = max(1, spell // 2) if took > _SPELL else min(2 * spell, 1 << 20) if took < _SPELL / 4 else spell
                states, crossed = loop.take()
                portions.append(states)
                met += crossed
                show(float(loop.d.t[0]))
        except KeyboardInterrupt:
            interrupted = True
            portions.append(loop.take()[0])
    seconds, worked = time.perf_counter() - began, time.thread_time() - worked
    if isinstance(loop.failure, KeyboardInterrupt):
        interrupted = True
    t, q, v, u = (np.concatenate(columns) for columns in zip(*portions, strict=True))
    outcome = _outcome(loop, status, interrupted, t_end)
    watched = _watched(compiled)
    crossings = tuple(Crossed(*watched[which], when) for when, which in met)
    d = loop.d
    cost = Cost(int(d.steps), int(d.rejected), int(d.evaluations), seconds, worked, loop.late, plan.spacing)
    return DiagramRun(compiled, t, q, v, u, par, outcome, crossings, cost)


def parameter_values(resolved: Resolved, given: Mapping[str, Any]) -> Array:
    """The run-time parameters, some of them given by name.

    Raises:
        UnknownNameError: There is no such parameter.
        SymofrosError: A value does not fit.
    """
    layout = resolved.layout
    par = np.array(layout.par, dtype=np.float64)
    fields = {f"{block}.{name}": place for (block, name), place in layout.parameters.items() if block}
    for name, value in given.items():
        array = np.asarray(value, dtype=np.float64)
        if name in fields:
            place = fields[name]
        elif name in layout.par_names:
            place = Place(layout.par_names.index(name), ())
        else:
            known = [*fields, *layout.par_names]
            raise UnknownNameError(str(Problem(f"diagram: no run-time parameter '{name}'", f"'{name}'",
                                               f"known: {', '.join(known[:12])}", did_you_mean(name, known))
                                       ))  # fmt: skip
        if array.shape not in (place.shape, ()) or not np.all(np.isfinite(array)):
            raise SymofrosError(str(Problem(f"diagram: parameter '{name}' does not fit", f"{array.shape}",
                                            f"finite, of shape {place.shape}", "give it that shape")))  # fmt: skip
        par[place.slice] = np.broadcast_to(array, place.shape).reshape(-1)
    return par


def record_interval(record: float | None, t0: float, t_end: float, dt: float | None) -> float:
    """Between records: what was asked for, or a multiple of dt that gives about _RECORDS of them.

    Raises:
        SymofrosError: It is not positive, or there is no span of time.
    """
    if not (math.isfinite(t0) and math.isfinite(t_end) and t_end > t0):
        raise SymofrosError(str(Problem("diagram: no span of time", f"from {t0} to {t_end}", "t_end after t0",
                                        "set t_end")))  # fmt: skip
    if record is None:
        step = dt or 1e-3
        return step * max(1, math.ceil((t_end - t0) / step / _RECORDS))
    if not (math.isfinite(record) and record > 0.0):
        raise SymofrosError(str(Problem("diagram: no interval of recording", f"{record}", "above zero [s]",
                                        "leave it out")))  # fmt: skip
    return float(record)


def resolved_events(compiled: CompiledDiagram) -> list[Event]:
    """What the stepper looks for: crossings, each of which stops the motion."""
    pieces = compiled.resolved.pieces
    return [
        Event(f"{name}.{which}", pieces[name].crossings[which].direction, True, f"{name}.{which}")
        for name, which in _watched(compiled)
    ]


def _watched(compiled: CompiledDiagram) -> list[tuple[str, str]]:
    return [(name, which) for name, piece in compiled.resolved.pieces.items() for which in piece.crossings]


def _close(model: Model, name: str, t0: float, q: Array, v: Array, u: Array, par: Array) -> tuple[Array, Array]:
    """The nearest state on the constraints.

    Raises:
        AssemblyError: There is none near.
    """
    kernel = model.kernel("project")
    given = {"q": q, "v": v, "u": u, "t": np.array([t0])}
    inputs = [np.ascontiguousarray(given[group]).reshape(1, -1) for group, _ in kernel.signature.inputs]
    q_on, v_on, residual, _ = kernel.run(1, kernel.prepare(par.reshape(1, -1)), inputs)
    if not residual[0] <= CLOSED:
        raise AssemblyError(str(Problem(
            f"diagram '{name}': the first state does not close the loops", f"|phi| = {residual[0]:.3g}",
            f"at most {CLOSED:g} after projection", "start nearer: see sf.assemble",
        )))  # fmt: skip
    return q_on[0], v_on[0]


def _kernel(compiled: CompiledDiagram, name: str) -> CompiledKernel:
    kernel = compiled.instants.kernels[name, ""]
    assert isinstance(kernel, CompiledKernel)
    return kernel


def _opaque(compiled: CompiledDiagram, due: frozenset[str]) -> list[str]:
    return fuser(compiled.resolved).opaque(due)


def _stages(compiled: CompiledDiagram, plan: Schedule, names: list[str]) -> list[list[Stage]]:
    """For each set of the plan: blocks of Python's in order, then all others at once."""
    known = {due: i for i, due in enumerate(compiled.resolved.schedule.sets)}
    found: list[list[Stage]] = []
    for due in plan.sets:
        own = due - {RECORD}
        if not own:
            found.append([])
            continue
        i = known[own]
        stages = [Stage(_kernel(compiled, f"heard_{i}_{j}"), names.index(name))
                  for j, name in enumerate(_opaque(compiled, own))]  # fmt: skip
        found.append([*stages, Stage(_kernel(compiled, f"due_{i}"))])
    return found


def _hears(compiled: CompiledDiagram, name: str) -> int:
    wired = compiled.resolved.wired
    return sum(math.prod(port.shape or ()) for port in wired.ports[name].inputs if (name, port.name) in wired.sources)


def _called(compiled: CompiledDiagram, name: str, t: float, heard: Array) -> Array:
    """Call a block of Python's; its outputs one after the other."""
    wired = compiled.resolved.wired
    inputs, at = {}, 0
    for port in wired.ports[name].inputs:
        shape = port.shape or ()
        if (name, port.name) in wired.sources:
            inputs[port.name] = heard[at : at + math.prod(shape)].reshape(shape)
            at += math.prod(shape)
        else:
            inputs[port.name] = np.broadcast_to(np.asarray(port.default, dtype=np.float64), shape)
    found = wired.blocks[name].call(t, inputs)
    outputs = []
    for port in wired.ports[name].outputs:
        value = np.asarray(found[port.name], dtype=np.float64)
        if value.shape != (port.shape or ()):
            raise SymofrosError(f"block '{name}' returned {port.name} of shape {value.shape}, not {port.shape}")
        outputs.append(value.reshape(-1))
    return np.concatenate(outputs) if outputs else np.zeros(0)


def _outcome(loop: Loop, status: int, interrupted: bool, t_end: float) -> Outcome:
    t = float(loop.d.t[0])
    if interrupted:
        return Outcome("interrupted", t, "Ctrl-C; the part up to here is kept")
    if status == native.DONE:
        return Outcome("finished", t_end, f"{int(loop.d.steps)} steps")
    if status == native.CALLBACK:
        return Outcome("input failed", t, f"a block of Python's raised {loop.failure!r}", "call it by itself")
    kinds = {
        native.DIVERGED: ("diverged", "a state is no longer finite", "a smaller dt; look for gains that are too high"),
        native.NO_MOTION: ("singular", "no accelerations exist", "give every speed an inertia or a constraint"),
        native.TINY_STEP: ("step too small", "the tolerances ask for steps below rounding", "loosen rtol"),
        native.OFF: ("constraints lost", "projection does not meet the constraints again", "a smaller step"),
    }
    kind, reason, advice = kinds[status]
    return Outcome(kind, t, reason, advice)  # type: ignore[arg-type]
