"""The parts of a compiled diagram, each with its stepper at its first state."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from symofros.base.arrays import Array
from symofros.base.events import Event
from symofros.diagrams.program.compiled import CompiledDiagram, Resolved
from symofros.diagrams.program.layout import Part
from symofros.diagrams.run.examination.faults import fault_at
from symofros.diagrams.run.starts import Start, changes_of_driven, close_loops, stated_entries
from symofros.errors import AssemblyError, SymofrosError
from symofros.runtime.model import Model
from symofros.simulation.analysis.beam_theory import refuse_beyond
from symofros.simulation.inputs import InputPlan
from symofros.simulation.results.ends import ENDS
from symofros.simulation.settings import CLOSED, Settings
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper


@dataclass(frozen=True)
class Placed:
    """A part that is ready to move.

    Attributes:
        stepper: Stepper of the part.
        q: First configuration, on the constraints.
        v: First speeds.
        notes: What of a stated start changed in its last digits.
    """

    stepper: Stepper
    q: Array
    v: Array
    notes: tuple[str, ...] = ()


def place_parts(
    compiled: CompiledDiagram, settings_of: Callable[[Model], Settings], par: Array, begin: Start
) -> list[Placed]:
    """A stepper for each part.

    Raises:
        SymofrosError: The method is implicit.
        AssemblyError: A first state closes no loop.
    """
    resolved = compiled.resolved
    layout, name, par = resolved.layout, resolved.wired.name, resolved.layout.present(par, begin.u)
    placed = []
    for part, model, acting in zip(layout.parts, compiled.parts, compiled.actions, strict=True):
        settings = settings_of(model)
        if not settings.method.family.batched:
            raise SymofrosError(
                f"diagram '{name}': method '{settings.method.name}'",
                "an implicit method",
                "diagrams step by explicit methods",
                "use rk4, dopri5 or dop853",
            )
        inputs, switching = InputPlan(begin.u.copy(), list(layout.signals)), resolved.switching(part)
        events: Sequence[Event] = resolved.crossings if switching is None else switching.events
        stepper = Stepper(model, settings.method, inputs, events, par, lambda *_, acting=acting: acting)
        stepper.moving = layout.moving[part.v]
        stepper.set_instant(settings.instant)
        stepper.recall(begin.met, settings.t0)
        replace(settings, t0=begin.t).apply(stepper)
        stepper.look_ahead_after_actions()
        stepper.set_stops(begin.t, settings.t_end)  # Of fixed steps, too: the diagram's own loop ends them there.
        if layout.driven:
            stepper.run.loss_limit = math.inf
        stepper.run.record_every = 0  # Instants are recorded by the diagram's own loop.
        placed.append(Placed(stepper, begin.q[part.q], begin.v[part.v]))
        if model.nc and settings.stabilisation != "baumgarte":
            placed[-1] = _closed(resolved, part, stepper, begin, par)
    return placed


def start_parts(parts: list[Placed], resolved: Resolved, par: Array, begin: Start) -> None:
    """Evaluate the first accelerations.

    Args:
        parts: Parts, which are placed at their first states.
        resolved: The diagram.
        par: Run-time parameters (npar).
        begin: State of the diagram that they begin with.

    Raises:
        SymofrosError: They are not finite.
        BeamTheoryError: A beam is bent beyond its theory from the start.
    """
    for part in parts:
        status, stepper = part.stepper.start(part.q, part.v, 1), part.stepper
        if status == Status.BEYOND_THEORY:
            refuse_beyond(stepper.model, stepper.bendings, float(stepper.run.beam_limit), "the first state")
        if status < 0:
            found = fault_at(resolved, par, (begin.t, begin.q, begin.v), begin.u)
            what, remedy = "the first accelerations are not finite", "look for a first state that is not a number"
            if not found and status != Status.DIVERGED:
                what, remedy = ENDS[status].reason, ENDS[status].advice
            found = found or ", ".join(stepper.model.names.v[:6])
            rule = "the start is one that moves"
            raise SymofrosError(f"diagram '{resolved.wired.name}' at its start: {what}", found, rule, remedy)


def _closed(resolved: Resolved, part: Part, stepper: Stepper, begin: Start, par: Array) -> Placed:
    """A part projected onto its constraints, such that the stated entries of its start are preserved.

    Raises:
        AssemblyError: There is no such state.
    """
    coordinates, speeds = stated_entries(resolved, part, begin)
    q, v, residual = _projected(stepper.model, part, begin, par)
    on = begin.q.copy(), begin.v.copy()
    on[0][part.q], on[1][part.v] = q, v
    moved = [
        np.abs(found[stated] - asked[stated]) > CLOSED * np.maximum(1.0, np.abs(asked[stated]))
        for stated, found, asked in ((coordinates, on[0], begin.q), (speeds, on[1], begin.v))
    ]
    if residual <= CLOSED and not any(map(np.any, moved)):
        return Placed(stepper, q, v)  # Nothing is formed anew for what the projection keeps.
    near = replace(begin, q=begin.q.copy(), v=begin.v.copy())
    notes = close_loops(resolved, part, near, par)
    q, v, residual = _projected(stepper.model, part, near, par)
    if not residual <= CLOSED:
        raise AssemblyError(
            f"diagram '{resolved.wired.name}': the first state does not close the loops",
            f"|phi| = {residual:.3g}",
            f"at most {CLOSED:g} after projection",
            "start nearer: see sf.assemble",
        )
    on[0][part.q], on[1][part.v] = q, v
    return Placed(stepper, q, v, notes + changes_of_driven(resolved, part, begin, Start(begin.t, *on, begin.u)))


def _projected(model: Model, part: Part, begin: Start, par: Array) -> tuple[Array, Array, float]:
    """The nearest state of a part on its constraints, and the largest |phi| that is left."""
    q, v, residual = model.project(begin.q[part.q], begin.v[part.v], u=begin.u, par=par, t=begin.t)
    return q, v, float(residual)
