"""States of analyses: configurations and inputs as they are stated, or the defaults; quaternions of unit length."""

from __future__ import annotations

import math

import numpy as np

from symofros.base.arrays import Array, numeric, vector
from symofros.errors import ShapeError, SymofrosError
from symofros.runtime.manifold import at_unit_length
from symofros.runtime.model import ArrayLike, Model


def given_configuration(model: Model, q: ArrayLike) -> Array:
    """A configuration (nq).

    Raises:
        ShapeError: It is no vector of that size, or a quaternion is no rotation.
    """
    return at_unit_length(model.record, "q", vector("q", model.by_name("q", q), model.nq))


def given_inputs(model: Model, u: ArrayLike | None) -> Array:
    """The inputs stated, (nu) or several rows of them; the defaults if none are.

    Raises:
        ShapeError: They are no numbers, or a quaternion among them is no rotation.
    """
    stated = numeric("u", model.record.u_default if u is None else model.by_name("u", u))
    if stated.shape[-1:] != (model.nu,):  # Refused by what they are for.
        return stated
    for first in model.record.quaternion_inputs:
        if not np.isfinite(stated[..., first : first + 4]).all():
            names = ", ".join(model.names.u[first : first + 4])
            what, rule = "a number that is not finite", f"{names} are a rotation"
            raise ShapeError(f"model '{model.record.name}': u is no motion", what, rule, "give finite numbers")
    return at_unit_length(model.record, "u", stated)


def prescribed_rates(model: Model, u: Array) -> Array:
    """Rates (nu) of inputs (nu) that are coordinates of prescribed motions, as u states them; zeros of others."""
    names = model.names.u
    return np.array([u[names.index(f"d{name}")] if f"d{name}" in names else 0.0 for name in names])


def check_search(what: str, tolerance: float, iterations: int = 1, *, below: float = math.inf) -> None:
    """Refuse a tolerance that nothing meets or everything does, and a number of steps that is none.

    Args:
        what: The search.
        tolerance: Bound of its errors.
        iterations: Most steps.
        below: What every error is below; 1 of relative ones.

    Raises:
        SymofrosError: It is.
    """
    if not 0.0 < tolerance < below:
        rule = f"a bound of errors is above zero and {'finite' if below == math.inf else f'below {below:g}'}"
        raise SymofrosError(f"{what}: tolerance is out of range", f"{tolerance:g}", rule, "leave it out")
    if iterations < 1:
        found, rule = f"{iterations:.6g}", "the most steps that may be taken are one or more"
        raise SymofrosError(f"{what}: iterations is out of range", found, rule, "leave it out")
