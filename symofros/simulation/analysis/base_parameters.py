"""Base parameters: the combinations of inertial parameters that motion reveals (docs/theory/rigid.md, section 4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symofros.base.arguments import checked
from symofros.base.arrays import Array
from symofros.errors import ArgumentError, AssemblyError, ShapeError
from symofros.runtime.constrained import null_space, pseudo_inverse
from symofros.runtime.model import JointTerm, Model
from symofros.simulation.analysis.kinematics.assembly import assemble

# Of the largest pivot: what is left of a column that others determine.
_RANK = 1e-9
# Of the largest column with as high a power of length, or a lower one: smaller ones are zero but for rounding.
_ROUNDING = 1e-12
# The same on constraints, whose postures close to 1e-10: near singular ones speeds err by a thousand times that.
_RANK_CLOSED = 1e-6
# Guesses for each closed posture of a mechanism with loops.
_GUESSES = 20
# Power of length in an effort over a mass and over first moments, by the beginnings of columns' names; zero of others.
_LENGTHS = {"m": 2, "mx": 1, "my": 1, "mz": 1}
# Share of the largest effort that is left, worth a note.
_LEFT_OUT = 1e-6
# Largest number of samples and seed.
_MOST = 1_000_000
# Condition of columns of unit length, beyond which a fit bears a note. Random states give 3 to 24 for arms of two and
# six joints, sines of 1 rad and different frequencies 55 to 77, of 0.3 rad 640 to 1100.
_CONDITION = 100.0
# Share of a direction's largest entry from which on a parameter is named as part of it.
_PART = 0.3


@dataclass(frozen=True)
class Fit:
    """Base parameters of measured efforts by least squares, and how well the motion determines them.

    Attributes:
        names: Names of the base parameters (b).
        values: Their values (b); those of least size in directions that the motion does not show.
        deviations: Standard deviations that the residual's noise gives them (b); infinite where the motion does not
            determine them.
        residual: Root mean square of what is left of the efforts [N m or N], or as a multiple of the stated noise.
        condition: Ratio of the singular values of the columns at unit length, free of units; infinite where parameters
            are not determined.
        notes: Remarks: parameters that the motion does not tell apart, or does poorly.
    """

    names: tuple[str, ...]
    values: Array
    deviations: Array
    residual: float
    condition: float
    notes: tuple[str, ...] = ()

    def __str__(self) -> str:
        """One line a base parameter, and the remarks."""
        rows = zip(self.values, self.deviations, self.names, strict=True)
        return "\n".join((*(f"{value:.6g} +- {spread:.2g}  {name}" for value, spread, name in rows), *self.notes))


@dataclass(frozen=True)
class BaseParameters:
    """M a + h = Y pi = Y[:, independent] (combine pi); with constraints N^T of it, where G N = 0.

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

    @checked
    def fit(self, regressor: npt.ArrayLike, efforts: npt.ArrayLike, noise: npt.ArrayLike | None = None) -> Fit:
        """Fit the base parameters to measured efforts, by least squares, and judge the motion.

        Noise of q, v and a is not seen: it makes values smaller in size, by its share of the columns.

        Args:
            regressor: `Model.regressor` at the measured motion, with the same `joint_terms` (..., rows, columns); of
                mechanisms with loops N^T of it.
            efforts: Measured efforts (..., rows).
            noise: Standard deviation of each row's noise (rows), by which rows are weighed; one for all if left out.

        Raises:
            ShapeError: An array does not fit, or is not of finite numbers.
            ArgumentError: A noise is not above zero, or equations do not outnumber the parameters.
        """
        Y, measured = np.asarray(regressor, dtype=np.float64), np.asarray(efforts, dtype=np.float64)
        if Y.ndim < 2 or Y.shape[-1] != len(self.columns):
            raise _does_not_fit("regressor", Y.shape, f"(..., rows, {len(self.columns)})")
        if measured.shape != Y.shape[:-1]:
            raise _does_not_fit("efforts", measured.shape, str(Y.shape[:-1]))
        spread = np.ones(Y.shape[-2]) if noise is None else np.asarray(noise, dtype=np.float64)
        if spread.shape != Y.shape[-2:-1]:
            raise _does_not_fit("noise", spread.shape, str(Y.shape[-2:-1]), "one number a row of the regressor")
        if not all(np.all(np.isfinite(x)) for x in (Y, measured, spread)):
            raise ShapeError("fit: entries are not finite", "nan or inf", "numbers are finite", "drop them")
        if np.any(spread <= 0.0):
            what, rule = "fit: noise is out of range", "standard deviations are above zero"
            raise ArgumentError(what, f"{spread.min():g}", rule, "leave it out")
        b = len(self.independent)
        rows = (Y[..., self.independent] / spread[:, np.newaxis]).reshape(-1, b)
        if len(rows) <= b:
            what, found = "fit: equations are too few", f"{len(rows)} equations for {b} parameters"
            raise ArgumentError(what, found, "equations outnumber parameters", "more samples")
        return self._fitted(rows, (measured / spread).ravel())

    def _fitted(self, rows: Array, measured: Array) -> Fit:
        """The fit of weighed rows (n, b) to weighed efforts (n), by columns of unit length."""
        sizes = np.linalg.norm(rows, axis=0)
        least = _ROUNDING * _largest_comparable([self.columns[i] for i in self.independent], sizes)
        sizes = np.where(sizes > least, sizes, np.inf)
        U, singular, directions = np.linalg.svd(rows / sizes, full_matrices=False)
        shown = singular > _RANK * singular.max(initial=0.0)
        scaled = directions[shown].T @ ((U.T @ measured)[shown] / singular[shown])
        left = measured - rows @ (scaled / sizes)
        sigma = float(np.linalg.norm(left) / np.sqrt(len(rows) - np.count_nonzero(shown)))
        deviations = sigma / sizes * np.linalg.norm(directions[shown].T / singular[shown], axis=1)
        deviations[np.abs(directions[~shown]).max(axis=0, initial=0.0) > np.sqrt(_RANK)] = np.inf
        condition = float(singular[0] / singular[-1]) if shown.all() else np.inf
        residual = float(np.sqrt(np.mean(left**2)))
        notes = self._excitation_notes(directions, singular, shown)
        return Fit(self.names, scaled / sizes, deviations, residual, condition, notes)

    def _excitation_notes(self, directions: Array, singular: Array, shown: npt.NDArray[np.bool_]) -> tuple[str, ...]:
        """What the motion does not tell apart, by the directions of the columns at unit length (b, b)."""
        notes = list[str]()
        if not shown.all():
            hidden = np.abs(directions[~shown]).max(axis=0) > np.sqrt(_RANK)
            notes.append(
                f"the motion determines {np.count_nonzero(shown)} of {len(shown)} base parameters, and not"
                f" {self._listed(hidden)}: their values are those of least size; move the joints that show them"
            )
        seen = singular[shown]
        if len(seen) and (condition := seen[0] / seen[-1]) > _CONDITION:
            weakest = np.abs(directions[shown][-1])
            notes.append(
                f"the motion tells base parameters poorly apart: {self._listed(weakest > _PART * weakest.max())} have"
                f" {1.0 / seen[-1]:.3g} times the deviation of one that is fitted alone (condition {condition:.3g} of"
                " columns of unit length); larger or faster motions, of more frequencies, or fewer parameters"
            )
        return tuple(notes)

    def _listed(self, chosen: npt.NDArray[np.bool_]) -> str:
        """The first parameters of some combinations, eight at most."""
        names = [self.columns[self.independent[i]] for i in np.flatnonzero(chosen)]
        return ", ".join(names[:8]) + (f" and {len(names) - 8} more" if len(names) > 8 else "")

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
    """Find the base parameters of rigid bodies by a pivoted factorisation of their regressor at random states.

    `print(sf.base_parameters(model))` names them: the combinations of masses, first and second moments that motions and
    efforts of the joints reveal, which are all that an experiment can identify. Of a mechanism with constraints they
    are fewer: its motions keep the constraints, and of the efforts count those along the speeds that these leave free,
    N^T (M a + h), in which no multiplier stands.

    Args:
        model: Model that has the function `regressor`.
        samples: Random states; by default three equations for each parameter.
        seed: Seed of the random states.
        joint_terms: Terms of the joints that are parameters as well: "viscous", "coulomb", "armature" of
            `Model.regressor`.

    Raises:
        ArgumentError: samples or seed is out of range, or samples are too few to tell.
        AssemblyError: No postures are found that keep the constraints.
    """
    model = model.with_precision("double")
    for name, value, least in (("samples", samples, 1), ("seed", seed, 0)):
        if value is not None and not least <= value <= _MOST:
            what, rule = f"base_parameters: {name} is out of range", f"{least} <= {name} <= {_MOST}"
            raise ArgumentError(what, f"{value:g}" if value < _MOST else "more", rule, "leave it out")
    rng = np.random.default_rng(seed)
    columns = model.regressor_columns(joint_terms)
    moved = [_motion(model, rng)]
    count = samples or max(20, 3 * len(columns) // max(moved[0].along.shape[1], 1))
    moved += [_motion(model, rng) for _ in range(count - 1)]
    q, v, a = (np.array(x) for x in zip(*(motion[:3] for motion in moved), strict=True))
    along = [motion.along for motion in moved]
    Y = _along(along, model.regressor(q, v, a, joint_terms=joint_terms))
    scale = np.abs(Y).max(axis=0, initial=0.0)
    seen = np.flatnonzero(scale > _ROUNDING * _largest_comparable(columns, scale))
    rank = _RANK_CLOSED if model.nc else _RANK
    order = _independent(Y[:, seen] / scale[seen], rank)
    if len(order) == len(Y):
        what, rule = (
            "base_parameters: samples are too few",
            "equations outnumber base parameters, or some are missed",
        )
        found = f"{count} samples give {len(Y)} equations, all independent"
        raise ArgumentError(what, found, rule, "more samples, or leave it out")
    independent = sorted(int(seen[i]) for i in order)
    # Columns of one size: lengths may be of micrometres or megametres, whose powers stand in Y and in `combine`.
    sizes = np.where(scale > 0.0, scale, 1.0)
    combine, *_ = np.linalg.lstsq(Y[:, independent] / sizes[independent], Y / sizes, rcond=None)
    combine[np.abs(combine) < rank] = 0.0
    combine *= sizes / sizes[independent, None]
    notes = _left_out_notes(model, (q, v, a), along, Y[:, independent] / sizes[independent])
    return BaseParameters(tuple(independent), np.asarray(combine, dtype=np.float64), columns, notes)


class _Motion(NamedTuple):
    """A state and its accelerations, on the constraints, and a basis of the speeds that these leave free (nv, n)."""

    q: Array
    v: Array
    a: Array
    along: Array


def _motion(model: Model, rng: np.random.Generator) -> _Motion:
    if not model.nc:
        q, v = model.random_state(rng)
        return _Motion(q, v, rng.normal(size=model.nv), np.eye(model.nv))
    for left in reversed(range(_GUESSES)):
        q, v = model.random_state(rng)
        try:
            on = assemble(model, q, v)
        except AssemblyError:
            if left:
                continue
            raise
        q, v = on.q, on.v
        G, measures = model.constraint_jacobian(q), model.record.measures
        along = null_space(G, measures)
        a = pseudo_inverse(G, measures) @ model.constraint_bias(q, v) + along @ rng.normal(size=along.shape[1])
        return _Motion(q, v, a, along)
    raise AssertionError("unreachable: the last guess returns or raises")


def _does_not_fit(
    what: str, found: tuple[int, ...], wanted: str, remedy: str = "of the same motion and joint_terms"
) -> ShapeError:
    return ShapeError(f"fit: {what} does not fit", str(found), wanted, remedy)


def _along(along: list[Array], rows: Array) -> Array:
    """N^T of what has a row a speed (count, nv, ...), one state below the other."""
    return np.concatenate([N.T @ of_state for N, of_state in zip(along, rows, strict=True)])


def _largest_comparable(columns: Sequence[str], scale: Array) -> Array:
    """Largest size, for each column, among columns with at most its power of length in their unit.

    Efforts by a second moment have none, by a first moment one, by a mass two: of a mechanism of a gigametre those by
    second moments are small beside the others, and are no rounding.
    """
    powers = np.array([_LENGTHS.get(name.split("(")[0], 0) for name in columns])
    return np.array([scale[powers <= power].max(initial=0.0) for power in powers])


def _left_out_notes(model: Model, states: tuple[Array, Array, Array], along: list[Array], Y: Array) -> tuple[str, ...]:
    """A note on efforts at the samples that no base parameters give, by their columns Y (equations, b)."""
    if not (model.has("mass_matrix") and model.has("bias")):
        return ()
    q, v, a = states
    efforts = _along(along, np.einsum("...ij,...j->...i", model.mass_matrix(q), a) + model.bias(q, v))
    missed = float(np.abs(efforts - Y @ np.linalg.lstsq(Y, efforts)[0]).max(initial=0.0))
    share = missed / max(float(np.abs(efforts).max(initial=0.0)), 1e-300)
    if share <= _LEFT_OUT:
        return ()
    return (
        f"no parameters give all of M a + h: {100.0 * share:.2g} % of the largest effort is left; armatures have"
        " columns by joint_terms=('armature',), gyroscopic moments of rotors and beams have none",
    )


def _independent(Y: Array, least: float) -> list[int]:
    """Columns in the order of a Gram-Schmidt process that takes each one that brings a new share, `least` or more."""
    independent: list[int] = []
    basis: list[Array] = []
    for i in range(Y.shape[1]):
        left = Y[:, i].copy()
        for _ in range(2):
            for b in basis:
                left -= (b @ left) * b
        size = float(np.linalg.norm(left))
        if size > least * float(np.linalg.norm(Y[:, i])):
            independent.append(i)
            basis.append(left / size)
    return independent
