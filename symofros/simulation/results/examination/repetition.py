"""Runs and parts of them, repeated: with half the step, a record at each, tighter bounds.

docs/theory/simulation.md, section 8.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.manifold import retract
from symofros.simulation.inputs import Callback
from symofros.simulation.results.examination.energy_norm import energies_of, energy_norms, metrics
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.loops import run_own
from symofros.simulation.stepping.methods import METHODS, Method
from symofros.simulation.stepping.resolution import TOLERANCE
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper
from symofros.simulation.stepping.windows import WHOLE, windows

# States, about, at which a function of the user's is asked again for the inputs; share by which they may differ.
_CALLED, _SAME = 8, 1e-9
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
# Records, about, among which the fastest is looked for; fewest that show where speeds change.
_SPEEDS, _RECORDS = 64, 3
# Share of coordinates and energies that is rounding, and what an equilibrium is found to: at rest nothing else moves.
_AT_REST = 1e-11
# Share of the largest speed that the absolute tolerance may allow as the error of a step; displacements over it that
# are a motion and not rest; share of the largest speed that is asked for instead; most steps that this may take.
_ALLOWED, _MOTION, _TIGHT, _MOST = 0.1, 100.0, 1e-3, 8192


def repeatable(stepper: Stepper, settings: Settings, states: Sequence[Array]) -> bool:
    """Whether a run can be made once more: by a method without history, and with the same inputs.

    Args:
        stepper: Stepper of the run.
        settings: Settings of the run.
        states: States of the run: t (n), q, v, u.
    """
    return not stepper.method.family.multistep and same_inputs_again(stepper, settings, states)


def same_inputs_again(stepper: Stepper, settings: Settings, states: Sequence[Array]) -> bool:
    """Whether a function of the user's that gives the inputs gives the same again; True where there is none.

    It is called at some of the recorded states, the last one first, so that what it keeps of the run shows: once a run,
    whose stepper keeps the answer. In real time it is not called: what it serves may be hardware.

    Args:
        stepper: Stepper of the run.
        settings: Settings of the run.
        states: States of the run: t (n), q, v, u.
    """
    function = stepper.inputs.callback
    if function is None or settings.realtime:
        return function is None
    if stepper.same_inputs_again is None:
        stepper.same_inputs_again = _gives_again(function, states)
    return stepper.same_inputs_again


def _gives_again(function: Callback, states: Sequence[Array]) -> bool:
    """Whether a function of the user's gives the recorded inputs once more, at some of the states t (n), q, v, u."""
    t, q, v, u = (array[:: -max(1, len(array) // _CALLED)] for array in states)
    try:
        again = [np.asarray(function(float(t[i]), q[i].copy(), v[i].copy()), float) for i in range(len(t))]
    except Exception:  # Whatever it raises: the run itself has ended well.
        return False
    size = float(np.abs(u).max(initial=0.0))
    return all(row.shape == u[i].shape and np.abs(row - u[i]).max() <= _SAME * size for i, row in enumerate(again))


def repeated(
    stepper: Stepper,
    settings: Settings,
    start: tuple[float, Array, Array],
    t_end: float,
    dt: float,
    every: int = 1,
    max_steps: int | None = None,
    method: Method | None = None,
) -> tuple[int, list[Array]]:
    """Status and states of a part of a run, made once more.

    Args:
        stepper: Stepper of the run.
        settings: Settings of the run.
        start: First t, q, v.
        t_end: End [s].
        dt: Step [s]; of adaptive methods the first one, 0: found anew.
        every: Number of steps between records.
        max_steps: Number of steps after which it ends; None: no bound.
        method: Stepping method; the run's own if not given.
    """
    (t, q, v), method = start, method or stepper.method
    part = replace(settings, t0=t, t_end=t_end, dt=dt, every=every, grid=np.zeros(0), max_steps=max_steps, realtime=0.0)
    part = replace(part, method=method, project=part.project or (method != stepper.method and stepper.model.nc > 0))
    again = Stepper(stepper.model, method, stepper.inputs, (), stepper.par)
    part.apply(again)
    recorded = run_own(again, q, v, part, lambda _: None)
    return recorded.status, recorded.arrays()


def in_short_steps(
    stepper: Stepper, settings: Settings, start: Sequence[Any], t_end: float, part: float
) -> tuple[int, list[Array]]:
    """Status and states of a part of a run, made once more in steps that are no longer than `part` [s].

    Args:
        stepper: Stepper of the run; in place of a method that keeps a history another one is taken.
        settings: Settings of the run.
        start: First t, q, v.
        t_end: End [s].
        part: Longest step [s].
    """
    t, q, v = start
    method = stepper.method
    if method.family.multistep:
        method = METHODS["rodas4" if stepper.inputs.callback is None else "dopri5"]
    short, dt = (replace(settings, max_step=part), 0.0) if settings.adaptive else (settings, min(part, settings.dt))
    return repeated(stepper, short, (float(t), q, v), t_end, dt, max_steps=_MOST, method=method)


def halved_step_note(
    stepper: Stepper, settings: Settings, start: tuple[Array, Array], states: Sequence[Array], steps: int
) -> str:
    """What half the step makes of a short run with fixed steps (17), in words; nothing where it is nearly the same.

    Args:
        stepper: Stepper of the run.
        settings: Settings of the run.
        start: Initial q, v.
        states: States of the run: t (n), q, v, u; compared are all where these are its steps, else the last ones.
        steps: Number of steps.
    """
    if settings.adaptive or not 1 <= steps <= WHOLE or not stepper.model.nv:
        return ""
    t, q, v, _ = states
    h = settings.dt
    if not repeatable(stepper, settings, states):
        if settings.realtime or stepper.method.family.multistep:
            return ""
        return (
            f"steps of {h:.4g} s were not held against half of that: the input function gives other inputs when it is"
            " asked again about a state; compare with a smaller dt"
        )
    change = before = 0.0
    for k in range(1, HALVINGS + 1):
        parts = 2**k
        status, finer = repeated(stepper, settings, (settings.t0, *start), float(t[-1]), h / parts, every=parts)
        if status < 0:
            return (
                f"steps of {h:.4g} s do not show the motion: with {FRACTIONS[k]} of that it does not come to this end;"
                " a smaller dt"
            )
        change, before = _change(stepper, start[0], (t, q, v), finer), change
        if change > TOLERANCE:
            return (
                f"steps of {h:.4g} s do not determine the motion: {FRACTIONS[k]} of that changes it by"
                f" {percent(change)}; a smaller dt"
            )
        if abs(change - before) <= SETTLED * TOLERANCE:
            break
    return ""


def windows_note(stepper: Stepper, settings: Settings, states: Sequence[Array], steps: int) -> str:
    """What half the step makes of windows of a longer run with fixed steps (17), in words; nothing where little.

    Args:
        stepper: Stepper of the run.
        settings: Settings of the run.
        states: States of the run: t (n), q, v, u.
        steps: Number of steps.
    """
    if settings.adaptive or settings.realtime or steps <= WHOLE or len(states[0]) < _RECORDS:
        return ""
    if not stepper.model.nv or not repeatable(stepper, settings, states):
        return ""
    run = ExaminedRun(stepper, settings, states, steps)
    t, h = states[0], settings.dt
    worst = _Changed(0.0, float(t[0]), 1)
    for window in windows(t, states[2], h, steps):
        changed = run.changed(window.first, max(1, round((window.t_end - t[window.first]) / h)))
        if changed is None:
            return (
                f"steps of {h:.4g} s do not show the motion from t = {t[window.first]:.6g} s: with half of that it does"
                " not go on; a smaller dt"
            )
        worst = max(worst, changed, key=lambda one: one.share)
    worst = run.added_up(worst)
    if not worst.share > TOLERANCE:
        return ""
    return (
        f"steps of {h:.4g} s do not determine the motion: half of that changes it by {percent(worst.share)} (seen at"
        f" t = {worst.t:.4g} s); a smaller dt"
    )


@dataclass(frozen=True)
class _Changed:
    """What half the step changes in a part of a run.

    Attributes:
        share: Change of speeds or displacements, relative to those of the run.
        t: Time at which the part begins [s].
        steps: Length of the part, in steps.
    """

    share: float
    t: float
    steps: int


class ExaminedRun:
    """A run, parts of which are held against shorter steps.

    Args:
        stepper: Stepper of the run.
        settings: Settings of the run.
        states: States of the run: t (n), q, v, u.
        steps: Number of steps.

    Attributes:
        fastest: Largest speed of the run, in the norm of the kinetic energy.
        span: Its length [s].
    """

    def __init__(self, stepper: Stepper, settings: Settings, states: Sequence[Array], steps: int) -> None:
        self._stepper, self._settings, self._states, self._steps = stepper, settings, states, steps
        self.span = float(states[0][-1] - states[0][0])
        _, q, v, u = (x[:: -max(1, len(x) // _SPEEDS)] for x in states)
        self.fastest = float(energy_norms(stepper, q, u, v).max())
        displacements = stepper.model.difference(np.broadcast_to(states[1][0], q.shape), q)
        self._reach = float(energy_norms(stepper, q, u, displacements).max())

    def changed(self, first: int, count: int, every: int = 1) -> _Changed | None:
        """What half the step changes in `count` steps from a record on; None where it does not come to their end.

        Args:
            first: Number of the record.
            count: Number of steps.
            every: Number of steps between the states that are compared.
        """
        t, q, v, _ = self._states
        stepper, settings, h = self._stepper, self._settings, self._settings.dt
        start, t_end = (float(t[first]), q[first], v[first]), float(t[first]) + count * h
        if len(t) == self._steps + 1:  # a record at each step
            coarse = [x[first : first + count + 1 : every] for x in self._states]
        else:
            coarse = repeated(stepper, settings, start, t_end, h, every=every)[1]
        status, half = repeated(stepper, settings, start, t_end, 0.5 * h, every=2 * every)
        if status < 0:
            return None
        rows = slice(min(len(coarse[0]), len(half[0])))  # One of them may end with a part of `every` steps.
        return _Changed(self.share([x[rows] for x in coarse], [x[rows] for x in half]), start[0], count)

    def share(self, coarse: Sequence[Array], fine: Sequence[Array]) -> float:
        """Largest difference of speeds and displacements, relative to the run's fastest and what that makes of time."""
        (_, q, v, _), (t, q_fine, v_fine, u) = coarse, fine
        stepper = self._stepper
        with np.errstate(all="ignore"):  # What has exploded overflows.
            changes = v - v_fine, stepper.model.difference(q_fine, q)
            faster, apart = (float(energy_norms(stepper, q_fine, u, x).max()) for x in changes)
        span, rounding = float(t[-1] - t[0]), _rounding(stepper, fine)
        largest = max(self.fastest, rounding)
        reach = min(largest * span, max(self._reach, rounding * span))  # To and fro comes no farther.
        return max(_share(faster, largest), _share(apart, reach) / _POSITIONS)

    def added_up(self, worst: _Changed) -> _Changed:
        """What the change in a window adds up to over the run, seen in ever longer parts of it from its start, (17b).

        Args:
            worst: The window that half the step changes most.
        """
        if worst.share > TOLERANCE or not worst.share * (self._steps / worst.steps) ** _GROWTH > TOLERANCE:
            return worst
        before = worst
        while before.steps < self._steps:
            count = min(_LONGER * before.steps, self._steps)
            if count > _REPEATED:
                break
            changed = self.changed(0, count, max(1, count // _COMPARED))
            if changed is None or changed.share > TOLERANCE:
                return changed or worst
            growth = math.log(max(changed.share, _LEAST) / max(before.share, _LEAST)) / math.log(count / before.steps)
            growth = min(max(growth, 1.0), _GROWTH)  # A part that is shorter than a period may show less.
            if not max(changed.share, worst.share) * (self._steps / count) ** growth > _SURE * TOLERANCE:
                break
            before = changed
        return worst


def tolerance_note(
    stepper: Stepper, settings: Settings, start: tuple[Array, Array], states: Sequence[Array], steps: int
) -> str:
    """What an absolute tolerance that exceeds the speeds makes of a motion, in words; nothing where it does no harm.

    Args:
        stepper: Stepper of the run.
        settings: Settings of the run.
        start: Initial q, v.
        states: States of the run: t (n), q, v, u.
        steps: Number of steps.
    """
    if not settings.adaptive or not stepper.model.nv or stepper.method.family.multistep or steps < 1:
        return ""
    t, q, v, u = states
    moved, largest = float(np.abs(q - start[0]).max()), float(energy_norms(stepper, q, u, v).max())
    inertia = math.sqrt(float(np.trace(metrics(stepper, q[-1:], u[-1:])[0])))  # of a unit of each speed
    if not (settings.atol * inertia > _ALLOWED * largest > 0.0 and moved > _MOTION * settings.atol):
        return ""
    tighter = replace(settings, atol=_TIGHT * largest / inertia)
    if not repeatable(stepper, settings, states):
        return ""
    status, tight = repeated(stepper, tighter, (settings.t0, *start), float(t[-1]), 0.0, max_steps=_MOST)
    if status == Status.FINISHED and not _change(stepper, start[0], (t[-1:], q[-1:], v[-1:]), tight) > TOLERANCE:
        return ""
    fastest = float(np.abs(v).max())
    return (
        f"atol = {settings.atol:.3g} bounds no error of speeds that reach {fastest:.3g} only: a tighter bound leads"
        f" elsewhere; atol below {1e-3 * fastest:.1g}"
    )


def _change(stepper: Stepper, q0: Array, states: Sequence[Array], finer: Sequence[Array]) -> float:
    """Largest difference of speeds, displacements from q0 and energies, relative to the largest of each (17), (17a).

    Args:
        stepper: Stepper of the run.
        q0: Initial configuration (nq).
        states: Times, configurations and speeds of the run; the last are compared where the finer run has other rows.
        finer: Times, configurations, speeds and inputs of the finer run.
    """
    (_, q, v), (t, q_finer, v_finer, u) = states, finer
    rows = slice(None) if len(v) == len(v_finer) else slice(-1, None)
    with np.errstate(all="ignore"):  # What has exploded overflows.
        displacements = stepper.model.difference(np.broadcast_to(q0, q_finer.shape), q_finer)
        changes = stepper.model.difference(q_finer[rows], q[rows]), v[rows] - v_finer[rows]
        moved, fastest = (float(energy_norms(stepper, q_finer, u, x).max()) for x in (displacements, v_finer))
        apart, faster = (float(energy_norms(stepper, q_finer[rows], u[rows], x).max()) for x in changes)
        rounding, span = _rounding(stepper, (t, q_finer, v_finer, u)), float(t[-1] - t[0])
        change = [_share(faster, max(fastest, rounding)), _share(apart, max(moved, rounding * span)) / _POSITIONS]
        energies = energies_of(stepper, (t, q_finer, v_finer, u))
        others = energies_of(stepper, (t[rows], q[rows], v[rows], u[rows]))
        if energies is not None and others is not None:
            largest = float(np.abs(energies[1] - energies[0]).max() + energies[0].max())
            spread = max(float(energies[0].max()), float(np.ptp(energies[1])), _AT_REST * largest)
            change.append(_share(float(np.abs(others[1] - energies[1][rows]).max()), spread) / _ENERGIES)
            bent = _potential_norms(stepper, (t[rows], q_finer[rows], u[rows]), changes[0])
            change.append(_share(float(bent.max()), math.sqrt(2.0 * spread)))
    return max(change)


def _potential_norms(stepper: Stepper, states: Sequence[Array], changes: Array) -> Array:
    """Root of |V(q + x) - 2 V(q) + V(q - x)| of displacements x (n, nv): their norm x^T K x in linear motions (17a)."""
    (t, q, u), segments = states, stepper.model.record.segments

    def energy(x: Array) -> Array:
        return stepper.model.potential_energy(retract(segments, q, x), u=u, par=stepper.par, t=t)

    norms: Array = np.sqrt(np.abs(energy(changes) - 2.0 * energy(0.0 * changes) + energy(-changes)))
    return norms


def _rounding(stepper: Stepper, states: Sequence[Array]) -> float:
    """Speed of a motion by rounding, in the norm of the kinetic energy: a share of the coordinates a record."""
    t, q, _, u = states
    model = stepper.model
    coordinates = model.difference(model.neutral(), q[-1])[np.newaxis]
    span = float(t[-1] - t[0]) / max(1, len(t) - 1)
    return _AT_REST * float(energy_norms(stepper, q[-1:], u[-1:], coordinates)[0]) / span if span > 0.0 else 0.0


def percent(share: float) -> str:
    """A share in words."""
    return f"{100.0 * share:.2g} %" if share < 1.0 else "more than 100 %"


def _share(part: float, whole: float) -> float:
    """Part of a whole; none of nothing."""
    return part / whole if whole > 0.0 else 0.0
