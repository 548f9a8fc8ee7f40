"""How a run of a compiled diagram ended: its Outcome, with what was met on the way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symofros.base.user_functions import raised_where
from symofros.diagrams.program.layout import Layout
from symofros.diagrams.run.loop import Loop
from symofros.runtime.beams import BeamBending, bending_notes, largest_bending
from symofros.runtime.calls.kernel import Array
from symofros.simulation.results.outcome import Kind, Outcome
from symofros.simulation.results.step_size import examine_steps, remedy, step_size_note
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.resolution import Mode
from symofros.simulation.stepping.status import Status

_ENDS: dict[int, tuple[Kind, str, str]] = {
    Status.DIVERGED: ("diverged", "a state is no longer finite", "a smaller dt; look for gains that are too high"),
    Status.SINGULAR: ("singular", "no accelerations exist", "give every speed an inertia or a constraint"),
    Status.STEP_TOO_SMALL: ("step too small", "the tolerances ask for steps below rounding", "loosen rtol"),
    Status.ENERGY_LOST: (
        "constraints lost",
        "keeping the constraints has taken the energy of the motion: they are singular here",
        "a smaller step, or an event before it",
    ),
    Status.PROJECTION_FAILED: ("constraints lost", "projection does not meet the constraints again", "a smaller step"),
}


@dataclass(frozen=True)
class Ended:
    """A run that has ended.

    Attributes:
        loop: Loop at its last state.
        layout: Layout of the diagram's vectors.
        settings: Settings of each part.
        spacing: Shortest time between two instants, where steps end [s].
        states: All that it recorded: t (n), q, v, u.
        status: Last status.
        interrupted: Whether Ctrl-C ended the run.
    """

    loop: Loop
    layout: Layout
    settings: Sequence[Settings]
    spacing: float
    states: Sequence[Array]
    status: int
    interrupted: bool

    @property
    def t(self) -> float:
        """Time of the end [s]."""
        return float(self.loop.diagram.t[0])

    @property
    def bendings(self) -> tuple[BeamBending, ...]:
        """Bending of each beam at the step where its theory errs most."""
        return tuple(bending for part in self.loop.parts for bending in part.bendings)


def diagnose(ended: Ended) -> Outcome:
    """How a run ended."""
    loop, status, t, bendings = ended.loop, ended.status, ended.t, ended.bendings
    notes = (*bending_notes(bendings), *([loop.fault] if loop.fault else []))
    if ended.interrupted:
        return Outcome("interrupted", t, "Ctrl-C; the part up to here is kept", notes=notes)
    if status == Status.CALLBACK_FAILED:
        raised = raised_where(loop.failure) if loop.failure else "an exception"
        reason, advice = f"block '{loop.failed_block}' raised {raised}", "call it by itself; outcome.failure"
        return Outcome("input failed", t, reason, advice, notes, loop.failure)
    fault = (loop.fault or _held_fault(ended)) if status in _ENDS else ""
    if fault:
        return Outcome("input failed", t, fault, "outputs that are finite at all samples", bending_notes(bendings))
    failed = status in (Status.DIVERGED, Status.BEYOND_THEORY)
    for i, settings in enumerate(ended.settings):
        mode = _unresolved_mode(ended, i, failed)
        if mode is not None:
            notes = (*notes, step_size_note(mode, loop.parts[i], _stepped(ended, settings), ()))
            if failed and mode.amplified:
                reason = f"the step is past the limit of stability of '{settings.method.name}'"
                return Outcome("diverged", t, reason, remedy(mode, settings), notes)
    if status == Status.BEYOND_THEORY:
        worst = largest_bending(bendings)
        assert worst is not None
        advice = f"{worst.remedy}; or move the limit, beam_limit=..."
        return Outcome("beyond theory", worst.t, str(worst), advice, notes[len(bending_notes(bendings)) :])
    if status == Status.FINISHED:
        return Outcome("finished", float(loop.diagram.t_end), f"{int(loop.diagram.steps)} steps", notes=notes)
    kind, reason, advice = _ENDS[status]
    return Outcome(kind, t, reason, advice, notes)


def _stepped(ended: Ended, settings: Settings) -> Settings:
    """Settings with the step that was taken: steps end at instants, too."""
    return replace(settings, dt=min(settings.dt, ended.spacing))


def _unresolved_mode(ended: Ended, part: int, failed: bool) -> Mode | None:
    """The mode of a part that its fixed steps resolve worst, under the inputs held at the end."""
    settings, place = _stepped(ended, ended.settings[part]), ended.layout.parts[part]
    t, q, v, u = ended.states
    if not len(t) or settings.adaptive:
        return None
    states = (t, q[:, place.q], v[:, place.v], u)
    steps = ((settings.t_end if failed else ended.t) - settings.t0) / settings.dt
    start, stepper = (states[1][0], states[2][0]), ended.loop.parts[part]
    return examine_steps(stepper, settings, start, states, max(1, round(steps))).worst


def _held_fault(ended: Ended) -> str:
    """An output held between samples that is not finite though all states are, in words; "" where there is none."""
    loop, u = ended.loop, ended.loop.held
    if not all(np.isfinite(np.concatenate(stepper.state[1:])).all() for stepper in loop.parts):
        return ""
    for (block, port), place in ended.layout.held.items():
        bad = u[place.slice][~np.isfinite(u[place.slice])]
        if len(bad):
            return f"block '{block}': output '{port}' is {bad[0]} before t = {ended.t:.6g} s"
    return ""
