"""Inputs of analyses: those stated or the defaults, quaternions among them of unit length."""

from __future__ import annotations

import numpy as np

from symofros.base.arrays import numeric
from symofros.errors import Problem, SymofrosError
from symofros.runtime.calls.kernel import Array
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.settings import UNIT_TOLERANCE


def given_inputs(model: Model, u: ArrayLike | None) -> Array:
    """The inputs stated, (nu) or several rows of them; the defaults if none are.

    Raises:
        SymofrosError: A quaternion among them is no rotation.
    """
    stated = numeric("u", model.record.u_default if u is None else model.by_name("u", u))
    refuse_no_rotation(model, stated)
    return stated


def refuse_no_rotation(model: Model, u: Array) -> None:
    """Refuse quaternions among the inputs (..., nu) that are of another length than one.

    Raises:
        SymofrosError: One is.
    """
    for first in model.record.quaternion_inputs:
        lengths = np.linalg.norm(np.atleast_1d(u)[..., first : first + 4], axis=-1).ravel()
        wrong = np.flatnonzero(~(np.abs(lengths - 1.0) <= UNIT_TOLERANCE))
        if len(wrong):
            names = ", ".join(model.names.u[first : first + 4])
            place = f" in step {wrong[0]}" if len(lengths) > 1 else ""
            raise SymofrosError(
                Problem(
                    f"model '{model.record.name}': inputs {names} are no rotation",
                    f"a quaternion of length {lengths[wrong[0]]:.6g}{place}",
                    f"quaternions are of unit length, to {UNIT_TOLERANCE:g}",
                    "divide each quaternion by its length",
                )
            )
