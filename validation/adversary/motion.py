"""Runs against finer runs: what attacks on simulations have in common."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import symofros as sf
from validation.adversary.attack import Verdict, compared, refused, undecided, worst
from validation.mechanics.geometry import Array

# Notes on fixed steps begin where modes err by a tenth of the speed in sum, estimated at a few states (section 8 of
# docs/theory/simulation.md), which is right within a factor of three.
UNNOTED = 0.3
# Share of the largest kinetic energy that may come or go in a run of a conservative mechanism without a word: what such
# an error of the speed makes of it.
UNNOTED_ENERGY = 2.0 * UNNOTED
# Share by which the sensitive motion's start is moved, and growth of that from which no step would follow the motion.
MOVED, SENSITIVE = 1e-6, 1e3
# Adaptive steps of the finer run; with them the errors are far below those that are asked about.
FINE: dict[str, Any] = {"method": "dop853", "rtol": 1e-10, "max_steps": 40_000}


def claimed_good(run: sf.Trajectory) -> bool:
    """Whether the run says that all is well: an outcome that is ok, without a note."""
    return run.outcome.ok and not run.outcome.notes


def against_finer(
    model: sf.Model, run: sf.Trajectory, par: Array, size: float, start: tuple[Array, Array] | None = None
) -> Verdict:
    """The last speeds of a run against a finer one's, in the norm of the kinetic energy.

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
    t_end = float(run.t[-1])
    fine = sf.simulate(model, q, v, t_end, par=par, atol=1e-12 * size, **FINE)
    moved = sf.simulate(model, q, v * (1.0 + MOVED), t_end, par=par, atol=1e-12 * size, **FINE)
    if not (fine.outcome.ok and moved.outcome.ok):
        return undecided(f"finer run: {fine.outcome}")
    M = model.mass_matrix(fine.q[-1], par=par)
    largest = float(np.sqrt(2.0 * fine.kinetic_energy.max()))

    def norm(difference: Array) -> float:
        return math.sqrt(max(float(difference @ M @ difference), 0.0))

    if fine.outcome.notes:  # A singular posture leads on in more than one way.
        other = sf.simulate(model, q, v, t_end, par=par, atol=1e-10 * size, **{**FINE, "rtol": 1e-8})
        if not other.outcome.ok or norm(other.v[-1] - fine.v[-1]) > 0.1 * UNNOTED * largest:
            return undecided(f"finer runs lead to different ends: {fine.outcome}")
    if norm(moved.v[-1] - fine.v[-1]) > SENSITIVE * MOVED * largest:
        return undecided("the motion is sensitive to where it begins")
    claim = f"'{run.outcome}', without a note"
    verdict = compared("error of the last speeds", norm(run.v[-1] - fine.v[-1]), UNNOTED * largest, claim)
    return worst(verdict, balanced(run))


def balanced(run: sf.Trajectory) -> Verdict:
    """The energy of a run of a conservative mechanism."""
    change, largest = float(np.ptp(run.energy)), float(run.kinetic_energy.max())
    claim = f"'{run.outcome}', without a note"
    return compared("energy that came or went", change, UNNOTED_ENERGY * largest + 1e-300, claim)
