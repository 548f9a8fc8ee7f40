"""How far a state is from an equilibrium or a steady motion, and whether it matters (docs/theory/linear.md, 7e, 7g)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.errors import SymofrosError
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.rigid_motions import Complex
from symofros.simulation.analysis.states import prescribed_rates

# Accelerations below which a state is at rest, or moves steadily: shares of those of forces that do not balance, and of
# the linearised equations, where there are none. Accelerations that go on, as a share of the former.
_BALANCED, _ROUNDING, _GOES_ON = 1e-7, 1e-11, 1e-4
# Change of an eigenvalue that is worth a note, as a share of it; most that a displacement by rounding [rad or m] may
# change it by, or it is itself rounding, as of motions that are rigid along each other.
_NOTED, _SHAKEN, ROUNDED = 1e-3, 1e-4, 1e-10
# Eigenvalues that may be rounding whole, as a share of the largest: zeros that count three times become that large.
_SMALL = 1e-4
# Longest displacement to where forces balance [rad or m]; share of singular values of the stiffness that is rounding.
_FARTHEST, _RANK = 0.1, 1e-9

# Eigenvalues of the linearised equations at a configuration and speeds, those of rigid motions 0.
Spectrum = Callable[[Array, Array], Complex]
# Matrix of the linearised equations (2 nv + nz, 2 nv + nz) at a configuration, with inputs, at a time.
Matrix = Callable[[Array, Array, float], Array]


def imbalance_notes(
    model: Model, state: tuple[Array, Array, Array, Array], par: ArrayLike | None, t: float, spectrum: Spectrum
) -> tuple[str, ...]:
    """Note on a state about which small motions are no motions of their own; none where they are.

    Accelerations that change nothing in the equations, as those of a free fall, leave them what they are.

    Args:
        model: Model in double precision.
        state: Configuration (nq), speeds (nv), inputs (nu) and states of forces (nz).
        par: Run-time parameters.
        t: Time [s].
        spectrum: Gives the eigenvalues at other states.
    """
    (q, v, u, states), nv = state, model.nv
    z = states if model.nz else None
    a, alone = _accelerations(model, state, par, t)
    most = float(np.abs(a).max(initial=0.0))
    if not most > _BALANCED * alone:
        return ()
    stiffness = model.linearize(q, v, u, par=par, t=t, z=z)[0][nv : 2 * nv, :nv]
    if not most > _ROUNDING * np.abs(stiffness).max():
        return ()
    step, onwards = _towards_balance(stiffness, a)

    def known(there: Array, faster: Array) -> tuple[Complex, Complex]:
        """All eigenvalues at a state, and those of them that are more than rounding."""
        found = spectrum(there, faster)
        shaken = _changes(found, spectrum(model.integrate(there, np.full(nv, ROUNDED)), faster))
        return found, found[shaken < _SHAKEN]

    here = known(q, v)
    change = _change(here, known(model.integrate(q, step / max(1.0, np.abs(step).max() / _FARTHEST)), v))
    going = float(np.abs(onwards).max())
    if going > _GOES_ON * alone:
        slowest = float(np.abs(here[1]).min(initial=np.inf))
        there = model.integrate(q, onwards * (_FARTHEST / going))
        change = max(change, _change(here, known(there, v + onwards / slowest if np.any(v) else v)))
    if not change > _NOTED:
        return ()
    worst = int(np.argmax(np.abs(a)))
    note = (
        f"the state is neither an equilibrium nor a steady motion: '{model.names.v[worst]}' accelerates by"
        f" {a[worst]:.3g}, which changes eigenvalues by {min(100.0 * change, 100.0):.2g} %: these modes are of the"
        " instant alone; sf.equilibrium finds a rest"
    )
    return (note,)


def changing_notes(
    model: Model,
    state: tuple[Array, Array, Array],
    t: float,
    matrix: Matrix,
    s: Complex,
    changes: Complex,
    inertia: Array,
) -> tuple[str, ...]:
    """Note on a motion along which the linearised equations change; none where they stay what they are (7g).

    Args:
        model: Model in double precision.
        state: Configuration (nq), speeds (nv) and inputs (nu).
        t: Time [s].
        matrix: Gives the matrix of the linearised equations elsewhere on the motion.
        s: Eigenvalues, of rigid motions 0 (k).
        changes: Changes of the state of each (2 nv + nz, k).
        inertia: Diagonal of the mass matrix (nv), above zero.
    """
    q, v, u = state
    onwards = prescribed_rates(model, u)
    going, moves = float(np.abs(np.concatenate([v, onwards])).max(initial=0.0)), s != 0.0
    if not moves.any() or not (going or model.record.timed):
        return ()
    s, X, nv = s[moves], changes[:, moves], model.nv
    span = min(1.0 / float(np.abs(s).min()), _FARTHEST / going if going else np.inf)
    change = matrix(model.integrate(q, span * v), u + span * onwards, t + span) - matrix(q, u, t)
    scale = np.ones(X.shape)  # Coordinates in one unit, speeds in units of |s_k|.
    scale[: 2 * nv] = np.sqrt(inertia)[np.r_[0:nv, 0:nv], np.newaxis]
    scale[nv : 2 * nv] /= np.abs(s)
    shares = np.linalg.norm(scale * (change @ X), axis=0) / (np.abs(s) * np.linalg.norm(scale * X, axis=0))
    if not shares.max() > _NOTED:
        return ()
    note = (
        f"the linearised equations change along this motion, for a mode by {min(100.0 * shares.max(), 100.0):.2g} % in"
        f" {span:.3g} s: these modes are of the instant alone; describe the motion by coordinates and speeds in which"
        " the equations stay the same, as along axes that turn with it"
    )
    return (note,)


def imbalance(
    model: Model, state: tuple[Array, Array, Array, Array], par: ArrayLike | None, t: float
) -> tuple[str, float]:
    """The speed that changes most at a state, and its acceleration; "" and 0 at an equilibrium or in a steady motion.

    Arguments as of `imbalance_notes`.
    """
    a, alone = _accelerations(model, state, par, t)
    if not np.abs(a).max(initial=0.0) > _BALANCED * alone:
        return "", 0.0
    worst = int(np.argmax(np.abs(a)))
    return model.names.v[worst], float(a[worst])


def _accelerations(
    model: Model, state: tuple[Array, Array, Array, Array], par: ArrayLike | None, t: float
) -> tuple[Array, float]:
    """Accelerations (nv) and the largest that forces alone would give; (0), 0 where they are not known."""
    (q, v, u, _), z = state, state[3] if model.nz else None
    try:
        a = np.asarray(model.forward_dynamics(q, v, u, par=par, t=t, z=z))
        M, h, Q = model.dynamics(q, v, u, par=par, t=t, z=z)
        return a, float(np.abs(np.linalg.solve(M, np.stack([h, Q], axis=-1))).max(initial=0.0))
    except (SymofrosError, np.linalg.LinAlgError):  # Functions that were left out; what moves no mass.
        return np.zeros(0), 0.0


def rounding(s: Complex, shaken: Complex) -> npt.NDArray[np.bool_]:
    """Whether eigenvalues are rounding (k): small, and others where the state is moved by ROUNDED [rad or m]."""
    both: npt.NDArray[np.bool_] = (np.abs(s) <= _SMALL * np.abs(s).max(initial=0.0)) & (_changes(s, shaken) > _SHAKEN)
    return both


def _towards_balance(stiffness: Array, a: Array) -> tuple[Array, Array]:
    """The displacement s, and the acceleration r in which nothing changes at first, a = r - K s and K r = 0 (7e)."""
    _, sizes, directions = np.linalg.svd(stiffness)
    free = directions[sizes <= _RANK * sizes[0]].T
    both = np.linalg.pinv(np.hstack([-stiffness, free]), rcond=_RANK) @ a
    return np.asarray(both[: len(a)]), np.asarray(free @ both[len(a) :])


def _changes(some: Complex, others: Complex) -> Array:
    """Distance of each eigenvalue to the nearest other one, as a share of it; infinite of one that is zero."""
    distances, sizes = np.abs(some[:, np.newaxis] - others).min(axis=1, initial=np.inf), np.abs(some)
    shares: Array = np.divide(distances, sizes, out=np.full(len(some), np.inf), where=sizes > 0.0)
    return shares


def _change(here: tuple[Complex, Complex], there: tuple[Complex, Complex]) -> float:
    """The largest of those of eigenvalues that are more than rounding, either way."""
    return max(float(_changes(x[1], y[0]).max(initial=0.0)) for x, y in ((here, there), (there, here)))
