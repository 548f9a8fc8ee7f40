"""Runs against finer runs: what attacks on simulations have in common."""

from __future__ import annotations

from typing import Any

import numpy as np

import symofros as sf

from ..mechanics.geometry import Array
from .attack import Verdict, compared, refused, undecided, worst

# Notes on fixed steps begin where modes err by a tenth of the speed in sum, estimated at a few states (section 8 of
# docs/theory/simulation.md), which is right within a factor of three.
UNNOTED = 0.3
# Share of the largest kinetic energy that may come or go in a run of a conservative mechanism without a word: what such
# an error of the speed makes of it.
UNNOTED_ENERGY = 2.0 * UNNOTED
# Share by which the start is moved, and growth of that up to which steps are to follow the motion: of a chaotic one the
# time until then is judged.
MOVED, SENSITIVE = 1e-6, 1e3
# Relative error of a run that deserves no note: a warning on right numbers is as wrong as none on wrong ones.
RIGHT = 1e-9
# Records, about, among which that time is found.
_RECORDS = 32
# Adaptive steps of the finer run; with them the errors are far below those that are asked about.
FINE: dict[str, Any] = {"method": "dop853", "rtol": 1e-10, "max_steps": 40_000}


def claimed_good(run: sf.Trajectory) -> bool:
    """Whether the run says that all is well: an outcome that is ok, without a note."""
    return run.outcome.ok and not run.outcome.notes


def claim_verdict(outcome: Any, quantity: str, error: float, bound: float) -> Verdict:
    """Verdict on an outcome: without notes, its error must be within the bound; with notes, it must not be exact.

    Args:
        outcome: Outcome of the run.
        quantity: Name of what was compared.
        error: Relative error.
        bound: Largest one without a note.
    """
    if not outcome.ok:
        return refused(outcome)
    if not outcome.notes:
        return compared(quantity, error, bound, f"'{outcome}', without a note")
    if error <= RIGHT:
        return compared("a note on what is right", 1.0, 0.0, f"'{outcome}'; {quantity}: {error:.3g}")
    return refused(outcome)


def against_finer(
    model: sf.Model, run: sf.Trajectory, par: Array, size: float, start: tuple[Array, Array] | None = None
) -> Verdict:
    """The last predictable speeds of a run against a finer one's, in the norm of the kinetic energy; its energy.

    Args:
        model: Model that was simulated.
        run: Run.
        par: Parameters.
        size: Size of coordinates and speeds, which tolerances are relative to.
        start: Initial q, v; those that the run recorded first if not given.
    """
    if not claimed_good(run):
        return refused(run.outcome)
    q, v = start or (run.q[0], run.v[0])
    rows = np.unique(np.linspace(0, len(run.t) - 1, min(len(run.t), _RECORDS + 1)).astype(int))
    t_end, times = float(run.t[-1]), run.t[rows]

    def finer(speeds: Array, rtol: float, atol: float) -> sf.Trajectory:
        given = {**FINE, "rtol": rtol, "atol": atol * size, "output": times}
        return sf.simulate(model, q, speeds, t_end, par=par, **given)

    fine = finer(v, FINE["rtol"], 1e-12)
    # From rest a change of the speeds is none: what looser bounds make of the motion stands for it.
    moved = finer(v * (1.0 + MOVED), FINE["rtol"], 1e-12) if np.any(v) else finer(v, 0.1 * MOVED, 0.1 * MOVED)
    if not (fine.outcome.ok and moved.outcome.ok):
        return undecided(f"finer run: {fine.outcome}")
    M = model.mass_matrix(fine.q, par=par)
    largest = float(np.sqrt(2.0 * fine.kinetic_energy.max()))

    def norms(differences: Array) -> Array:
        squares: Array = np.einsum("ni,nij,nj->n", differences, M, differences)
        return np.asarray(np.sqrt(np.maximum(squares, 0.0)))

    if fine.outcome.notes:  # A singular posture leads on in more than one way.
        other = finer(v, 1e-8, 1e-10)
        if not other.outcome.ok or norms(other.v - fine.v)[-1] > 0.1 * UNNOTED * largest:
            return undecided(f"finer runs lead to different ends: {fine.outcome}")
    last = predictable(norms(moved.v - fine.v), largest)
    claim = f"'{run.outcome}', without a note"
    error = float(norms(run.v[rows] - fine.v)[last])
    verdict = compared(f"error of the speeds at t = {times[last]:.6g} s", error, UNNOTED * largest, claim)
    return worst(verdict, balanced(run))


def predictable(growth: Array, largest: float) -> int:
    """Number of the last record before a motion has become sensitive to its start.

    Args:
        growth: Sizes of what a small change has become at each record (n).
        largest: Largest speed.
    """
    sensitive = np.flatnonzero(~(growth <= SENSITIVE * MOVED * largest))
    return max(0, int(sensitive[0]) - 1) if len(sensitive) else len(growth) - 1


def balanced(run: sf.Trajectory) -> Verdict:
    """The energy of a run of a conservative mechanism."""
    change, largest = float(np.ptp(run.energy)), float(run.kinetic_energy.max())
    claim = f"'{run.outcome}', without a note"
    return compared("energy that came or went", change, UNNOTED_ENERGY * largest + 1e-300, claim)
