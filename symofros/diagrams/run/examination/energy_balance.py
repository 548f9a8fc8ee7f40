"""The energies of a diagram's mechanisms against the work done on them (docs/theory/diagrams.md, section 7)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.run.examination.examined import Examined, before_jump
from symofros.simulation.results.examination.finer_steps import HALVINGS, SETTLED
from symofros.simulation.results.examination.paths import Numbers

# Change of energy without work, over the largest kinetic energy, that is worth a note.
_NOTED = 0.05
# Records whose power is asked for: this share of the steps, within these numbers; fewer than are evaluated by vectors,
# which is code that would be compiled for this.
_SHARE, _FEWEST, _MOST = 0.005, 64, 500
# Share of the work that a bend of the power may hide, (5).
_SMOOTH = 0.25
# Intervals, those with most energy that is not explained, that are made once more; share of that energy by which they
# must then change: what a contact between two records takes or gives stays the same.
_REPEATED, _CHANGED = 4, 0.3
# Or share of the largest kinetic energy: beside the work of a contact between records all else is small.
_CHANGED_MOTION = 0.1
# What the changes of all intervals may add up to, relative to the kinetic energy that the motion has had by then, if
# each changes as the repeated ones do: each of many contacts may give a little. Half of what errors of first order are.
_DRIFT = 0.15


def energy_note(run: Examined) -> str:
    """Energy that came or went without work (4), (5), in words; nothing where it is little or a contact's work."""
    energies, states = run.energies, run.states
    layout = energies.resolved.layout
    few = min(len(states[0]), int(min(max(_SHARE * run.steps, _FEWEST), _MOST)))
    if layout.driven or few < 3 or not layout.q:
        return ""
    rows = _rows(run, few)
    some = [x[rows] for x in states]
    with np.errstate(all="ignore"):  # What has exploded overflows.
        a = run.accelerations(rows)
        acts = _acts(run, rows)
        for name in layout.q:
            kinetic, energy = energies.of(name, some)
            # Between records at rest there was motion, too, as of a body that slides and stops: of what it lost there.
            kinetic = np.maximum(kinetic, -np.diff(energy, prepend=energy[:1]))
            power, spans = energies.powers(name, some, a), np.diff(some[0])
            gained = np.where(acts, 0.0, np.diff(energy) - 0.5 * (power[1:] + power[:-1]) * spans)
            unseen = _SMOOTH * np.abs(_bends(power, acts)) * spans
            unexplained, uncertain = np.abs(np.cumsum(gained)), np.cumsum(unseen)
            noted = _NOTED * kinetic.max()
            # Where the power bends, a small sum shows nothing: it may be what errors leave.
            if not np.any(unexplained + uncertain > noted):
                continue
            doubts = _Doubts(gained, unseen, kinetic, evident=bool(np.any(unexplained - uncertain > noted)))
            if _is_numerical(run, name, rows, doubts):
                return (
                    f"the energy of '{name}' changes by {unexplained.max():.3g} J beside the work done on it, where its"
                    f" motion has {kinetic.max():.3g} J at most: finer steps change that; a smaller dt or tighter"
                    " tolerances"
                )
    return ""


def _rows(run: Examined, few: int) -> Numbers:
    """The records that are looked at: some spread over the run, and those on both sides of actions, if not too many."""
    before, after = (index[:: max(1, math.ceil(len(index) / _MOST))] for index in run.sides)
    return np.unique(np.concatenate([np.linspace(0, len(run.states[0]) - 1, few).astype(int), before, after]))


def _acts(run: Examined, rows: Numbers) -> Array:
    """Whether something acts within each interval between records (n - 1): energy then has a cause."""
    (before, after), locks = run.sides, run.states[3][rows][:, run.layout.lock_inputs]
    begun, over = np.searchsorted(before, rows[1:], "left"), np.searchsorted(after, rows[:-1], "right")
    return np.asarray((begun > over) | (np.diff(locks, axis=0) != 0.0).any(axis=1))


def _bends(power: Array, acts: Array) -> Array:
    """Second differences of the power (n), of each interval (n - 1); where something acts, it begins anew."""
    changes = np.where(acts, 0.0, np.diff(power))
    return np.where(acts, 0.0, np.diff(changes, prepend=0.0))


@dataclass(frozen=True)
class _Doubts:
    """Energy between records that no work explains.

    Attributes:
        gained: Energy that each interval gained without work, (4) (n - 1) [J].
        unseen: Work that bends of the power may hide in each (n - 1) [J].
        kinetic: Kinetic energy at the records (n) [J].
        evident: Whether more is gained than bends may hide, (5).
    """

    gained: Array
    unseen: Array
    kinetic: Array
    evident: bool


def _is_numerical(run: Examined, name: str, rows: Numbers, doubts: _Doubts) -> bool:
    """Whether finer steps change the energy gained over the intervals in which most of it is doubtful."""
    states = run.states
    gained, kinetic = doubts.gained, doubts.kinetic
    sizes = np.maximum.accumulate(np.maximum(kinetic[1:], 1e-300))
    doubtful = np.abs(gained) if doubts.evident else np.abs(gained) + doubts.unseen
    # A contact that throws a body off makes all later intervals gain more than it did: the one that gained most beside
    # the motion before it is looked at, too.
    beside = doubtful[1:] / sizes[:-1]
    chosen = np.unique([*np.argsort(-doubtful)[:_REPEATED], *(1 + np.argsort(-beside)[:1])])
    chosen = chosen[doubtful[chosen] > 0.0]
    if not len(chosen):
        return False
    share = _CHANGED_MOTION * float(kinetic.max())
    if doubts.evident:
        share = min(_CHANGED * float(np.abs(gained[chosen]).sum()), share)
    changes = np.zeros(len(chosen))
    for level in range(1, 1 + (HALVINGS if run.h else 1)):
        before = changes.copy()
        for k, i in enumerate(chosen):
            first, last = int(rows[i]), int(rows[i + 1])
            finer = run.repeat(first, float(states[0][last]), level)
            if finer is None:
                return True
            end = before_jump(finer)
            ends = [np.stack([x[last], y[end]]) for x, y in zip(states, finer, strict=False)]
            _, energy = run.energies.of(name, ends)
            changes[k] = energy[1] - energy[0]
        if float(np.abs(changes).sum()) >= share:
            return True
        # Steps past a contact's limit of stability may throw a body back in the same way by chance: once is no proof.
        if level > 1 and float(np.abs(changes - before).sum()) <= SETTLED * share:
            break
    if not doubts.evident:
        return False
    relative = np.abs(gained) / sizes
    drift = abs(float((changes / sizes[chosen]).sum())) * float(relative.sum() / relative[chosen].sum())
    return drift >= _DRIFT
