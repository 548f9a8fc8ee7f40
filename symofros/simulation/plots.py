"""Pictures of a trajectory, by Matplotlib (the extra `plots`)."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from symofros.errors import Problem, SymofrosError

if TYPE_CHECKING:
    from symofros.simulation.trajectory import Trajectory

_MOST = 12  # Curves in one picture; more can't be told apart.


def figure_class() -> Any:
    """Matplotlib's Figure, which needs no window.

    Raises:
        SymofrosError: Matplotlib is not installed.
    """
    try:
        return import_module("matplotlib.figure").Figure
    except ImportError:
        missing = Problem(
            "plot: Matplotlib is not installed",
            "no module matplotlib",
            "pictures are an extra",
            "pip install 'symofros[plots]'",
        )
        raise SymofrosError(str(missing)) from None


def plot(run: Trajectory, names: tuple[str, ...] = ()) -> Any:
    """A Matplotlib figure: coordinates, speeds, inputs and the change of energy over time.

    Args:
        run: What to show.
        names: Coordinates to show, with their speeds; the first dozen by default.

    Raises:
        SymofrosError: Matplotlib is not installed.
    """
    model = run.model.names
    shown_q = [i for i, name in enumerate(model.q) if not names or name in names][:_MOST]
    shown_v = [i for i, name in enumerate(model.v) if not names or name in names][:_MOST]
    rows = 4 if model.u and np.any(run.u) else 3
    figure = figure_class()(figsize=(8.0, 2.2 * rows), layout="constrained")
    axes = figure.subplots(rows, 1, sharex=True)
    for i in shown_q:
        axes[0].plot(run.t, run.q[:, i], label=model.q[i])
    for i in shown_v:
        axes[1].plot(run.t, run.v[:, i], label=model.v[i])
    axes[0].set_ylabel("coordinates [rad, m]")
    axes[1].set_ylabel("speeds [rad/s, m/s]")
    axes[2].plot(run.t, run.energy - run.energy[0], color="black", label="kinetic + potential")
    axes[2].set_ylabel("change of energy [J]")
    if rows == 4:
        for i in range(min(_MOST, run.u.shape[1])):
            axes[3].plot(run.t, run.u[:, i], label=model.u[i])
        axes[3].set_ylabel("inputs [N m, N]")
    axes[-1].set_xlabel("t [s]")
    for axis in axes:
        axis.grid(alpha=0.3)
        axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize="small")
    figure.suptitle(
        f"{run.model.record.name}: {run.statistics.method}, {run.outcome.kind} at t = {run.outcome.t:.4g} s"
    )
    return figure
