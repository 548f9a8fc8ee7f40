"""The mass matrix of a model by the shortest function that it was generated with."""

from __future__ import annotations

from symofros.base.arrays import Array
from symofros.runtime.model import ArrayLike, Model


def mass_matrix(model: Model, q: Array, v: Array, u: Array, par: ArrayLike | None, t: float) -> Array:
    """Mass matrix M (nv, nv).

    Args:
        model: Model.
        q: Configuration (nq).
        v: Speeds (nv), of which M does not depend.
        u: Inputs (nu).
        par: Run-time parameters.
        t: Time [s].

    Raises:
        SymofrosError: `Options.functions` left out what gives it.
    """
    name = "mass_matrix" if model.has("mass_matrix") else "dynamics"
    return model.evaluate(name, q=q, v=v, u=u, par=par, t=t)[0]
