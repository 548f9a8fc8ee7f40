"""Joints that creep at the end of a run: friction that is smooth through zero speed holds nothing at rest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from symofros.errors import SymofrosError
from symofros.runtime.calls.kernel import Array
from symofros.simulation.stepping.stepper import Stepper

# Speeds at which friction is looked at, relative to the one at the end: from far below it to far above.
_SPEEDS = np.concatenate([[0.0, 0.02], np.geomspace(1.0, 1e3, 48)])
# Share of the slope at rest below which friction is taken to have reached what it gives.
_FLAT = 0.1
# Share of that which a joint carries that is loaded; share of it that may be inertia in a motion that is steady.
_LOADED, _STEADY = 0.05, 0.1


def creep_note(stepper: Stepper, states: Sequence[Array]) -> str:
    """The joint that creeps under load at the end of a run, in words; nothing where none does.

    Friction F(v) grows from F(0) = 0 with a slope that is steep about rest. A joint whose load is less than what F
    reaches does not stick: it moves on at the speed at which F carries the load.

    Args:
        stepper: Stepper of the run; its state stays.
        states: States of the run: t (n), q, v, u.
    """
    model, (t, q, v, u) = stepper.model, (x[-1:] for x in states)
    for i in model.record.friction_speeds:
        if not len(v) or not v[0, i]:
            continue
        speeds = np.repeat(v, len(_SPEEDS), axis=0)
        speeds[:, i] *= _SPEEDS
        try:
            M, _, Q = model.dynamics(np.repeat(q, len(_SPEEDS), axis=0), speeds, u, par=stepper.par, t=t)
        except SymofrosError:  # Options.functions left it out.
            return ""
        carried = np.abs(Q[:, i] - Q[0, i])
        slopes = np.diff(carried) / (abs(v[0, i]) * np.diff(_SPEEDS))
        flat = np.flatnonzero(slopes < _FLAT * slopes[0])
        if not len(flat) or flat[0] < 2:  # It slides.
            continue
        reached, load = float(carried[flat[0]]), float(carried[2])
        with stepper.preserved():
            found = stepper.accelerations(t, q, v)
        inertia = np.inf if found is None else abs(float(M[0, i] @ found[0][0]))
        if load > _LOADED * reached and inertia < _STEADY * load:
            return (
                f"'{model.names.v[i]}' ends at {v[0, i]:.3g}, where friction carries {load:.3g} of the {reached:.3g}"
                " that it reaches at speed: it is smooth and holds nothing at rest, so that the joint creeps; a smaller"
                " minimum_velocity lets it creep less"
            )
    return ""
