"""Whether fixed steps resolve the modes of a motion, by its spectrum at a few states (docs/theory/simulation.md, 8)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.simulation.stepping.methods import METHODS, Method, stability_limit

# Relative error of a mode, by its share of the motion, from which a run is remarked upon.
TOLERANCE = 0.1
# Directions of the subspace: all of small models; of large ones those that lead to the fastest modes.
_DIRECTIONS = 24
# States looked at, as far as their evaluations are below this share of the run's.
_STATES, _SHARE = 4, 0.01
# Share of that error below which steps are evidently short enough, however the motion amplifies it.
_EVIDENT = 1e-4
# Share of a mode that rounding alone excites.
_ROUNDING = 1e-16
# Of coordinates: motions below that are rounding's, and rest is not followed worse for them.
_REST = 1e-13
# Powers of e by which a mode of the motion grows at the rate of one state; then this has become another.
_GROWTH = 3.0
# Of |z|: farther out a state is no motion any more, and powers of z overflow.
_FARTHEST = 1e8
# Exponents of the powers of factors, which do not overflow.
_LARGEST = 300.0


# Orthonormal basis (m, 2 nv) of changes (theta, h v), h times the derivative in that basis (m, m), components of the
# motion of one step (m).
Spectrum = tuple[Array, Array, Array]


@dataclass(frozen=True)
class Resolution:
    """How well fixed steps resolve the modes of a motion.

    Attributes:
        worst: Mode that is resolved worst, if the steps err by it.
        evident: Whether the steps are that short that no mode of the states examined needed a look.
    """

    worst: Mode | None = None
    evident: bool = True

    def and_then(self, other: Resolution) -> Resolution:
        """Both resolutions in one: the mode of this one, unless steps amplify that of the other."""
        is_worse = self.worst is None or (other.worst is not None and other.worst.amplified)
        return Resolution(other.worst if is_worse else self.worst, self.evident and other.evident)


@dataclass(frozen=True)
class Pull:
    """What Baumgarte's gains do with a motion that has left the constraints.

    Attributes:
        rates: Rates of the ways back [1/s].
        share: Share of the speed that leaves the constraints where most does.
        t: Time at which that is first so [s].
    """

    rates: Sequence[complex] = ()
    share: float = 0.0
    t: float = 0.0


def pull_rates(gains: Array, on_speeds: Sequence[bool]) -> tuple[complex, ...]:
    """The rates z at which gains lead back to the constraints: z^2 + 2 alpha z + beta^2 = 0, of each of a pair one.

    Args:
        gains: Baumgarte's gains (2 nc) [1/s]: alphas, then betas.
        on_speeds: Which constraints are conditions on speeds, whose way back is z + 2 alpha = 0 (nc).
    """
    rates = set()
    for alpha, beta, on_speed in zip(*np.split(gains.astype(complex), 2), on_speeds, strict=True):
        root = np.sqrt(alpha**2 - (0.0 if on_speed else beta**2))
        rates |= {complex(-alpha + root), complex(-alpha - root)}
    return tuple(z for z in rates if z and z.imag >= 0.0)


@dataclass(frozen=True)
class Mode:
    """The mode of a motion that a run of fixed steps resolves worst.

    Attributes:
        rate: Rate of the mode [1/s]: its real part is growth, its imaginary part the angular frequency.
        factor: Factor by which a step multiplies it.
        error: Relative error of the motion by it over the run.
        share: Share of the mode in the motion's speed.
        t: Time of the state at which it was seen [s].
        of_gains: Whether it is the way back to the constraints by Baumgarte's gains.
    """

    rate: complex
    factor: complex
    error: float
    share: float
    t: float
    of_gains: bool = False

    @property
    def amplified(self) -> bool:
        """Whether steps make it grow though it does not."""
        return abs(self.factor) > 1.0 and self.rate.real <= 1e-6 * abs(self.rate)


def states_to_examine(steps: int, stages: int, nv: int) -> int:
    """Number of states whose spectrum costs a small share of a run of so many steps; two at least."""
    each = directions(nv) + 2
    return int(min(max(_SHARE * steps * stages / each, 2), _STATES))


def directions(nv: int) -> int:
    """Number of directions of the subspace."""
    return min(2 * nv, _DIRECTIONS)


def resolution(
    method: Method,
    h: float,
    steps: int,
    times: Sequence[float],
    spectrum_at: Callable[[int], Spectrum | None],
    speeds: Sequence[float],
    metric: Array,
    pull: Pull = Pull(),
    reach: float = 0.0,
) -> Resolution:
    """How well a run resolves the modes about some of its states; one is named where they err beyond TOLERANCE.

    Args:
        method: Stepping method.
        h: Step [s].
        steps: Number of steps.
        times: Times of the states [s]; each stands for an equal part of the run.
        spectrum_at: Linearised motion about a state, by its number.
        speeds: Largest speed of the motion about each state, in its metric.
        metric: Mass matrix at each state (number of states, nv, nv).
        pull: The way back to the constraints, which no motion on them shows.
        reach: Largest coordinate of the run: speeds that its rounding makes are no motion.
    """
    if max(speeds) == 0.0:  # Rest is kept exactly.
        return Resolution()
    part = max(1, steps // len(times))
    ways = [_judged(method, h * rate, pull.share, h, steps, pull.t) for rate in pull.rates]
    worst = max((replace(mode, of_gains=True) for mode in ways), key=lambda mode: mode.error, default=None)
    total = sum(mode.error for mode in ways)
    evident = h * max(map(abs, pull.rates), default=0.0) <= _resolved_radius(method.name, part, _EVIDENT)
    if worst is not None and total > TOLERANCE:
        return Resolution(replace(worst, error=total), evident)
    for i, (t, speed, M) in enumerate(zip(times, speeds, metric, strict=True)):
        spectrum = spectrum_at(i)
        if spectrum is None:
            evident = False
            continue
        basis, matrix, motion = spectrum
        resolved = _resolved_radius(method.name, part)
        radius = _radius(matrix)
        evident = evident and radius <= _resolved_radius(method.name, part, _EVIDENT)
        if radius <= resolved:
            continue
        modes = [(z, share) for z, share in _modes(basis, matrix, motion, h * speed, M, reach) if abs(z) > resolved]
        judged = [_judged(method, z, share, h, part, t) for z, share in modes]
        here = max(judged, key=lambda mode: mode.error, default=None)
        if here is not None:
            total += sum(mode.error for mode in judged)
            worst = here if worst is None or here.error > worst.error else worst
        if worst is not None and total > TOLERANCE:  # What follows may be no motion any more.
            return Resolution(replace(worst, error=total), evident)
    return Resolution(None, evident)


def _judged(method: Method, z: complex, share: float, h: float, steps: int, t: float) -> Mode:
    z *= min(1.0, _FARTHEST / abs(z))
    factor = method.amplification(z)
    return Mode(z / h, factor, mode_error(z, factor, steps, share), share, t)


def mode_error(z: complex, factor: complex, steps: int, share: float) -> float:
    """The largest error that a mode exp(z t/h) brings into a motion on the way through so many steps, (16).

    Args:
        z: Step times the rate of the mode.
        factor: Factor by which a step multiplies it.
        steps: Number of steps.
        share: Share of the mode in the motion, to which the error is relative.
    """
    if z.real > 0.0:  # It does not grow for long at the rate of one state.
        steps = max(1, min(steps, math.ceil(_GROWTH / z.real)))
    counts = np.unique(np.minimum(2 ** np.arange(1 + math.ceil(math.log2(max(1, steps)))), steps))
    exact = counts * complex(z)
    exponents = counts * (np.log(complex(factor)) if factor else complex(-_LARGEST))
    if abs(factor) > 1.0:
        share = max(share, _ROUNDING)
    if z.real > 0.0:  # Relative to what it has grown to, at most to all of the motion.
        sizes = np.minimum(share * np.exp(np.minimum(counts * z.real, _LARGEST)), 1.0)
        return float((sizes * np.abs(_power(exponents - exact) - 1.0)).max())
    return share * float(np.abs(_power(exponents) - _power(exact)).max())


def _power(exponents: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
    powers: npt.NDArray[np.complex128] = np.exp(np.clip(exponents.real, -_LARGEST, _LARGEST) + 1j * exponents.imag)
    return powers


def _radius(matrix: Array) -> float:
    """A bound of the spectral radius, tight but for a factor near 1: the sixteenth root of a norm of the 16th power."""
    scale = float(np.abs(matrix).max())
    if not (math.isfinite(scale) and scale > 0.0):
        return scale
    power = matrix / scale
    for _ in range(4):
        power = power @ power
    return float(scale * np.vdot(power, power) ** 0.03125)


def _modes(
    basis: Array, matrix: Array, motion: Array, travel: float, M: Array, reach: float
) -> list[tuple[complex, float]]:
    """Modes of the subspace: h times the rate, and the share in the motion's speed.

    Args:
        basis: Orthonormal changes (m, 2 nv).
        matrix: Derivative (m, m).
        motion: Components of the motion of one step (m).
        travel: Step times the largest speed of the run, in the metric.
        M: Metric of displacements and speeds (nv, nv).
        reach: Largest coordinate of the run.
    """
    if not np.all(np.isfinite(matrix)):
        return []
    rates, vectors = np.linalg.eig(matrix)
    try:
        content = np.linalg.solve(vectors, motion)
    except np.linalg.LinAlgError:  # Two modes are one.
        content = np.linalg.lstsq(vectors, motion.astype(complex), rcond=None)[0]
    directions = basis[:, : basis.shape[1] // 2].T @ vectors
    squares = np.einsum("im,ij,jm->m", directions.conj(), M, directions).real
    displacements = np.sqrt(np.maximum(squares, 0.0))
    sizes = np.abs(content) * displacements * np.where(rates.imag != 0.0, 2.0, 1.0)
    rounding = _REST * reach * np.sqrt(float(M.diagonal().max())) * np.abs(rates)
    shares = sizes / np.maximum.reduce([sizes, np.full_like(sizes, travel), rounding, np.full_like(sizes, 1e-300)])
    return [(complex(z), float(share)) for z, share in zip(rates, shares, strict=True) if z.imag >= 0.0]


@cache
def _resolved_radius(name: str, steps: int, share: float = 1.0) -> float:
    """The |z| below which each mode, whatever its direction, is resolved over so many steps; to a share of that."""
    radii, errors = _step_errors(name)
    resolved = errors * steps <= 0.5 * share * TOLERANCE / _STATES
    return float(radii[int(np.argmin(resolved))]) if not resolved.all() else float(radii[-1])


@cache
def _step_errors(name: str) -> tuple[Array, Array]:
    """Radii |z|, and the largest relative error of one step up to each."""
    method, radii = METHODS[name], np.geomspace(1e-6, 1.0, 97)
    directions = [1j, -1.0 + 0.0j, 1.0 + 0.0j, (-1.0 + 1.0j) / math.sqrt(2.0)]
    errors = [max(abs(method.amplification(r * d) / np.exp(r * d) - 1.0) for d in directions) for r in radii]
    return radii, np.maximum.accumulate(np.array(errors))


def largest_stable_step(method: Method, rate: complex) -> float:
    """The step [s] up to which a method does not amplify a mode of that rate; inf: at any; 0: at none."""
    return stability_limit(method.name, min(abs(np.angle(rate)), math.pi)) / abs(rate)
