"""How a run of a compiled diagram ended: its Outcome, with what was met on the way."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.program.compiled import Resolved
from symofros.diagrams.program.layout import Layout, Part
from symofros.diagrams.run.examination.controllers import Rerun, RerunSpan
from symofros.diagrams.run.examination.faults import fault_at, without_end
from symofros.diagrams.run.examination.joint_limits import joint_limit_notes
from symofros.diagrams.run.loop import Loop
from symofros.errors import SymofrosError
from symofros.runtime.beams import BeamBending, bending_notes, largest_bending
from symofros.simulation.analysis.beam_theory import amplified_in_motion
from symofros.simulation.analysis.kinematics.postures import MAX_BETWEEN, nearest_to_singular, regular_rank
from symofros.simulation.events import event_notes
from symofros.simulation.results.acted import failure_of, notes_of
from symofros.simulation.results.ends import ENDS, INTERRUPTED, beyond_theory, past_stability
from symofros.simulation.results.engaging import engaged_apart, engaging_notes
from symofros.simulation.results.examination.constraint_faults import constraint_notes, near_singular_notes
from symofros.simulation.results.examination.finer_steps import States
from symofros.simulation.results.examination.paths import Numbers
from symofros.simulation.results.examination.run import ExaminedRun
from symofros.simulation.results.examination.step_size import examine_steps, remedy, step_size_note
from symofros.simulation.results.notes import distinct
from symofros.simulation.results.outcome import Outcome
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.loops import Recorded
from symofros.simulation.stepping.resolution import Resolution
from symofros.simulation.stepping.status import Status
from symofros.simulation.user_functions import raised_where

# Most values of parameters that events have set, and most phases between changes of constraints, that are examined.
_GROUPS, _PHASES = 8, 64
# Records, about, at which the rank of constraints is looked for.
_SOME = 16
_ALL = slice(None)


@dataclass(frozen=True)
class Ended:
    """A run that has ended.

    Attributes:
        loop: Loop at its last state.
        resolved: Diagram that ran.
        par: Run-time parameters (npar).
        settings: Settings of each part.
        spacing: Shortest time between two instants, where steps end [s].
        states: All that it recorded: t (n), q, v, u.
        recorded: The same in portions, with its events and its last status.
        spent: Wall time in the loop, processor time by the calling thread [s].
        start_notes: What of a stated start changed in its last digits.
    """

    loop: Loop
    resolved: Resolved
    par: Array
    settings: Sequence[Settings]
    spacing: float
    states: Sequence[Array]
    recorded: Recorded
    spent: tuple[float, float]
    start_notes: tuple[str, ...] = ()

    @property
    def layout(self) -> Layout:
        """Layout of the diagram's vectors."""
        return self.resolved.layout

    @property
    def t(self) -> float:
        """Time of the end [s]."""
        return self.loop.t

    @property
    def bendings(self) -> tuple[BeamBending, ...]:
        """Bending of each beam at the step where its theory errs most, amplified by the axial loads of the motion."""
        t, q, v, u = self.states
        bendings: list[BeamBending] = []
        for stepper, part in zip(self.loop.parts, self.layout.parts, strict=True):
            motion, bent, amplify = (t, q[:, part.q], v[:, part.v], u), stepper.bendings, stepper.amplified_bendings
            bendings += amplified_in_motion(bent, amplify, stepper.model, motion, self.par, "mass_matrix")
        return tuple(bendings)


def _without_end(ended: Ended, notes: tuple[str, ...]) -> Outcome:
    """The outcome of a run in which crossings bring each other about at one instant."""
    crossings, last = ended.resolved.crossings, [met for met in ended.recorded.events if met.t == ended.t][-8:]
    return without_end(ended.t, (crossings[met.which].name for met in last if met.which < len(crossings)), notes)


def diagnose(ended: Ended, bendings: Sequence[BeamBending], again: Rerun) -> tuple[Outcome, Resolution]:
    """How a run ended, and how well its fixed steps resolve the modes of its parts."""
    loop, status, t = ended.loop, ended.recorded.status, ended.t
    left = joint_limit_notes(ended.resolved, *ended.states[:3])
    undecided = (note for stepper in loop.parts for note in event_notes(stepper.run, stepper.events))
    closed = float(loop.diagram.engaged_t), float(loop.diagram.engaged_gap)
    postures = _posture_notes(ended, again)
    # Where events are located, all that moves is one part.
    gaps = distinct(note for met in ended.recorded.events for note in notes_of(loop.parts[0], met))
    notes = (*postures, *gaps, *bending_notes(bendings), *([loop.fault] if loop.fault else []), *left, *undecided)
    failed_at = ((part, met) for part in loop.parts for met in reversed(ended.recorded.events))
    failure = next((found for part, met in failed_at if (found := failure_of(part, met)) is not None), None)
    if status < 0 and failure is not None:
        return replace(failure, notes=(*failure.notes, *notes)), Resolution()
    if status == Status.ACTS_WITHOUT_END:
        return _without_end(ended, notes), Resolution()
    if status == Status.ENGAGED_APART:
        names, which = ended.layout.lock_names, int(loop.diagram.engaged)
        name = names[which] if which >= 0 else ", ".join(names)
        return engaged_apart(closed[0], closed[1], name, notes), Resolution()
    notes = (*notes, *engaging_notes(*closed))
    if ended.recorded.interrupted:
        return INTERRUPTED.outcome(t, notes), Resolution()
    if status == Status.CALLBACK_FAILED:
        raised = raised_where(loop.failure) if loop.failure else "an exception"
        reason, advice = f"block '{loop.failed_block}' raised {raised}", "call it by itself; outcome.failure"
        return Outcome("input failed", t, reason, advice, notes, loop.failure), Resolution()
    fault = (loop.fault or _signal_fault(ended)) if status < 0 and status != Status.BEYOND_THEORY else ""
    if fault:
        return ENDS[Status.CALLBACK_FAILED].outcome(t, bending_notes(bendings), fault), Resolution()
    failed, modes = status in (Status.DIVERGED, Status.BEYOND_THEORY), Resolution()
    for i, settings in enumerate(ended.settings):
        steps = _resolution(ended, i, failed)
        mode, modes = steps.worst, modes.and_then(steps)
        if mode is not None:
            notes = (*notes, step_size_note(mode, settings.method, _stepped(ended, settings).dt))
            if failed and mode.amplified:
                reason = past_stability(settings.method.name)
                return Outcome("diverged", t, reason, remedy(mode, settings.method), notes), modes
    worst, limit = largest_bending(bendings), min((settings.beam_limit for settings in ended.settings), default=0.0)
    if worst is not None and (status == Status.BEYOND_THEORY or (status >= 0 and worst.error > limit)):
        return beyond_theory(worst, limit, (*postures, *notes[len(postures) + len(bending_notes(bendings)) :])), modes
    if status == Status.FINISHED:
        t = float(loop.diagram.t_end)
    return ENDS[status].outcome(
        t, notes, f"{int(loop.diagram.steps)} steps" if status == Status.FINISHED else ""
    ), modes


def _stepped(ended: Ended, settings: Settings) -> Settings:
    """Settings with the step that was taken: steps end at instants, too."""
    return replace(settings, dt=min(settings.dt, ended.spacing))


def _part_run(ended: Ended, part: int, settings: Settings, steps: float, rows: Numbers | slice = _ALL) -> ExaminedRun:
    """The run of one part as an ExaminedRun with this many steps, at least one, and with some of the records."""
    (t, q, v, u), place = (x[rows] for x in ended.states), ended.layout.parts[part]
    states = (t, q[:, place.q], v[:, place.v], u)
    return ExaminedRun(ended.loop.parts[part], settings, (states[1][0], states[2][0]), states, max(1, round(steps)))


def _resolution(ended: Ended, part: int, failed: bool) -> Resolution:
    """How well the fixed steps of a part resolve its modes, under the inputs held at each state.

    Where events change parameters, the records under each of their values by themselves, those of the most common ones.
    """
    settings = _stepped(ended, ended.settings[part])
    if not len(ended.states[0]) or settings.adaptive:
        return Resolution()
    steps = ((settings.t_end if failed else ended.t) - settings.t0) / settings.dt
    stepper, (t, _, _, u) = ended.loop.parts[part], ended.states
    if not ended.layout.kept:
        return examine_steps(_part_run(ended, part, settings, steps))
    _, of, counts = np.unique(u[:, _kept(ended.layout)], axis=0, return_inverse=True, return_counts=True)
    found = Resolution()
    for group in np.argsort(-counts, kind="stable")[:_GROUPS]:
        rows = np.flatnonzero(of.reshape(-1) == group)
        stepper.set_parameters(ended.layout.present(ended.par, u[rows[0]]))
        own = replace(settings, t0=float(t[rows[0]]))
        found = found.and_then(examine_steps(_part_run(ended, part, own, steps * len(rows) / len(t), rows)))
    return found


def _kept(layout: Layout) -> list[int]:
    """Inputs that remember the parameters which events change."""
    return [i for of in layout.kept.values() for i in of.memory.range]


def _posture_notes(ended: Ended, again: Rerun) -> list[str]:
    """Notes on singular postures that the parts passed through or came close to.

    Where constraints engage or release on the way, their rank changes at any posture, and each part of the run in which
    the same ones hold is looked at by itself.
    """
    phases = _phases(ended)
    notes: list[str] = []
    for i, settings in enumerate(ended.settings):
        for rows in phases:
            with suppress(SymofrosError):  # Conditions that a block makes depend on speeds have no strength by posture.
                between = partial(_between, ended, again, settings, ended.layout.parts[i], rows.start)
                run = _part_run(ended, i, settings, int(ended.loop.diagram.steps), rows)
                notes += constraint_notes(run, between) if len(phases) == 1 else _phase_notes(ended, run, between)
    return list(distinct(notes))


def _between(
    ended: Ended, again: Rerun, settings: Settings, place: Part, begin: int, first: int, last: int
) -> States | None:
    """The motion of a part between two records, counted from the one that a phase begins with, in short steps."""
    t = ended.states[0][begin:]
    apart = float(t[last] - t[first]) / MAX_BETWEEN
    dt = apart if settings.adaptive else min(apart, settings.dt)
    along = None if settings.realtime else again(RerunSpan(float(t[first]), float(t[last]), apart, dt))
    if along is None or along[0][-1] < t[last] - apart:
        return None
    return [along[0], along[1][:, place.q], along[2][:, place.v], along[3]]


def _phases(ended: Ended) -> list[slice]:
    """The records between which no constraint engages or releases and no parameter changes: the longest such parts."""
    u = ended.states[3][:, [*ended.layout.lock_inputs, *_kept(ended.layout)]]
    begins = [0, *(1 + np.flatnonzero((np.diff(u, axis=0) != 0.0).any(axis=1))).tolist(), len(u)]
    parts = [slice(first, end) for first, end in pairwise(begins) if end > first]
    return sorted(sorted(parts, key=lambda part: part.start - part.stop)[:_PHASES], key=lambda part: part.start)


def _phase_notes(ended: Ended, run: ExaminedRun, between: Callable[[int, int], States | None]) -> list[str]:
    """Note on a singular posture that a part came close to in one phase, of whose constraints no rank is counted."""
    model, states = run.model, run.states
    if not model.nc:
        return []
    par, some = ended.layout.present(ended.par, states[3][0]), [x[:: max(1, len(x) // _SOME)] for x in states]
    (G,) = model.evaluate("constraint_jacobian", q=some[1], u=some[3], par=par, t=some[0])
    return near_singular_notes(nearest_to_singular(model, states, par, regular_rank(G), between))


def _signal_fault(ended: Ended) -> str:
    """A signal that is not finite though all states are, in words; "" where there is none."""
    loop, layout = ended.loop, ended.layout
    q, v, t = np.zeros(len(layout.q0)), np.zeros(len(layout.v0)), ended.t
    for stepper, part in zip(loop.parts, layout.parts, strict=True):
        t, q[part.q], v[part.v] = stepper.evaluation_point
    return fault_at(ended.resolved, ended.par, (t, q, v), loop.held)
