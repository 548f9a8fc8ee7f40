"""Joints that creep at the end of a run: friction that is smooth through zero speed holds nothing at rest."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.model import Model
from symofros.simulation.analysis.friction import friction_curve
from symofros.simulation.analysis.mass_matrix import mass_matrix
from symofros.simulation.results.examination.run import ExaminedRun

# Speeds at which friction is looked at, relative to the one at the end: from far below it to far above.
_SPEEDS = np.concatenate([[0.0, 0.02], np.geomspace(1.0, 1e3, 48)])
# Share of that which a joint carries that is loaded; share of it that may be inertia in a motion that is steady.
_LOADED, _STEADY = 0.05, 0.1


def creep_note(run: ExaminedRun) -> str:
    """The joint that creeps under load at the end of a run, in words; nothing where none does.

    Friction F(v) grows from F(0) = 0 with a slope that is steep about rest. A joint whose load is less than what F
    reaches does not stick: it moves on at the speed at which F carries the load.
    """
    stepper, (t, q, v, u) = run.stepper, (x[-1:] for x in run.states)

    def acceleration() -> Array | None:
        found = stepper.accelerations(t, q, v)
        return None if found is None else found[0][0]

    return creep_note_at(run.model, [x[0] for x in (t, q, v, u)], stepper.par, acceleration) if len(v) else ""


def creep_note_at(
    model: Model, state: Sequence[Any], par: Array, acceleration: Callable[[], Array | None], of: str = ""
) -> str:
    """The joint that creeps under load at a state, in words; nothing where none does.

    Args:
        model: Model that moves.
        state: t, q (nq), v (nv), u (nu).
        par: Run-time parameters (npar).
        acceleration: Gives the accelerations (nv) there; None where there are none.
        of: What is said before the name of the joint.
    """
    t, q, v, u = state
    for i in model.record.friction_speeds:
        if not v[i]:
            continue
        curve = friction_curve(model, i, v[i] * _SPEEDS, (q, v, u), par, float(t))
        if curve is None or curve.flat < 2:  # It slides.
            continue
        a, M = acceleration(), mass_matrix(model, q, v, u, par, float(t))
        load, inertia = float(curve.carried[2]), np.inf if a is None else abs(float(M[i] @ a))
        if load > _LOADED * curve.reached and inertia < _STEADY * load:
            return (
                f"'{of}{model.names.v[i]}' ends at {v[i]:.3g}, where friction carries {load:.3g} of the"
                f" {curve.reached:.3g} that it reaches at speed: it is smooth and holds nothing at rest, so that the"
                " joint creeps; a smaller minimum_velocity lets it creep less"
            )
    return ""
