"""Base parameters: the combinations of inertial parameters that motion reveals (docs/theory/rigid.md, section 4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symofros.base.arguments import checked
from symofros.base.arrays import Array
from symofros.errors import ArgumentError, Problem
from symofros.runtime.model import JointTerm, Model

# Of the largest pivot: what is left of a column that others determine.
_RANK = 1e-9
# Of the largest column: smaller ones are zero but for rounding.
_ROUNDING = 1e-12
# Share of the largest effort that is left, worth a note.
_LEFT_OUT = 1e-6
# Largest number of samples and seed.
_MOST = 1_000_000


@dataclass(frozen=True)
class BaseParameters:
    """M a + h = Y pi = Y[:, independent] (combine pi).

    Attributes:
        independent: Columns of Y that are linearly independent (b).
        combine: The base parameters from all parameters (b, columns).
        columns: Names of all parameters, in the order of the columns of Y: `Model.regressor_columns`.
        notes: Remarks: a share of M a + h that no parameters give, as Y has no columns of armatures, rotors and beams.
    """

    independent: tuple[int, ...]
    combine: Array
    columns: tuple[str, ...]
    notes: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Each base parameter as a sum of parameters (b): "mx(upper) + 0.4 m(lower)", the independent one first.

        Coefficients carry units: 0.4 m before a mass is a first moment.
        """
        return tuple(self._sum(row, first) for row, first in zip(self.combine, self.independent, strict=True))

    def _sum(self, row: Array, first: int) -> str:
        others = (int(k) for k in np.flatnonzero(row) if k != first)
        text = ""
        for k in (first, *others):
            size = f"{abs(row[k]):.6g}"
            term = self.columns[k] if size == "1" else f"{size} {self.columns[k]}"
            sign = "-" if row[k] < 0.0 else "+"
            text += f" {sign} {term}" if text else term if sign == "+" else f"-{term}"
        return text

    def __str__(self) -> str:
        """One line a base parameter, and the remarks."""
        return "\n".join((*self.names, *self.notes))


@checked
def base_parameters(
    model: Model, samples: int | None = None, seed: int = 0, joint_terms: Sequence[JointTerm] = ()
) -> BaseParameters:
    """Find the base parameters of a rigid tree by a pivoted factorisation of its regressor at random states.

    `print(sf.base_parameters(model))` names them: the combinations of masses, first and second moments that motions and
    efforts of the joints reveal, which are all that an experiment can identify.

    Args:
        model: Model that has the function `regressor`.
        samples: Random states; by default three equations for each parameter.
        seed: Seed of the random states.
        joint_terms: Terms of the joints that are parameters as well: "viscous", "coulomb", "armature" of
            `Model.regressor`.

    Raises:
        ArgumentError: samples or seed is out of range, or samples are too few to tell.
    """
    model = model.with_precision("double")
    for name, value, least in (("samples", samples, 1), ("seed", seed, 0)):
        if value is not None and not least <= value <= _MOST:
            what, rule = f"base_parameters: {name} is out of range", f"{least} <= {name} <= {_MOST}"
            raise ArgumentError(Problem(what, f"{value:g}" if value < _MOST else "more", rule, "leave it out"))
    rng = np.random.default_rng(seed)
    columns = model.regressor_columns(joint_terms)
    count = samples or max(20, 3 * len(columns) // model.nv)
    states = [model.random_state(rng) for _ in range(count)]
    q, v = (np.array(x) for x in zip(*states, strict=True))
    a = rng.normal(size=v.shape)
    Y = model.regressor(q, v, a, joint_terms=joint_terms).reshape(-1, len(columns))
    scale = np.abs(Y).max(axis=0)
    seen = np.flatnonzero(scale > _ROUNDING * scale.max(initial=0.0))
    order = _independent(Y[:, seen] / scale[seen])
    if len(order) == len(Y):
        what, rule = (
            "base_parameters: samples are too few",
            "equations outnumber base parameters, or some are missed",
        )
        found = f"{count} samples give {len(Y)} equations, all independent"
        raise ArgumentError(Problem(what, found, rule, "more samples, or leave it out"))
    independent = sorted(int(seen[i]) for i in order)
    combine, *_ = np.linalg.lstsq(Y[:, independent], Y, rcond=None)
    combine[np.abs(combine) < _RANK] = 0.0
    notes = _left_out_notes(model, (q, v, a), Y[:, independent])
    return BaseParameters(tuple(independent), np.asarray(combine, dtype=np.float64), columns, notes)


def _left_out_notes(model: Model, states: tuple[Array, Array, Array], Y: Array) -> tuple[str, ...]:
    """A note on efforts at the samples (count nv) that no base parameters give (count nv, b)."""
    if not (model.has("mass_matrix") and model.has("bias")):
        return ()
    q, v, a = states
    efforts = (np.einsum("...ij,...j->...i", model.mass_matrix(q), a) + model.bias(q, v)).ravel()
    missed = float(np.abs(efforts - Y @ np.linalg.lstsq(Y, efforts)[0]).max(initial=0.0))
    share = missed / max(float(np.abs(efforts).max(initial=0.0)), 1e-300)
    if share <= _LEFT_OUT:
        return ()
    return (
        f"no parameters give all of M a + h: {100.0 * share:.2g} % of the largest effort is left; armatures have"
        " columns by joint_terms=('armature',), gyroscopic moments of rotors and beams have none",
    )


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
