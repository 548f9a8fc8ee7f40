"""Joints that creep at the end of a run: friction that is smooth through zero speed holds nothing at rest."""

from __future__ import annotations

import numpy as np

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
    stepper, model, (t, q, v, u) = run.stepper, run.model, (x[-1:] for x in run.states)
    for i in model.record.friction_speeds:
        if not len(v) or not v[0, i]:
            continue
        curve = friction_curve(model, i, v[0, i] * _SPEEDS, (q[0], v[0], u[0]), stepper.par, float(t[0]))
        if curve is None or curve.flat < 2:  # It slides.
            continue
        with stepper.preserved():
            found = stepper.accelerations(t, q, v)
        M = mass_matrix(model, q[0], v[0], u[0], stepper.par, float(t[0]))
        load, inertia = float(curve.carried[2]), np.inf if found is None else abs(float(M[i] @ found[0][0]))
        if load > _LOADED * curve.reached and inertia < _STEADY * load:
            return (
                f"'{model.names.v[i]}' ends at {v[0, i]:.3g}, where friction carries {load:.3g} of the"
                f" {curve.reached:.3g} that it reaches at speed: it is smooth and holds nothing at rest, so that the"
                " joint creeps; a smaller minimum_velocity lets it creep less"
            )
    return ""
