"""What went wrong with the constraints of a run: rows not continuous, energy taken, conditions not kept."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from symofros.errors import SymofrosError
from symofros.simulation.analysis.kinematics.postures import (
    MAX_BETWEEN,
    Jump,
    Violation,
    jump_ahead,
    nearest_to_singular,
    worst_violation,
)
from symofros.simulation.results.examination.finer_steps import States
from symofros.simulation.results.examination.run import ExaminedRun
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper

# Ends at which the constraints themselves may have failed; an adaptive method that creeps towards such a posture is
# interrupted by max_steps.
_SINGULAR_ENDS = (
    Status.ENERGY_LOST,
    Status.DIVERGED,
    Status.SINGULAR,
    Status.STEP_TOO_SMALL,
    Status.NO_CONVERGENCE,
    Status.PROJECTION_FAILED,
    Status.RUNNING,
)
# The states of a motion between two records, by their numbers, in short steps; None where that is not known.
Between = Callable[[int, int], States | None]
# Share of its terms by which a condition is violated that is not kept.
_VIOLATED = 0.1


def jump(stepper: Stepper, status: int) -> Jump | None:
    """A condition whose row of G is not continuous about the last state of a run that has failed."""
    if status not in _SINGULAR_ENDS or not stepper.model.nc:
        return None
    t, q, v = stepper.state
    if not t < float(stepper.run.t_end) or not (np.all(np.isfinite(q)) and np.all(np.isfinite(v))):
        return None
    return jump_ahead(stepper.model, t, q, v, stepper.inputs_now, stepper.par)


def lost_energy(stepper: Stepper) -> str:
    """Message that states the energy which projections have removed, as a share of the largest kinetic energy."""
    run = stepper.run
    share = float(run.lost_energy) / max(float(run.kinetic_energy), 1e-300)
    return f"keeping the constraints has taken {share:.3g} of the largest kinetic energy"


def violation(run: ExaminedRun) -> Violation | None:
    """The worst violation of a condition on speeds by a run; None if it is small, or if the run projects."""
    if not run.model.nc or run.settings.project:
        return None
    t, q, v, u = run.states
    try:
        worst = worst_violation(run.model, t, (q, v, u), run.stepper.par)
    except SymofrosError:  # Options.functions left out what says it.
        return None
    return worst if worst is not None and worst.share > _VIOLATED else None


def constraint_notes(examined: ExaminedRun, between: Between | None = None) -> list[str]:
    """Note on a singular posture that a run passed or came close to, if there is one.

    Args:
        examined: The run.
        between: The motion between two of its records, where the run can't be made once more by itself.
    """
    if not examined.model.nc:
        return []
    ranks, par = examined.ranks, examined.stepper.par
    if 0 <= ranks.least < ranks.most:
        return [
            f"a singular posture was passed at t = {ranks.when:.6g} s: the constraints' rank fell from"
            f" {ranks.most} to {ranks.least}"
        ]
    motion = between or partial(_short_steps, examined)
    return near_singular_notes(nearest_to_singular(examined.model, examined.states, par, ranks.most, motion))


def near_singular_notes(close: tuple[float, float] | None) -> list[str]:
    """Note on what `nearest_to_singular` found, if that is anything."""
    if close is None:
        return []
    when, share = close
    return [
        f"the constraints came close to a singular posture at t = {when:.6g} s, to {share:.1%} of their strength:"
        " compare with another step"
    ]


def _short_steps(run: ExaminedRun, first: int, last: int) -> States | None:
    """The motion between two records in short steps; None if it can't be repeated, empty if it fails as singular."""
    t, q, v, _ = run.states
    if run.settings.realtime or not run.same_inputs_again:
        return None
    part = float(t[last] - t[first]) / MAX_BETWEEN
    status, along = run.in_short_steps((t[first], q[first], v[first]), float(t[last]), part)
    return [x[:0] for x in along] if status < 0 and status in _SINGULAR_ENDS else along
