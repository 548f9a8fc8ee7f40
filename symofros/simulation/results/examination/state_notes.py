"""What the recorded states of a motion show by themselves: limits of joints left, contacts beyond their geometry."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.model import Model
from symofros.simulation.analysis.kinematics.postures import limit_notes


def state_notes(model: Model, states: Sequence[Array], par: Array) -> tuple[str, ...]:
    """Notes on joint limits that were exceeded, and on contacts beyond their geometry.

    Args:
        model: Model that moved.
        states: Records t (n), q (n, nq), v (n, nv), u (n, nu).
        par: Run-time parameters (npar).
    """
    record = model.record
    limits = limit_notes(record.vectors, record.joint_limits, states[0], dict(zip("qvu", states[1:], strict=True)))
    return (*limits, *deep_contact_notes(model, states, par))


def deep_contact_notes(model: Model, states: Sequence[Array], par: Array, of: str = "") -> tuple[str, ...]:
    """Note on the ball that was deepest in a surface, if its centre was beyond that (docs/theory/rigid.md, 10.2).

    Args:
        model: Model that moved.
        states: Records as of `state_notes`.
        par: Run-time parameters (npar).
        of: What is said before the name of the contact.
    """
    names, (t, q, v, u) = model.record.contact_names, states
    if not names or not len(t) or not model.has("contact_forces"):
        return ()
    share = model.contact_forces(q, v, u, par=par, t=t).share
    if not np.any(share > 1.0):
        return ()
    i, k = np.unravel_index(np.nanargmax(share), share.shape)
    return (
        f"contact '{of}{names[k]}' is {share[i, k]:.3g} times its radius deep at t = {t[i]:.6g} s: beyond its centre a"
        " surface may push to the other side, or not at all; a larger stiffness, or a smaller dt",
    )
