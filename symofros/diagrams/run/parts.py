"""The parts of a compiled diagram, each with its stepper at its first state."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from symofros.diagrams.program.compiled import CompiledDiagram, Resolved
from symofros.diagrams.program.layout import Part
from symofros.diagrams.program.lowered_block import watched
from symofros.diagrams.run.faults import fault_at
from symofros.errors import AssemblyError, Problem, SymofrosError
from symofros.runtime.calls.kernel import Array
from symofros.runtime.model import Model
from symofros.simulation.analysis.beam_theory import refuse_beyond
from symofros.simulation.events import Event
from symofros.simulation.inputs import InputPlan
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
    """

    stepper: Stepper
    q: Array
    v: Array


def place_parts(compiled: CompiledDiagram, settings_of: Callable[[Model], Settings], par: Array) -> list[Placed]:
    """A stepper for each part.

    Args:
        compiled: The diagram.
        settings_of: Settings of a part's steps, by its model.
        par: Run-time parameters.

    Raises:
        SymofrosError: The method is implicit.
        AssemblyError: A first state closes no loop.
    """
    resolved = compiled.resolved
    layout, pieces, name = resolved.layout, resolved.pieces, resolved.wired.name
    u0 = np.array(layout.u0, dtype=np.float64)
    events = [
        Event(f"{block}.{which}", pieces[block].crossings[which].direction, True, f"{block}.{which}")
        for block, which in watched(pieces)
    ]
    placed = []
    for part, model in zip(layout.parts, compiled.parts, strict=True):
        settings = settings_of(model)
        if not settings.method.family.batched:
            raise SymofrosError(
                Problem(
                    f"diagram '{name}': method '{settings.method.name}'",
                    "an implicit method",
                    "diagrams step by explicit methods",
                    "use rk4, dopri5 or dop853",
                )
            )
        stepper = Stepper(model, settings.method, InputPlan(u0.copy(), list(layout.signals)), events, par)
        settings.apply(stepper)
        if layout.driven:
            stepper.run.loss_limit = math.inf
        stepper.run.record_every = 0  # Instants are recorded by the diagram's own loop.
        placed.append(Placed(stepper, *_first(layout.q0, layout.v0, part)))
        if model.nc and settings.stabilisation != "baumgarte":
            placed[-1] = Placed(stepper, *_close(model, name, settings.t0, placed[-1], u0, par))
    return placed


def start(parts: list[Placed], resolved: Resolved, par: Array, t0: float) -> None:
    """Evaluate the first accelerations.

    Args:
        parts: Parts, which are placed at their first states.
        resolved: The diagram.
        par: Run-time parameters (npar).
        t0: Start time [s].

    Raises:
        SymofrosError: They are not finite.
        BeamTheoryError: A beam is bent beyond its theory from the start.
    """
    for part in parts:
        status, stepper = part.stepper.start(part.q, part.v, 1), part.stepper
        if status == Status.BEYOND_THEORY:
            refuse_beyond(stepper.model, stepper.bendings, float(stepper.run.beam_limit), "the first state")
        if status < 0:
            layout = resolved.layout
            fault = fault_at(resolved, par, (t0, np.array(layout.q0), np.array(layout.v0)), np.array(layout.u0))
            raise SymofrosError(
                Problem(
                    f"diagram '{resolved.wired.name}': the first accelerations are not finite",
                    fault or ", ".join(stepper.model.names.v[:6]),
                    "the start is one that moves",
                    "look for a mass of zero or a first state that is not a number",
                )
            )


def _first(q0: list[float], v0: list[float], part: Part) -> tuple[Array, Array]:
    return np.array(q0[part.q], dtype=np.float64), np.array(v0[part.v], dtype=np.float64)


def _close(model: Model, name: str, t0: float, placed: Placed, u: Array, par: Array) -> tuple[Array, Array]:
    """The nearest state on the constraints."""
    kernel = model.kernel("project")
    given = {"q": placed.q, "v": placed.v, "u": u, "t": np.array([t0])}
    inputs = [np.ascontiguousarray(given[group]).reshape(1, -1) for group, _ in kernel.signature.inputs]
    q_on, v_on, residual, *_ = kernel.run(1, kernel.prepare(par.reshape(1, -1)), inputs)
    if not residual[0] <= CLOSED:
        raise AssemblyError(
            Problem(
                f"diagram '{name}': the first state does not close the loops",
                f"|phi| = {residual[0]:.3g}",
                f"at most {CLOSED:g} after projection",
                "start nearer: see sf.assemble",
            )
        )
    return q_on[0], v_on[0]
