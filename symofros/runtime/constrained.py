"""The routines of the C templates in NumPy, for the interpreter: M a = r + G^T lam, G a = c; projection."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symofros.base.measures import ANGLE, FORMULA, LENGTH, ROTATION, SPEED_KINDS, TRANSLATION, Measures
from symofros.native import native_number
from symofros.runtime.calls.kernel import Array

# Thresholds have one place, the C text. What is left of a row of G that repeats others, as a share of its natural size:
# a redundant condition that has drifted by d [m or rad] differs by about d, and would ask for
# accelerations that contradict the others, so the share is above what integration drifts by, and below what
# distinguishes a posture from a singular one.
RANK = native_number("model/dense.c.in", "SYM_RANK")
PIVOT = native_number("model/dense.c.in", "SYM_PIVOT")
# Smaller entries of a row that counts are no rounding above this share of their size: the mass that they move may be so
# small that they are the pivot. How much more they must be worth, and the share of sizes that they carry on.
WEAK_LEAST, WEAK_WORTH, WEAK_SIZE = (
    native_number("model/null_space_factors.c.in", f"SYM_WEAK_{name}") for name in ("LEAST", "WORTH", "SIZE")
)
MIN_SIZE, SMALL_REACH = (native_number("model/row_sizes.c.in", f"SYM_{name}") for name in ("LEAST_SIZE", "SMALL_REACH"))
# Of states beside the constraints.
BESIDE, DOUBT, DOUBT_MOST, FARTHEST = (
    native_number("model/motion.c.in", f"SYM_{name}") for name in ("BESIDE", "DOUBT", "DOUBT_MOST", "FARTHEST")
)
APPROACH = int(native_number("model/motion.c.in", "SYM_APPROACH"))
# Of the projection.
CLOSED, STILL, LARGEST_STEP = (
    native_number("model/project.c.in", f"SYM_{name}") for name in ("CLOSED", "STILL", "LARGEST_STEP")
)
NEWTON, HALVINGS = (int(native_number("model/project.c.in", f"SYM_{name}")) for name in ("NEWTON", "HALVINGS"))
# Rows of G of larger ratios are brought to one size before a least-squares problem is solved: an SVD would lose digits.
UNLIKE = 1e3
# Residual over reach that the rounding of coordinates and lengths leaves: some tens of units in the last place.
RESIDUAL_ROUNDING = 1e-14


def natural_sizes(G: Array, measures: Measures) -> Array:
    """Natural size of each entry of G (nc, nv), by which rank decisions judge it (docs/theory/constraints.md, (20))."""
    nc, nv = G.shape
    group, speed, least = _size_tables(measures)
    sizes = np.zeros((nc, SPEED_KINDS))
    np.maximum.at(sizes, (group[:, None], speed), np.where(np.isnan(G), 0.0, np.abs(G)))
    sizes = np.maximum(sizes, least)
    return np.asarray(sizes[group[:, None], speed], dtype=np.float64).reshape(nc, nv)


@lru_cache(maxsize=64)
def _size_tables(measures: Measures) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp], Array]:
    """Groups of rows (nc), kinds of speeds (nv), and the least size of each group's entries (nc, SPEED_KINDS)."""
    group, unit, speed = (np.array(table, dtype=np.intp) for table in measures)
    least = np.zeros((len(group), SPEED_KINDS))
    least[group[unit != FORMULA]] = MIN_SIZE
    for kind, own in ((LENGTH, TRANSLATION), (ANGLE, ROTATION)):
        least[group[unit == kind], own] = 1.0
    return group, speed, least


def residual_weights(G: Array, measures: Measures) -> Array:
    """Weights of phi (nc): 1, and more for mechanisms smaller than SMALL_REACH (docs/theory/constraints.md, (22))."""
    sizes = np.where(np.array(measures.speed, dtype=np.intp) == TRANSLATION, 0.0, natural_sizes(G, measures))
    reach = sizes.max(axis=1, initial=0.0)
    small = (np.array(measures.unit, dtype=np.intp) == LENGTH) & (reach > MIN_SIZE) & (reach < SMALL_REACH)
    return np.where(small, SMALL_REACH / np.where(small, reach, 1.0), 1.0)


def residual_rounding(G: Array, measures: Measures) -> Array:
    """Residuals of phi (nc), and of G v at unit speeds, that count as rounding (docs/theory/constraints.md, (22a))."""
    return np.asarray(RESIDUAL_ROUNDING * natural_sizes(G, measures).max(axis=1, initial=0.0), dtype=np.float64)


def step_factor(G: Array, measures: Measures, step: Array, most: float) -> float:
    """Factor of a step (nv) that keeps rotations below most, and other changes below most of the largest reach."""
    lengths = np.array(measures.unit, dtype=np.intp) == LENGTH
    turns = np.array(measures.speed, dtype=np.intp) == ROTATION
    reach = float(natural_sizes(G, measures)[np.ix_(lengths, turns)].max(initial=1.0))
    largest = float(np.abs(step / np.where(turns, 1.0, reach)).max(initial=0.0))
    return min(1.0, most / max(largest, 1e-300))


class Eliminated(NamedTuple):
    """G = L U, the lightest speeds first (docs/theory/constraints.md, section 8).

    Attributes:
        L: (nc, rank).
        U: (rank, nv).
        rows: Rows of the pivots.
        columns: Columns of the pivots.
        weakest: Least share of its own size that was left of a pivot's row, of 1.
    """

    L: Array
    U: Array
    rows: npt.NDArray[np.intp]
    columns: npt.NDArray[np.intp]
    weakest: float = 1.0

    @property
    def rank(self) -> int:
        """Number of rows that do not repeat others."""
        return len(self.rows)


class Ranking(NamedTuple):
    """How the rank of G is decided.

    Attributes:
        least: Share of its own size below which what is left of a row repeats others.
        most: Rows that count at most; all, if not given.
    """

    least: float = RANK
    most: int | None = None


DEFAULT_RANKING = Ranking()


def eliminate(G: Array, measures: Measures, inertia: Array, ranking: Ranking = DEFAULT_RANKING) -> Eliminated:
    """Eliminate G by complete pivoting; a pivot costs what the rows take that it changes, few of many loops.

    Args:
        G: (nc, nv).
        measures: Measures of its rows and columns.
        inertia: Diagonal of M (nv), or ones.
        ranking: Which rows count.
    """
    left, size = G.copy(), natural_sizes(G, measures)
    (nc, nv), massive = G.shape, inertia > 0.0
    worth = 1.0 / np.sqrt(np.where(massive, inertia, 1e-12 * inertia[massive].min() if massive.any() else 1.0))
    own = np.abs(G * worth).max(axis=1, initial=0.0)
    own_or_one = np.where(own > 0.0, own, 1.0)[:, None]
    # Best entry of each open row: its merit, column, and whether it is more than a weak one.
    is_open, merits, columns_of, strong = own > 0.0, np.zeros(nc), np.zeros(nc, dtype=np.intp), np.zeros(nc, dtype=bool)

    def judge(judged: npt.NDArray[np.intp]) -> None:
        magnitude = np.abs(left[judged])
        significant = magnitude > RANK * size[judged]
        weak = (magnitude > WEAK_LEAST * size[judged]) & massive
        merit = np.where(significant, 1.0, np.where(weak, WEAK_WORTH, 0.0)) * magnitude * worth / own_or_one[judged]
        best, line = merit.argmax(axis=1), np.arange(len(judged))
        is_open[judged] &= (
            significant.any(axis=1) if ranking.least <= RANK else (magnitude > ranking.least * size[judged]).any(axis=1)
        )
        merits[judged] = np.where(is_open[judged], merit[line, best], -1.0)
        columns_of[judged], strong[judged] = best, significant[line, best]

    merits[~is_open] = -1.0
    if is_open.any():
        judge(np.flatnonzero(is_open))
    rows: list[int] = []
    columns: list[int] = []
    lower: list[Array] = []
    upper: list[Array] = []
    most, weakest = min(nv, nc if ranking.most is None else ranking.most), 1.0
    while len(rows) < most and is_open.any():
        p = int(merits.argmax())
        weakest = min(weakest, float((np.abs(left[p]) / np.maximum(size[p], np.finfo(float).tiny)).max()))
        d = int(columns_of[p])
        is_open[p], merits[p] = False, -1.0
        changed = np.flatnonzero(is_open & (left[:, d] != 0.0))
        factor = np.zeros(nc)
        factor[changed] = left[changed, d] / left[p, d]
        own_factor = factor[changed][:, None]
        pivot_size = size[p] if strong[p] else np.maximum(np.abs(left[p]), WEAK_SIZE * size[p])
        size[changed] = np.maximum(size[changed], np.abs(own_factor) * pivot_size)
        rows.append(p)
        columns.append(d)
        upper.append(left[p].copy())
        left[changed] -= own_factor * left[p]
        left[changed, d] = 0.0
        if len(changed):
            judge(changed)
        factor[p] = 1.0
        lower.append(factor)
    L, U = np.array(lower).reshape(len(rows), nc).T.copy(), np.array(upper).reshape(len(rows), nv)
    return Eliminated(L, U, np.array(rows, dtype=np.intp), np.array(columns, dtype=np.intp), weakest)


def free_motions(eliminated: Eliminated, nv: int) -> tuple[Array, npt.NDArray[np.intp]]:
    """Basis Z (nv, free) of the motions with G Z = 0, and the free speeds, its independent ones (eq. 15)."""
    U, columns = eliminated.U, eliminated.columns
    free = np.setdiff1d(np.arange(nv), columns)
    Z = np.zeros((nv, len(free)))
    Z[free, np.arange(len(free))] = 1.0
    Z[columns] = -np.linalg.solve(U[:, columns], U[:, free])
    return Z, free


def null_space(G: Array, measures: Measures) -> Array:
    """Orthonormal basis (nv, free) of the motions with G Z = 0, the rank of G judged by natural sizes."""
    nv = G.shape[1]
    Z, _ = free_motions(eliminate(G, measures, np.ones(nv)), nv)
    return np.asarray(np.linalg.qr(Z)[0], dtype=np.float64)


def pseudo_inverse(G: Array, measures: Measures) -> Array:
    """Pseudo-inverse of G (n, m), its rank judged by natural sizes: rows are scaled to one size, but for zero rows."""
    if not G.size:
        return np.zeros(G.T.shape)
    void = (np.abs(G) <= RANK * natural_sizes(G, measures)).all(axis=1)
    largest = np.where(void, 0.0, np.abs(G).max(axis=1, initial=0.0))
    positive = largest[largest > 0.0]
    unlike = len(positive) > 0 and float(positive.max()) > UNLIKE * float(positive.min())
    scale = np.where(void, 0.0, 1.0 / np.where(void, 1.0, largest) if unlike else 1.0)
    rank = eliminate(G, measures, np.ones(G.shape[1])).rank
    U, s, Vt = np.linalg.svd(scale[:, None] * G, full_matrices=False)
    return np.asarray((Vt[:rank].T / s[:rank]) @ U[:, :rank].T * scale, dtype=np.float64)


def solve(
    M: Array, r: Array, G: Array, c: Array, measures: Measures, ranking: Ranking = DEFAULT_RANKING
) -> tuple[Array, Array, int]:
    """The solution for one state, of one or several right-hand sides, by a = a_p + Z w.

    Args:
        M: (nv, nv).
        r: (nv,) or (nv, k).
        G: (nc, nv).
        c: (nc,) or (nc, k).
        measures: Measures of the rows and columns of G.
        ranking: Which rows of G count.

    Returns:
        a and lam, shaped like r and c, and the rank of G; NaN where no acceleration exists, with rank -1 if M and G are
        finite.
    """
    if not (np.all(np.isfinite(M)) and np.all(np.isfinite(G))):
        return np.full_like(r, np.nan), np.full_like(c, np.nan), 0
    return _solve(M, r, c, eliminate(G, measures, np.diag(M), ranking))


def _solve(M: Array, r: Array, c: Array, eliminated: Eliminated) -> tuple[Array, Array, int]:
    """The solution of `solve`, with G eliminated, where M and G are finite."""
    L, U, rows, columns, _ = eliminated
    Z, _ = free_motions(eliminated, len(M))
    B = _factor(Z.T @ M @ Z, np.diag(np.abs(Z.T) @ np.abs(M) @ np.abs(Z)))
    if B is None:
        return np.full_like(r, np.nan), np.full_like(c, np.nan), -1
    a = np.zeros_like(r)
    y = np.linalg.solve(L[rows], c[rows])
    y = y + np.linalg.pinv(L) @ (c - L @ y)  # Least squares, where conditions contradict each other.
    a[columns] = np.linalg.solve(U[:, columns], y)
    a = a + Z @ np.linalg.solve(B.T, np.linalg.solve(B, Z.T @ (r - M @ a)))
    forces = np.linalg.solve(U[:, columns].T, (M @ a - r)[columns])
    if np.count_nonzero(L.any(axis=1)) > len(rows):
        return a, np.linalg.pinv(L.T) @ forces, eliminated.rank
    lam = np.zeros_like(c)
    lam[rows] = np.linalg.solve(L[rows].T, forces)
    return a, lam, eliminated.rank


def _factor(B: Array, sizes: Array) -> Array | None:
    """Lower factor of B; None where a pivot is rounding of the terms that its diagonal entry was made of."""
    try:
        L = np.asarray(np.linalg.cholesky(B), dtype=np.float64)
    except np.linalg.LinAlgError:
        return None
    return L if bool(np.all(np.diag(L) ** 2 > PIVOT * sizes)) else None


def constrained(M: Array, r: Array, G: Array, c: Array, measures: Measures) -> list[Array]:
    """The solution for each state: a, lam and the rank of G.

    Args:
        M: (n, nv, nv).
        r: (n, nv).
        G: (n, nc, nv).
        c: (n, nc).
        measures: Measures of the rows and columns of G.
    """
    solutions = [solve(*state, measures) for state in zip(M, r, G, c, strict=True)]
    a, lam, rank = zip(*solutions, strict=True)
    return [np.array(a), np.array(lam), np.array(rank, dtype=np.float64)]


def deviation(G: Array, measures: Measures, phi: Array) -> float:
    """Largest |phi_i| of a state: angles in rad, others over their reach (docs/theory/constraints.md, (11a))."""
    speeds, unit = np.array(measures.speed, dtype=np.intp), np.array(measures.unit, dtype=np.intp)
    reach = np.where(speeds == TRANSLATION, 0.0, natural_sizes(G, measures)).max(axis=1, initial=0.0)
    scaled = (unit != ANGLE) & (reach > MIN_SIZE)
    return float((np.abs(phi) / np.where(scaled, reach, 1.0)).max(initial=0.0))


def motion(
    at: list[Array],
    terms: Callable[[Array], list[Array]],
    move: Callable[[Array, Array], Array],
    q: Array,
    measures: Measures,
) -> tuple[Array, Array, int]:
    """Motion of one state that may be beside the constraints, by the rank that G has on them (sym_motion in C).

    Args:
        at: M, r, G, c, binds, phi of the state.
        terms: q -> the same at another q.
        move: (q, step) -> q.
        q: (nq,).
        measures: Measures of the rows and columns of G.

    Returns:
        a, lam, and the rank of G.
    """
    M, r, G, c, _, phi = at
    if not (np.all(np.isfinite(M)) and np.all(np.isfinite(G))):
        return solve(M, r, G, c, measures)
    eliminated = eliminate(G, measures, np.diag(M))
    solution = _solve(M, r, c, eliminated)
    off = deviation(G, measures, phi)
    if not (solution[2] > 0 and off > BESIDE):
        return solution
    if not eliminated.weakest < min(DOUBT * off, DOUBT_MOST):
        return solution
    rank = _rank_on_constraints(at, terms, move, q, measures)
    return solution if rank is None or rank >= solution[2] else solve(M, r, G, c, measures, Ranking(most=rank))


def _rank_on_constraints(
    at: list[Array],
    terms: Callable[[Array], list[Array]],
    move: Callable[[Array, Array], Array],
    q: Array,
    measures: Measures,
) -> int | None:
    """The rank of G on the constraints beside q, where Newton's steps lead there."""
    before, doubt = np.inf, DOUBT
    for _ in range(APPROACH):
        M, _, G, _, binds, phi = at
        off = deviation(G, measures, phi)
        if off <= BESIDE:
            return eliminate(G, measures, np.diag(M)).rank
        if not off < FARTHEST:
            return None
        doubt, before = (0.1 * doubt if off > 0.1 * before else doubt), off
        ranking = Ranking(min(max(doubt * off, RANK), DOUBT_MOST))
        step, _, rank = solve(M, np.zeros(len(M)), G * binds[:, None], -phi, measures, ranking)
        if rank < 0:
            return None
        q = move(q, step)
        at = terms(q)
    return None


def project(
    terms: Callable[[Array, Array], list[Array]],
    move: Callable[[Array, Array], Array],
    q: Array,
    v: Array,
    measures: Measures,
) -> tuple[Array, Array, float, int, Array, float]:
    """The nearest state on the constraints, in the metric of M.

    Args:
        terms: (q, v) -> M, G, binds, phi, G v - b, and cosines of the angles between axes that are to be parallel.
        move: (q, step) -> q.
        q: (nq,).
        v: (nv,).
        measures: Measures of the rows and columns of G.

    Returns:
        q, v, |phi| by weight (1 more half a turn off), the rank of G, the energies (2), which are what the change of
        speeds takes and the kinetic energy before it, and |phi| by weight of the q that was given.
    """
    M, G, binds, phi, rate, *facing = terms(q, v)
    weights, closer = residual_weights(G, measures), True
    left = gap = float(np.linalg.norm(weights * phi))
    for _ in range(NEWTON):
        if not (closer and left > CLOSED):
            break
        step, _, _ = solve(M, np.zeros_like(v), G * binds[:, None], -phi, measures)
        step *= step_factor(G, measures, step, LARGEST_STEP)
        closer = False
        for half in range(HALVINGS):
            tried = move(q, step * 0.5**half)
            at_trial = terms(tried, v)
            if np.linalg.norm(weights * at_trial[3]) < left:
                q, (M, G, binds, phi, rate, *facing), closer = tried, at_trial, True
                left = float(np.linalg.norm(weights * phi))
                break
    if any(np.any(cosines < 0.0) for cosines in facing):
        left += 1.0  # Half a turn away phi is zero, too.
    if not len(G):
        return q, v, left, 0, np.zeros(2), gap
    change, mu, rank = solve(M, np.zeros_like(v), G, -rate, measures)
    energies = 0.5 * np.array([-rate @ mu, v @ M @ v + STILL**2 * np.trace(M)])
    return q, v + change, left, rank, energies, gap
