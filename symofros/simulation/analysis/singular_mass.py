"""Where the mass matrix of a tree is singular, as a message: which speeds move no mass, which parameters are zero."""

from __future__ import annotations

import numpy as np

from symofros.base.arrays import Array
from symofros.errors import SymofrosError
from symofros.runtime.model import ArrayLike, Model

_ROUNDING = float(np.finfo(np.float64).eps)
# Share of a speed in a motion without mass from which it is named.
_NAMED = 0.1
ADVICE = "give every speed an inertia; a mass, length or radius that is zero takes it away"


def singular_mass(model: Model, q: Array, par: ArrayLike | None = None, u: ArrayLike | None = None) -> str:
    """The motion of a tree that moves no mass in a configuration, as a text; "" where there is none.

    Constraints may bind such a motion: of models with constraints nothing is said.

    Args:
        model: Model.
        q: Configuration (nq).
        par: Run-time parameters.
        u: Inputs (nu), for prescribed motions.
    """
    if model.nc or not model.nv or not np.all(np.isfinite(q)):
        return ""
    try:
        M = model.mass_matrix(q, u=u, par=par)
    except SymofrosError:  # Options.functions left it out.
        return ""
    if not np.all(np.isfinite(M)):
        return ""
    # Each speed in units of its own inertia: a body may be light, but not weightless.
    scale = np.sqrt(np.maximum(np.diag(M), 0.0))
    names = [name for name, size in zip(model.names.v, scale, strict=True) if not size > 0.0]
    if not names:
        values, motions = np.linalg.eigh(M / np.outer(scale, scale))
        if values[0] > _ROUNDING * len(M):
            return ""
        motion = np.abs(motions[:, 0] / scale)
        names = [name for name, share in zip(model.names.v, motion, strict=True) if share >= _NAMED * motion.max()]
    shown = ", ".join(f"'{name}'" for name in names[:4]) + (", ..." if len(names) > 4 else "")
    together = "together move" if len(names) > 1 else "moves"
    given = model.parameter_values if par is None else np.asarray(model.by_name("par", par), dtype=np.float64)
    zero = [name for name, value in zip(model.names.par, given, strict=True) if value == 0.0]
    why = f"; parameters that are zero: {', '.join(zero[:6])}" if zero else ""
    return f"the mass matrix is singular: speed{'s' * (len(names) > 1)} {shown} {together} no mass{why}"
