"""Base parameters: the combinations of inertial parameters that motion reveals (docs/theory/rigid.md, section 4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from symofros.base.arguments import checked
from symofros.errors import ArgumentError, Problem
from symofros.runtime.calls.kernel import Array
from symofros.runtime.model import Model

# Of the largest pivot: what is left of a column that others determine.
_RANK = 1e-9
# Of the largest column: smaller ones are zero but for rounding.
_ROUNDING = 1e-12
# Largest number of samples and seed.
_MOST = 1_000_000


@dataclass(frozen=True)
class BaseParameters:
    """M a + h = Y pi = Y[:, independent] (combine pi).

    Attributes:
        independent: Columns of Y that are linearly independent (b).
        combine: The base parameters from all parameters (b, 10 links).
    """

    independent: tuple[int, ...]
    combine: Array


@checked
def base_parameters(model: Model, samples: int | None = None, seed: int = 0) -> BaseParameters:
    """Find the base parameters of a rigid tree by a pivoted factorisation of its regressor at random states.

    Args:
        model: Model that has the function `regressor`.
        samples: Random states; by default three equations for each parameter.
        seed: Seed of the random states.
    """
    model = model.with_precision("double")
    for name, value, least in (("samples", samples, 1), ("seed", seed, 0)):
        if value is not None and not least <= value <= _MOST:
            what, rule = f"base_parameters: {name} is out of range", f"{least} <= {name} <= {_MOST}"
            raise ArgumentError(Problem(what, f"{value:g}" if value < _MOST else "more", rule, "leave it out"))
    rng = np.random.default_rng(seed)
    columns = 10 * (model.regressor(model.neutral(), np.zeros(model.nv), np.zeros(model.nv)).shape[-1] // 10)
    count = samples or max(20, 3 * columns // model.nv)
    states = [model.random_state(rng) for _ in range(count)]
    q, v = (np.array(x) for x in zip(*states, strict=True))
    Y = model.regressor(q, v, rng.normal(size=v.shape)).reshape(-1, columns)
    scale = np.abs(Y).max(axis=0)
    seen = np.flatnonzero(scale > _ROUNDING * scale.max(initial=0.0))
    order = _independent(Y[:, seen] / scale[seen])
    independent = sorted(int(seen[i]) for i in order)
    combine, *_ = np.linalg.lstsq(Y[:, independent], Y, rcond=None)
    combine[np.abs(combine) < _RANK] = 0.0
    return BaseParameters(tuple(independent), np.asarray(combine, dtype=np.float64))


def _independent(Y: Array) -> list[int]:
    """Columns in the order of a Gram-Schmidt process that takes each column that brings something new."""
    independent: list[int] = []
    basis: list[Array] = []
    for i in range(Y.shape[1]):
        left = Y[:, i].copy()
        for _ in range(2):
            for b in basis:
                left -= (b @ left) * b
        size = float(np.linalg.norm(left))
        if size > _RANK * float(np.linalg.norm(Y[:, i])):
            independent.append(i)
            basis.append(left / size)
    return independent
