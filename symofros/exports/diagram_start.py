"""The first state of a diagram's package, that of a run from Python, and what is known beforehand of how it moves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.program.compiled import Resolved, compile_diagram, resolve
from symofros.diagrams.run.parts import Placed, place_parts
from symofros.diagrams.run.simulate import run_compiled
from symofros.diagrams.run.starts import Start
from symofros.diagrams.run.values import diagram_options, part_settings
from symofros.exports.diagram_interface import Interface
from symofros.exports.limits import beams_note, joints_of, limits_note
from symofros.exports.material import Stepping
from symofros.simulation.analysis.kinematics.starts import singular_start

# Instants and steps of the run that is compared.
_CHECKED = 20
# By how much the inputs of that run differ from their starts, the first entry of each; exact in binary.
_PROBED = 0.125


@dataclass(frozen=True)
class FirstMotion:
    """First motion of a package.

    Attributes:
        starts: First configuration and speeds of each part.
        until: A time [s].
        given: The inputs that hold until then.
        signals: The outputs then, one after the other, of a run from Python.
        notes: Remarks for the user.
    """

    starts: tuple[tuple[Array, Array], ...]
    until: float
    given: tuple[float, ...]
    signals: tuple[float, ...]
    notes: tuple[str, ...]


def first_motion(diagram: Diagram, interface: Interface, outputs: Sequence[str], stepping: Stepping) -> FirstMotion:
    """Begin a diagram as its package is to begin, and note what a run from Python notes there.

    Raises:
        AssemblyError: A first state closes no loop.
        SymofrosError: The first accelerations are not finite.
    """
    starts = {item.name: np.reshape(item.start, item.shape) for item in interface.inputs}
    given = {
        item.name: starts[item.name] + _PROBED * (1.0 + np.arange(item.width).reshape(item.shape))
        for item in interface.inputs
    }
    resolved = resolve(diagram, starts)
    base = float(resolved.schedule.base) if resolved.schedule.instants else stepping.dt
    until = _CHECKED * max(base, stepping.dt)
    changes: dict[str, Any] = {name: getattr(stepping, name) for name in ("dt", "rtol", "atol", "beam_limit")}
    changes |= {"method": stepping.method.name, "record": until}
    compiled, options = compile_diagram(resolved), diagram_options(None, changes)
    par = np.array(resolved.layout.par)
    placed = place_parts(
        compiled, lambda model: part_settings(options, model, until), par, Start.of(resolved, options.t0, par)
    )
    run = run_compiled(compiled, until, options)
    probed = run_compiled(compile_diagram(resolve(diagram, given)), until, options) if given else run
    noted = [*_mechanism_notes(resolved, placed), *(note for part in placed for note in part.notes)]
    if run.outcome.kind != "finished":
        noted.append(f"a run of the first {until:g} s ends at t = {run.outcome.t:g} s: {run.outcome.reason}")
    noted += [f"in the first {until:g} s: {note}" for note in run.outcome.notes if note not in noted]
    return FirstMotion(
        tuple((part.q, part.v) for part in placed),
        float(probed.t[-1]),
        tuple(float(x) for values in given.values() for x in np.ravel(values)),
        tuple(float(x) for name in outputs for x in np.ravel(probed[name][-1])),
        tuple(dict.fromkeys(noted)),
    )


def _mechanism_notes(resolved: Resolved, placed: Sequence[Placed]) -> Iterator[str]:
    """Notes on the mechanisms: those of their descriptions, limits not enforced, singular initial postures."""
    layout, models = resolved.layout, resolved.wired.models
    for part, at in zip(layout.parts, placed, strict=True):
        for block in part.blocks:
            name = resolved.pieces[block].block.mechanism()
            if not name:
                continue
            system, record = models.system(name), models.record(name)
            said = [*system.notes, *limits_note(joints_of(system))]
            said += beams_note(models.compilation(name).beams(layout.parameters_of(block, name, np.array(layout.par))))
            if record.nc and not record.driven and not resolved.pieces[block].block.lock_inputs():
                q = layout.q[block]
                first = q.start - part.q.start
                said += singular_start(models.constraints(name), at.q[first : first + q.size])
            yield from (f"model '{name}': {note}" for note in said)
