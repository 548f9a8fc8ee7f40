"""A run's last status -> its Outcome, with what was met on the way."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.beams import BeamBending, bending_notes, largest_bending
from symofros.simulation.analysis.beam_theory import amplified_in_motion
from symofros.simulation.analysis.singular_mass import ADVICE, singular_mass
from symofros.simulation.results.ends import ENDS, INTERRUPTED, beyond_theory, past_stability
from symofros.simulation.results.examination.constraint_faults import constraint_notes, jump, lost_energy, violation
from symofros.simulation.results.examination.energy_balance import EXPLODED
from symofros.simulation.results.examination.input_faults import input_failure, input_fault
from symofros.simulation.results.examination.repetition import shorter_steps_that_go_on
from symofros.simulation.results.examination.run import ExaminedRun
from symofros.simulation.results.examination.state_notes import state_notes
from symofros.simulation.results.examination.step_size import examine_run, remedy
from symofros.simulation.results.outcome import Kind, Outcome
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.loops import Recorded
from symofros.simulation.stepping.resolution import Mode
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper

# A step this short, relative to the run, is creeping.
_CREEP = 1e-8


def diagnose(
    stepper: Stepper, recorded: Recorded, states: Sequence[Array], settings: Settings, start: tuple[Array, Array]
) -> tuple[Outcome, tuple[BeamBending, ...]]:
    """How a run ended, and the bending of its beams.

    Args:
        stepper: Stepper at its last state.
        recorded: Record of the run.
        states: All that it recorded: t (n), q, v, u. Ends of steps serve instead where these are more.
        settings: Settings of the run.
        start: Initial q, v.
    """
    recorded_states = tuple(states)
    if settings.every != 1 and not stepper.method.family.multistep:
        kept = stepper.diagnostic_states()
        states = kept if len(kept[0]) > min(1, len(states[0])) else states
    bendings = amplified_in_motion(stepper.bendings, stepper.amplified_bendings, stepper.model, states, stepper.par)
    status = recorded.status
    run = ExaminedRun(stepper, settings, start, states, int(stepper.run.steps), recorded=recorded_states)
    noted = () if status == Status.BEYOND_THEORY else bendings  # Else the reason says it.
    notes = (*_notes_on_the_way(run), *bending_notes(noted), *_pace_notes(run))
    fault = input_fault(stepper) if status < 0 else ""
    return outcome_of(run, status, bendings, notes, fault, interrupted=recorded.interrupted), bendings


def diagnose_one(
    run: ExaminedRun, status: int, bendings: tuple[BeamBending, ...], fault: str, *, interrupted: bool
) -> Outcome:
    """Outcome of a run of a batch, without the counts that only a single stepper has.

    Args:
        run: The run; its stepper is at the last state.
        status: Its last Status.
        bendings: Bending of its beams.
        fault: Input that is no number, in words; "" for none.
        interrupted: Whether Ctrl-C ended it.
    """
    noted = () if status == Status.BEYOND_THEORY else bendings
    notes = (*_notes_on_the_way(run), *bending_notes(noted))
    return outcome_of(run, status, bendings, notes, fault, interrupted=interrupted)


@dataclass(frozen=True)
class _End:
    """A run at its end.

    Attributes:
        run: The run, its stepper at its last state.
        status: Status of the stepper.
        interrupted: Whether Ctrl-C ended it.
        most_bent: The beam that bends most, if there is one.
        notes: Notes of the run.
        fault: Input that is no number, in words; "" for none.
        failed: Whether the states themselves are wrong.
        mode: Mode of the motion that the step follows worst, if one was looked for.
    """

    run: ExaminedRun
    status: int
    interrupted: bool
    most_bent: BeamBending | None
    notes: tuple[str, ...]
    fault: str
    failed: bool
    mode: Mode | None

    @property
    def stepper(self) -> Stepper:
        """Stepper of the run."""
        return self.run.stepper

    @property
    def settings(self) -> Settings:
        """Settings of the run."""
        return self.run.settings

    def outcome(self, kind: Kind, reason: str, advice: str = "") -> Outcome:
        return Outcome(kind, self.stepper.t, reason, advice, self.notes)

    def by_status(self, reason: str = "") -> Outcome:
        """The outcome that its status stands for, with a more specific reason."""
        return ENDS[self.status].outcome(self.stepper.t, self.notes, reason)


def outcome_of(
    run: ExaminedRun,
    status: int,
    bendings: tuple[BeamBending, ...],
    notes: tuple[str, ...],
    fault: str,
    *,
    interrupted: bool,
) -> Outcome:
    """Outcome of a run, after an examination of its steps; arguments as of `diagnose_one`, and the notes so far."""
    failed = status in (Status.DIVERGED, Status.BEYOND_THEORY) and not fault
    meant = replace(run, steps=_steps_meant(run.settings)) if failed else run
    mode, remarks = examine_run(meant, ended_well=status >= 0, failed=failed) if meant.steps else (None, ())
    notes, most_bent = (*notes, *remarks), largest_bending(bendings)
    end = _End(run, status, interrupted, most_bent, notes, fault, failed, mode)
    explanations = (_stopped, _without_direction, _grown, _stuck, _beyond_theory, _unfinished, _violating)
    for said in explanations:
        outcome = said(end)
        if outcome is not None:
            return outcome
    return end.by_status(f"{run.steps} steps of {run.settings.method.name}" if status >= 0 else "")


def _stopped(end: _End) -> Outcome | None:
    """Outcome of a run stopped by Ctrl-C, a terminal event or an invalid input; None otherwise."""
    failure = end.stepper.failure
    if end.interrupted or isinstance(failure, KeyboardInterrupt):
        return INTERRUPTED.outcome(end.stepper.t, end.notes)
    if end.status == Status.TERMINAL_EVENT:
        return end.by_status(f"event '{end.stepper.events[end.stepper.run.terminal_event].name}'")
    if end.fault:
        return end.outcome(
            "input failed",
            end.fault,
            "inputs that are finite, quaternions among them of unit length, at all times and states of the run",
        )
    if end.status == Status.CALLBACK_FAILED:
        return replace(end.outcome("input failed", *input_failure(failure)), failure=failure)
    return None


def _without_direction(end: _End) -> Outcome | None:
    """Outcome of a run that ends at a posture in which a row of G is discontinuous; None otherwise."""
    turning = jump(end.stepper, end.status)
    if turning is None:
        return None
    counted = end.status == Status.ENERGY_LOST and end.stepper.run.kinetic_energy > 0.0
    lost = f"; {lost_energy(end.stepper)}" if counted else ""
    return end.outcome(
        "singular",
        f"'{turning.name}' has no definite direction here: its row of G changes at once, by {turning.turn:.3g}"
        f" of its size{lost}",
        "end the run by a terminal event before it; a disc that lies flat, for example, has no lowest point",
    )


def _grown(end: _End) -> Outcome | None:
    """Outcome of a run whose states have grown without bound; None otherwise."""
    settings = end.settings
    if end.status != Status.DIVERGED and not end.failed:
        return None
    _, q, v = end.stepper.state
    if end.failed and end.mode is not None and end.mode.amplified:
        reason = f"{past_stability(settings.method.name)}; {_largest(end.stepper, q, v)}"
        return end.outcome("diverged", reason, remedy(end.mode, settings.method))
    if end.status != Status.DIVERGED:
        return None
    massless = _massless(end.stepper, end.run.start, q, v)
    if massless:
        return too_long(end.run, end.outcome("singular", massless, ADVICE))
    return end.by_status(f"{ENDS[end.status].reason}; {_largest(end.stepper, q, v)}")


def _stuck(end: _End) -> Outcome | None:
    """Outcome of a run that ends singular, at too small a step, off its constraints or with energy lost; else None."""
    settings, stepper = end.settings, end.stepper
    if end.status in (Status.SINGULAR, Status.NO_CONVERGENCE):
        return too_long(end.run, end.by_status())
    if end.status == Status.STEP_TOO_SMALL:
        bounds = f"rtol = {settings.rtol:g}, atol = {settings.atol:g} ask for steps below rounding"
        return end.by_status(f"{bounds}; {_largest(stepper, *stepper.state[1:])}")
    if end.status == Status.PROJECTION_FAILED:
        t_open, q_open, _ = stepper.evaluation_point
        phi = stepper.model.constraint(q_open, u=stepper.inputs_now, par=stepper.par, t=t_open)
        worst = int(np.argmax(np.where(np.isnan(phi), math.inf, np.abs(phi))))
        name = stepper.model.names.constraints[worst]
        return end.by_status(f"'{name}' is off by {abs(phi[worst]):.3g} and projection does not mend it")
    lost = lost_energy(stepper) if stepper.run.kinetic_energy > 0.0 else ""  # A run of a batch has not counted it.
    return end.by_status(lost) if end.status == Status.ENERGY_LOST else None


def too_long(run: ExaminedRun, outcome: Outcome) -> Outcome:
    """An outcome that says of fixed steps that they are too long, where shorter ones go on; else the same."""
    said = shorter_steps_that_go_on(run, outcome.t)
    if not said:
        return outcome
    return replace(
        outcome, kind="diverged", reason=f"{said}, where {outcome.reason}", advice=ENDS[Status.DIVERGED].advice
    )


def _beyond_theory(end: _End) -> Outcome | None:
    """Outcome of a run with a beam bent further than its theory holds; None otherwise."""
    most_bent, limit = end.most_bent, end.settings.beam_limit
    if most_bent is None:
        return None
    if end.status != Status.BEYOND_THEORY and not (end.status >= 0 and most_bent.error > limit):
        return None
    return beyond_theory(most_bent, limit, end.notes, end.stepper.t)


def _unfinished(end: _End) -> Outcome | None:
    """After the most steps."""
    run, settings = end.stepper.run, end.settings
    if end.status != Status.RUNNING or not end.stepper.t < float(run.t_end):
        return None
    done, h = f"max_steps: {end.run.steps} steps are done", float(run.next_step)
    if settings.adaptive and 0.0 < h < _CREEP * (settings.t_end - settings.t0):
        look = "look for a singular posture or a force that has no bound here; for stiff models, an implicit method"
        return end.outcome("interrupted", f"{done}, and the next would be {h:.2g} s long", look)
    return end.outcome("interrupted", done)


def _violating(end: _End) -> Outcome | None:
    """Outcome of a run in which a condition on speeds was violated; None otherwise."""
    broken = violation(end.run)
    if broken is None:
        return None
    return replace(
        end.outcome(
            "constraints lost",
            f"from here on '{broken.name}' is not kept: G v - b is {broken.share:.3g} of coefficient times speed",
            "stabilisation='projection'; a smaller step; look for a posture in which the constraints are singular",
        ),
        t=broken.t,
    )


def _steps_meant(settings: Settings) -> int:
    """Number of fixed steps to the end asked for."""
    return max(1, round((settings.t_end - settings.t0) / settings.dt)) if settings.dt > 0.0 else 1


def _massless(stepper: Stepper, start: tuple[Array, Array], q: Array, v: Array) -> str:
    """The motion that moves no mass at the start or at the last state, in words; "" where all do.

    A last state whose speeds have exploded says nothing of the mechanism.
    """
    sane = EXPLODED * (1.0 + float(np.abs(start[1]).max(initial=0.0)))
    states = [start[0], *([q] if float(np.abs(v).max(initial=0.0)) < sane else [])]
    said = (singular_mass(stepper.model, state, stepper.par, stepper.inputs_now) for state in states)
    return next((words for words in said if words), "")


def _largest(stepper: Stepper, q: np.ndarray, v: np.ndarray) -> str:
    sizes = np.abs(v)
    if not len(sizes):
        return "there are no speeds"
    worst = int(np.argmax(np.where(np.isfinite(sizes), sizes, math.inf)))
    return f"the fastest speed is '{stepper.model.names.v[worst]}', {v[worst]:.3g}"


def _notes_on_the_way(run: ExaminedRun) -> tuple[str, ...]:
    """Notes on postures that the run passed, and on states that it recorded."""
    return (*constraint_notes(run), *state_notes(run.model, run.states, run.stepper.par))


def _pace_notes(examined: ExaminedRun) -> list[str]:
    """Note on steps that began late, for runs in real time, if there are any."""
    run = examined.stepper.run
    if not run.late_steps:
        return []
    return [f"{run.late_steps} of {run.paced_steps} steps began late, by {1e3 * run.late_max:.3g} ms at most"]
