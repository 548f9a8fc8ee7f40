"""What half the step, or tighter bounds, make of a run and parts of it.

docs/theory/simulation.md, section 8.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.manifold import retract
from symofros.simulation.results.examination.run import AT_REST, MOST_STEPS, ExaminedRun, States
from symofros.simulation.stepping.resolution import TOLERANCE
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.windows import WHOLE, windows

# Differences of displacements count by this share: they are relative to how they change in the run, while coordinates
# themselves may be larger; those of energies by another: they are squares.
_POSITIONS, _ENERGIES = 3.0, 2.0
# Steps are halved up to so many times while this share of TOLERANCE is still added; fractions of the step in words.
HALVINGS, SETTLED = 4, 0.1
FRACTIONS = ("all", "half", "a quarter", "an eighth", "a sixteenth")
# Power of time with which the change in a window may grow over the run, (17b); parts that show by how much it does grow
# are so many times as long, each; the longest in steps; states that are compared in one, about; the least change.
_GROWTH, _LONGER, _REPEATED, _COMPARED, _LEAST = 2.0, 8, 20_000, 256, 1e-300
# Share of TOLERANCE below which what is to come is left at that.
_SURE = 0.3
# Fewest records that show where speeds change.
_RECORDS = 3
# Share of the largest speed that the absolute tolerance may allow as the error of a step; displacements over it that
# are a motion and not rest; share of the largest speed that is asked for instead.
_ALLOWED, _MOTION, _TIGHT = 0.1, 100.0, 1e-3


def halved_step_note(run: ExaminedRun) -> str:
    """What half the step makes of a short run with fixed steps (17), in words; nothing where it is nearly the same.

    All records are compared where these are its steps, else the last ones.
    """
    settings, states, steps = run.settings, run.states, run.steps
    if settings.adaptive or not 1 <= steps <= WHOLE or not run.model.nv:
        return ""
    h, t_end = settings.dt, float(states[0][-1])
    if not run.repeatable:
        if settings.realtime or run.stepper.method.family.multistep:
            return ""
        return (
            f"steps of {h:.4g} s were not held against half of that: the input function gives other inputs when it is"
            " asked again about a state; compare with a smaller dt"
        )
    change = before = 0.0
    for k in range(1, HALVINGS + 1):
        parts = 2**k
        status, finer = run.repeated((settings.t0, *run.start), t_end, h / parts, every=parts)
        if status < 0:
            return (
                f"steps of {h:.4g} s do not show the motion: with {FRACTIONS[k]} of that it does not come to this end;"
                " a smaller dt"
            )
        change, before = whole_change(run, states, finer), change
        if change > TOLERANCE:
            return (
                f"steps of {h:.4g} s do not determine the motion: {FRACTIONS[k]} of that changes it by"
                f" {percent(change)}; a smaller dt"
            )
        if abs(change - before) <= SETTLED * TOLERANCE:
            break
    return ""


def windows_note(run: ExaminedRun) -> str:
    """What half the step makes of windows of a longer run with fixed steps (17), in words; nothing where little."""
    settings, (t, _, v, _), h = run.settings, run.states, run.settings.dt
    if settings.adaptive or settings.realtime or run.steps <= WHOLE or len(t) < _RECORDS:
        return ""
    if not run.model.nv or not run.repeatable:
        return ""
    worst = Changed(0.0, float(t[0]), 1)
    for window in windows(t, v, h, run.steps):
        changed = window_change(run, window.first, max(1, round((window.t_end - t[window.first]) / h)))
        if changed is None:
            return (
                f"steps of {h:.4g} s do not show the motion from t = {t[window.first]:.6g} s: with half of that it does"
                " not go on; a smaller dt"
            )
        worst = max(worst, changed, key=lambda one: one.share)
    worst = added_up(run, worst)
    if not worst.share > TOLERANCE:
        return ""
    return (
        f"steps of {h:.4g} s do not determine the motion: half of that changes it by {percent(worst.share)} (seen at"
        f" t = {worst.t:.4g} s); a smaller dt"
    )


@dataclass(frozen=True)
class Changed:
    """What half the step changes in a part of a run.

    Attributes:
        share: Change of speeds or displacements, relative to those of the run.
        t: Time at which the part begins [s].
        steps: Length of the part, in steps.
    """

    share: float
    t: float
    steps: int


def window_change(run: ExaminedRun, first: int, count: int, every: int = 1) -> Changed | None:
    """What half the step changes in `count` steps from a record on; None where it does not come to their end.

    Args:
        run: The run.
        first: Number of the record.
        count: Number of steps.
        every: Number of steps between the states that are compared.
    """
    states, h = run.states, run.settings.dt
    start, t_end = [x[first] for x in states[:3]], float(states[0][first]) + count * h
    if len(states[0]) == run.steps + 1:  # a record at each step
        coarse = [x[first : first + count + 1 : every] for x in states]
    else:
        coarse = run.repeated(start, t_end, h, every=every)[1]
    status, half = run.repeated(start, t_end, 0.5 * h, every=2 * every)
    if status < 0:
        return None
    rows = slice(min(len(coarse[0]), len(half[0])))  # One of them may end with a part of `every` steps.
    return Changed(change_in_part(run, [x[rows] for x in coarse], [x[rows] for x in half]), float(start[0]), count)


def change_in_part(run: ExaminedRun, coarse: States, fine: States) -> float:
    """Largest difference of speeds and displacements, relative to the run's fastest and what that makes of time."""
    (_, q, v, _), (t, q_fine, v_fine, u) = coarse, fine
    with np.errstate(all="ignore"):  # What has exploded overflows.
        changes = v - v_fine, run.model.difference(q_fine, q)
        faster, apart = (float(run.norms(q_fine, u, x).max()) for x in changes)
    span, rounding = float(t[-1] - t[0]), run.rounding(fine)
    largest = max(run.fastest, rounding)
    reach = min(largest * span, max(run.reach, rounding * span))  # To and fro comes no farther.
    return max(_share(faster, largest), _share(apart, reach) / _POSITIONS)


def added_up(run: ExaminedRun, worst: Changed) -> Changed:
    """What the change in a window adds up to over the run, seen in ever longer parts of it from its start, (17b).

    Args:
        run: The run.
        worst: The window that half the step changes most.
    """
    if worst.share > TOLERANCE or not worst.share * (run.steps / worst.steps) ** _GROWTH > TOLERANCE:
        return worst
    before = worst
    while before.steps < run.steps:
        count = min(_LONGER * before.steps, run.steps)
        if count > _REPEATED:
            break
        changed = window_change(run, 0, count, max(1, count // _COMPARED))
        if changed is None or changed.share > TOLERANCE:
            return changed or worst
        growth = math.log(max(changed.share, _LEAST) / max(before.share, _LEAST)) / math.log(count / before.steps)
        growth = min(max(growth, 1.0), _GROWTH)  # A part that is shorter than a period may show less.
        if not max(changed.share, worst.share) * (run.steps / count) ** growth > _SURE * TOLERANCE:
            break
        before = changed
    return worst


def tolerance_note(run: ExaminedRun) -> str:
    """What an absolute tolerance that exceeds the speeds makes of a motion, in words; nothing where it does no harm."""
    settings, (t, q, v, u) = run.settings, run.states
    if not settings.adaptive or not run.model.nv or run.stepper.method.family.multistep or run.steps < 1:
        return ""
    moved, largest = float(np.abs(q - run.start[0]).max()), float(run.norms(q, u, v).max())
    inertia = math.sqrt(float(np.trace(run.metrics(q[-1:], u[-1:])[0])))  # of a unit of each speed
    if not (settings.atol * inertia > _ALLOWED * largest > 0.0 and moved > _MOTION * settings.atol):
        return ""
    if not run.repeatable:
        return ""
    begin, atol = (settings.t0, *run.start), _TIGHT * largest / inertia
    status, tight = run.repeated(begin, float(t[-1]), 0.0, max_steps=MOST_STEPS, atol=atol)
    if status == Status.FINISHED and not whole_change(run, [x[-1:] for x in run.states], tight) > TOLERANCE:
        return ""
    fastest = float(np.abs(v).max())
    return (
        f"atol = {settings.atol:.3g} bounds no error of speeds that reach {fastest:.3g} only: a tighter bound leads"
        f" elsewhere; atol below {1e-3 * fastest:.1g}"
    )


def whole_change(run: ExaminedRun, states: States, finer: States) -> float:
    """Largest difference of speeds, displacements and energies, relative to the largest of each (17), (17a).

    Args:
        run: The run.
        states: Its records; the last are compared where the finer run has other rows.
        finer: Records of the finer run.
    """
    (_, q, v), (t, q_finer, v_finer, u) = states[:3], finer
    rows = slice(None) if len(v) == len(v_finer) else slice(-1, None)
    with np.errstate(all="ignore"):  # What has exploded overflows.
        displacements = run.model.difference(np.broadcast_to(run.start[0], q_finer.shape), q_finer)
        changes = run.model.difference(q_finer[rows], q[rows]), v[rows] - v_finer[rows]
        moved, fastest = (float(run.norms(q_finer, u, x).max()) for x in (displacements, v_finer))
        apart, faster = (float(run.norms(q_finer[rows], u[rows], x).max()) for x in changes)
        rounding, span = run.rounding(finer), float(t[-1] - t[0])
        change = [_share(faster, max(fastest, rounding)), _share(apart, max(moved, rounding * span)) / _POSITIONS]
        energies = run.energies(finer)
        others = run.energies((t[rows], q[rows], v[rows], u[rows]))
        if energies is not None and others is not None:
            largest = float(np.abs(energies[1] - energies[0]).max() + energies[0].max())
            spread = max(float(energies[0].max()), float(np.ptp(energies[1])), AT_REST * largest)
            change.append(_share(float(np.abs(others[1] - energies[1][rows]).max()), spread) / _ENERGIES)
            bent = potential_norms(run, (t[rows], q_finer[rows], u[rows]), changes[0])
            change.append(_share(float(bent.max()), math.sqrt(2.0 * spread)))
    return max(change)


def potential_norms(run: ExaminedRun, states: Sequence[Array], changes: Array) -> Array:
    """Root of |V(q + x) - 2 V(q) + V(q - x)| of displacements x (n, nv): their norm x^T K x in linear motions (17a)."""
    (t, q, u), segments = states, run.model.record.segments

    def energy(x: Array) -> Array:
        return run.model.potential_energy(retract(segments, q, x), u=u, par=run.stepper.par, t=t)

    norms: Array = np.sqrt(np.abs(energy(changes) - 2.0 * energy(0.0 * changes) + energy(-changes)))
    return norms


def percent(share: float) -> str:
    """A share in words."""
    return f"{100.0 * share:.2g} %" if share < 1.0 else "more than 100 %"


def _share(part: float, whole: float) -> float:
    """Part of a whole; none of nothing."""
    return part / whole if whole > 0.0 else 0.0
