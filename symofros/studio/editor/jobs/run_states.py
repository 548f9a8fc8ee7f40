"""The states of a simulated run, out of the result that the page holds."""

from __future__ import annotations

from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.model import Model
from symofros.simulation.results.outcome import Outcome
from symofros.simulation.results.trajectory import Trajectory
from symofros.studio.viewer.playing.motion import States


def states_of(run: dict[str, Any]) -> States:
    """The states of a run, whose values are null where it diverged.

    Args:
        run: Result of the simulation, as `operations.simulate` gives it, or a motion of a diagram's run.
    """
    par = np.tile(np.array(run["par"], dtype=np.float64), (len(run["t"]), 1))
    for first, values in run.get("changes", ()):
        par[first:] = values
    return States(np.array(run["t"], dtype=np.float64), _columns(run, "q"), _columns(run, "u"), par)


def trajectory_of(model: Model, run: dict[str, Any]) -> Trajectory | None:
    """A run as far as it did not diverge, as one of a model with its coordinates; None of a motion without speeds.

    Args:
        model: Model that was simulated.
        run: As of `states_of`.
    """
    v = _columns(run, "v")
    if v.shape[1] != model.nv:
        return None
    t, q, u, par = (np.asarray(values) for values in states_of(run))
    z = np.array(run["z"], dtype=np.float64).reshape(len(t), model.nz) if model.nz else np.zeros((0, 0))
    sound = [*(np.isfinite(q).all(axis=1) & np.isfinite(v).all(axis=1)), False]
    n = int(np.argmin(sound))
    changes = tuple((first, np.array(values, dtype=np.float64)) for first, values in run["changes"] if first < n)
    outcome = Outcome("finished", float(t[-1]), "")
    states = t[:n], q[:n], v[:n], u[:n]
    return Trajectory(model, *states, np.array(run["par"], dtype=np.float64), outcome, changes=changes, z=z[:n])


def _columns(run: dict[str, Any], kind: str) -> Array:
    values = [series["values"] for series in run["series"] if series["kind"] == kind]
    return np.array(values, dtype=np.float64).T.reshape(len(run["t"]), len(values))
