"""Assembly: a configuration that closes every loop, near a guess, and speeds that keep it closed."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from typing import NamedTuple, NoReturn

import numpy as np
import numpy.typing as npt

from symofros.base.arguments import checked
from symofros.base.arrays import Array, vector
from symofros.base.measures import ROTATION, TRANSLATION
from symofros.errors import AssemblyError, UnknownNameError, did_you_mean
from symofros.runtime.constrained import (
    LARGEST_STEP,
    MIN_SIZE,
    RESIDUAL_ROUNDING,
    eliminate,
    natural_sizes,
    pseudo_inverse,
    residual_rounding,
    residual_weights,
    step_factor,
)
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.kinematics.facing import refuse_opposite
from symofros.simulation.analysis.kinematics.targets import finite_array
from symofros.simulation.analysis.reach import length_by_constraints
from symofros.simulation.analysis.states import check_search, given_configuration, given_inputs

Indices = npt.NDArray[np.intp]


@dataclass(frozen=True)
class Assembled:
    """A state on the constraints.

    Attributes:
        q: Configuration (nq).
        v: Speeds (nv).
        residual: Largest |phi|.
        iterations: Number of iterations.
        rank: Rank of G; where it is below nc, some conditions depend on others.
    """

    q: Array
    v: Array
    residual: float
    iterations: int
    rank: int


# Bound of the largest |phi| [m, rad], and most steps from a guess.
TOLERANCE, ITERATIONS = 1e-12, 100
# Where a guess leads to no closed posture, shifted ones are tried: rotations by so many radians at most, translations
# by as large a share of the largest reach, ATTEMPTS of each size. Links that lie in one line, as those of a loop that
# was just drawn, hold no direction that closes it; any shift off the line does.
SHIFTS, ATTEMPTS = (0.03, 0.1, 0.3, 1.0), 2
# Damped steps from a shifted guess, their damping a share of the squared residual over the reach: they end at a
# residual of NEAR the reach, where Gauss-Newton steps take over, or where STALLED of them do not take a tenth of it.
DAMPED_STEPS, STALLED, DAMPING, NEAR = 80, 20, 0.1, 0.05


@checked
def assemble(
    model: Model,
    q: ArrayLike | None = None,
    v: ArrayLike | None = None,
    *,
    held: Collection[str] = (),
    u: ArrayLike | None = None,
    par: ArrayLike | None = None,
    t: float = 0.0,
    tolerance: float = TOLERANCE,
    iterations: int = ITERATIONS,
) -> Assembled:
    """Solve phi(q) = 0 and G v = b by damped Gauss-Newton steps of least norm.

    Where the guess leads to no closed posture, as that of links in one line, guesses near it are tried: shifted at
    random by more and more, the same for the same model and guess. Of those of one size the closed posture nearest to
    the guess is taken (docs/theory/constraints.md, section 5).

    Args:
        model: Model with constraints.
        q: Guess (nq); the neutral configuration if not given.
        v: Wished speeds (nv), changed as little as possible; zeros if not given.
        held: Names of speeds (`model.names.v`) whose coordinates and values stay as they are.
        u: Inputs, for prescribed motions.
        par: Run-time parameters.
        t: Time.
        tolerance: Bound of the largest |phi| [m, rad]; mechanisms of a millimetre and less close to their own measure,
            large ones to their rounding.
        iterations: Most steps to take from a guess.

    Raises:
        AssemblyError: No such configuration was found; names the constraint that is worst.
        UnknownNameError: `held` names something that is not a speed.
        SymofrosError: A quaternion of the guess or of the inputs is no rotation; or tolerance or iterations is out of
            range.
    """
    check_search("assemble", tolerance, iterations)
    free = free_speeds(model, held)
    model = model.with_precision("double")
    q = model.neutral() if q is None else given_configuration(model, q)
    speeds = np.zeros(model.nv) if v is None else model.by_name("v", v)
    wished = finite_array("assemble: v", speeds, (model.nv,), "give one number a speed")
    conditions = _Conditions(model, vector("u", given_inputs(model, u), model.nu), par, t)
    tolerance = _own_measure(conditions, q, tolerance)
    found = _closed(conditions, q, free, tolerance, iterations, held)
    G = conditions.jacobian(found.q)
    speeds = _consistent_speeds(conditions, found.q, wished, free, tolerance)
    rank = eliminate(G, model.record.measures, np.ones(model.nv)).rank
    return Assembled(found.q, speeds, float(np.abs(found.phi).max(initial=0.0)), found.steps, rank)


def approach(
    model: Model,
    q: Array,
    *,
    held: Collection[str] = (),
    u: ArrayLike | None = None,
    par: ArrayLike | None = None,
    t: float = 0.0,
) -> Attempt:
    """Result of Gauss-Newton steps from this guess alone, closed or with a residual left.

    Args:
        model: Model with constraints.
        q: Guess (nq).
        held: Names of speeds whose coordinates stay as they are.
        u: Inputs, for prescribed motions.
        par: Run-time parameters.
        t: Time.

    Raises:
        AssemblyError: The constraints have no finite derivative there, or it is closed the wrong way round.
    """
    free = free_speeds(model, held)
    model = model.with_precision("double")
    at = _Conditions(model, vector("u", given_inputs(model, u), model.nu), par, t)
    end = _attempt(at, q, free, _own_measure(at, q, TOLERANCE), ITERATIONS)
    if end.closes:
        refuse_opposite(model, end.q, at.u, par)
    return end


class _Conditions(NamedTuple):
    """The constraints of a model at an instant."""

    model: Model
    u: ArrayLike | None
    par: ArrayLike | None
    t: float

    def residual(self, q: Array) -> Array:
        """Residual phi of the constraints (nc)."""
        return self.model.constraint(q, u=self.u, par=self.par, t=self.t)

    def jacobian(self, q: Array) -> Array:
        """G (nc, nv)."""
        return self.model.constraint_jacobian(q, u=self.u, par=self.par, t=self.t)

    def rate(self, q: Array, v: Array) -> Array:
        """G v - b (nc)."""
        return self.model.constraint_rate(q, v, u=self.u, par=self.par, t=self.t)


class Attempt(NamedTuple):
    """Where the steps from a guess end, with the bounds (nc) below which |phi| counts as closed."""

    q: Array
    phi: Array
    bounds: Array
    steps: int

    @property
    def closes(self) -> bool:
        """Whether every condition is met."""
        return bool(np.all(np.abs(self.phi) <= self.bounds))


def _own_measure(at: _Conditions, q: Array, tolerance: float) -> float:
    """The tolerance of a mechanism: a small one closes to its own measure."""
    if not at.model.nc:
        return tolerance
    return tolerance / float(residual_weights(at.jacobian(q), at.model.record.measures).max())


def _closed(
    at: _Conditions, q: Array, free: Indices, tolerance: float, iterations: int, held: Collection[str]
) -> Attempt:
    """The closed posture that the guess leads to, or else one of the shifted guesses.

    Raises:
        AssemblyError: None of them leads to one.
    """
    first = _attempt(at, q, free, tolerance, iterations)
    if not first.closes:
        others = _shifted(at, q, free, tolerance, iterations)
        if others is None:
            _refuse(at.model, first, held, bool(_movable(at, q, free).any()))
        first = others
    refuse_opposite(at.model, first.q, at.u, at.par)
    return first


def _attempt(at: _Conditions, q: Array, free: Indices, tolerance: float, iterations: int) -> Attempt:
    """Gauss-Newton steps from a guess, until it is closed or no step improves on it."""
    model, phi, count = at.model, at.residual(q), 0
    while np.abs(phi).max(initial=0.0) > tolerance and count < iterations:
        G = at.jacobian(q)
        step = np.zeros(model.nv)
        step[free] = -_inverse(model, G[:, free], free) @ phi
        step *= step_factor(G, model.record.measures, step, LARGEST_STEP)
        for _ in range(30):
            tried = model.integrate(q, step)
            phi_tried = at.residual(tried)
            if np.linalg.norm(phi_tried) < np.linalg.norm(phi):
                break
            step *= 0.5
        else:
            break
        q, phi, count = tried, phi_tried, count + 1
    return Attempt(q, phi, _bounds(model, q, at.jacobian(q), tolerance), count)


def _shifted(at: _Conditions, q: Array, free: Indices, tolerance: float, iterations: int) -> Attempt | None:
    """The nearest closed posture that shifted guesses lead to, of the smallest size that leads to any."""
    model, random = at.model, np.random.default_rng(0)
    scales, movable = shift_scales(model, at.jacobian(q)), _movable(at, q, free)
    if not movable.any():
        return None
    for size in SHIFTS:
        closed = []
        for _ in range(ATTEMPTS):
            guess = model.integrate(q, size * movable * random.uniform(-1.0, 1.0, model.nv))
            try:
                near = _damped_approach(at, guess, movable)
                attempt = None if near is None else _attempt(at, near, free, tolerance, iterations)
            except AssemblyError:  # Not smooth there.
                continue
            if attempt is not None and attempt.closes:
                closed.append(attempt)
        if closed:
            unit = np.where(scales > 0.0, scales, 1.0)
            return min(closed, key=lambda attempt: float(np.linalg.norm(model.difference(q, attempt.q) / unit)))
    return None


def _damped_approach(at: _Conditions, q: Array, scales: Array) -> Array | None:
    """The end of damped steps (Levenberg, Marquardt) from a guess beside a singular posture; None where it is not near.

    Args:
        at: The conditions.
        q: The guess.
        scales: What counts as a change of one for each speed (nv); 0 for those that do not move.
    """
    model, measures = at.model, at.model.record.measures
    phi, judged = at.residual(q), math.inf
    for count in range(DAMPED_STEPS):
        G = at.jacobian(q)
        sizes = np.maximum(natural_sizes(G, measures).max(axis=1, initial=0.0), MIN_SIZE)
        r, J = phi / sizes, G * scales / sizes[:, None]
        norm = float(np.linalg.norm(r))
        if norm <= NEAR:
            return q
        if not np.all(np.isfinite(J)):
            return None
        if count % STALLED == 0:
            if norm > 0.9 * judged:
                return None
            judged = norm
        step = -scales * (J.T @ np.linalg.solve(J @ J.T + DAMPING * norm**2 * np.eye(len(r)), r))
        for _ in range(10):
            tried = model.integrate(q, step)
            phi_tried = at.residual(tried)
            if np.linalg.norm(phi_tried / sizes) < norm:
                break
            step *= 0.5
        else:
            return None
        q, phi = tried, phi_tried
    return None


def _movable(at: _Conditions, q: Array, free: Indices) -> Array:
    """The scales (nv) by which guesses are shifted; 0 for speeds that are not free."""
    movable = np.zeros(at.model.nv)
    movable[free] = shift_scales(at.model, at.jacobian(q))[free]
    return movable


def shift_scales(model: Model, G: Array) -> Array:
    """Size of a unit shift of each speed (nv): a radian, or the largest reach; 0 for elastic coordinates."""
    measures = model.record.measures
    kinds = np.array(measures.speed, dtype=np.intp)
    reach = length_by_constraints(G, measures) or 1.0
    return np.where(kinds == ROTATION, 1.0, np.where(kinds == TRANSLATION, reach, 0.0))


def _consistent_speeds(at: _Conditions, q: Array, wished: Array, free: Indices, tolerance: float) -> Array:
    """The speeds (nv) nearest to the wished ones that keep the loops closed.

    Raises:
        AssemblyError: Those that are held allow none.
    """
    model, G, speeds = at.model, at.jacobian(q), wished.copy()
    inverse = _inverse(model, G[:, free], free)
    for _ in range(2):  # The second time against the rounding of columns of unlike sizes.
        speeds[free] -= inverse @ at.rate(q, speeds)
    left = at.rate(q, speeds)
    bounds = _bounds(model, q, G, tolerance) * (1.0 + float(np.abs(wished).max(initial=0.0)))
    if np.any(np.abs(left) > 1e3 * bounds):
        worst = int(np.argmax(np.abs(left) / bounds))
        raise AssemblyError(
            f"model '{model.record.name}': no speeds keep it closed",
            f"G v - b = {left[worst]:.3g} at '{model.names.constraints[worst]}'",
            "the speeds that are held must allow G v = b",
            "hold fewer speeds",
        )
    return speeds


def _inverse(model: Model, G: Array, free: Indices) -> Array:
    """The pseudo-inverse of the constraints' Jacobian by the free speeds."""
    if not np.all(np.isfinite(G)):
        worst = model.names.constraints[int(np.argmin(np.isfinite(G).all(axis=1)))]
        raise AssemblyError(
            f"model '{model.record.name}': can't be assembled from this guess",
            f"'{worst}' has no finite derivative there",
            "constraints are smooth near the guess; a disc that lies flat has no contact, for example",
            "start from another guess",
        )
    measures = model.record.measures
    return pseudo_inverse(G, measures.of_speeds(free))


def free_speeds(model: Model, held: Collection[str]) -> Indices:
    """Indices of the speeds that are not held.

    Raises:
        UnknownNameError: A name is not that of a speed.
    """
    for name in held:
        if name not in model.names.v:
            raise UnknownNameError(
                f"held: no speed '{name}'",
                name,
                "held names speeds of the model",
                did_you_mean(name, model.names.v) or "see model.names.v",
            )
    return np.array([i for i, name in enumerate(model.names.v) if name not in held], dtype=np.intp)


def _bounds(model: Model, q: Array, G: Array, tolerance: float) -> Array:
    """Largest |phi| that closes each condition (nc): the tolerance, or the rounding of coordinates and lengths."""
    rounding = np.maximum(
        residual_rounding(G, model.record.measures), RESIDUAL_ROUNDING * (1.0 + np.abs(q).max(initial=0))
    )
    return np.asarray(np.maximum(tolerance, rounding), dtype=np.float64)


def _refuse(model: Model, first: Attempt, held: Collection[str], shifted: bool) -> NoReturn:
    worst = int(np.argmax(np.abs(first.phi) / first.bounds))
    also = f"; held: {', '.join(held)}" if held else ""
    if shifted:
        also += f"; {len(SHIFTS) * ATTEMPTS} guesses near it do not close it either"
    raise AssemblyError(
        f"model '{model.record.name}': can't be assembled from this guess",
        f"after {first.steps} steps phi = {first.phi[worst]:.3g} at '{model.names.constraints[worst]}'{also}",
        f"|phi| <= {first.bounds[worst]:.2g}; either no configuration closes it, or the guess leads to none",
        "start nearer, hold fewer coordinates, or check lengths",
    )
