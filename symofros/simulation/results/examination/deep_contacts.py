"""Contacts beyond their geometry: balls whose centres came to lie within the solid (docs/theory/rigid.md, 10.2)."""

from __future__ import annotations

import numpy as np

from symofros.simulation.results.examination.run import ExaminedRun


def deep_contact_notes(run: ExaminedRun) -> tuple[str, ...]:
    """Note on the ball that was deepest in a surface, if its centre was beyond that."""
    model, (t, q, v, u) = run.model, run.states
    names = model.record.contact_names
    if not names or not len(t) or not model.has("contact_forces"):
        return ()
    share = model.contact_forces(q, v, u, par=run.stepper.par, t=t).share
    if not np.any(share > 1.0):
        return ()
    i, k = np.unravel_index(np.nanargmax(share), share.shape)
    return (
        f"contact '{names[k]}' is {share[i, k]:.3g} times its radius deep at t = {t[i]:.6g} s: beyond its centre a"
        " surface may push to the other side, or not at all; a larger stiffness, or a smaller dt",
    )
