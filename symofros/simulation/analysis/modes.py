"""Vibration modes: eigenvalues of the linearised equations, on the constraints (docs/theory/linear.md)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from symofros.base.arguments import checked
from symofros.base.arrays import Array, vector
from symofros.errors import SymofrosError
from symofros.runtime.beams import BEAM_LIMIT, BeamBending, bending_notes
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.beam_theory import bendings_in_motion, refuse_beyond
from symofros.simulation.analysis.force_states import kink_notes
from symofros.simulation.analysis.imbalance import ROUNDED, changing_notes, imbalance_notes, rounding
from symofros.simulation.analysis.kinematics.consistency import consistent_jacobian
from symofros.simulation.analysis.rest_linearisation import functions_of_modes, matrix_at_rest
from symofros.simulation.analysis.rigid_motions import Complex, RigidMotions, rigid_motions
from symofros.simulation.analysis.singular_mass import ADVICE, singular_mass
from symofros.simulation.analysis.state_space import ON_CONSTRAINTS, about
from symofros.simulation.analysis.states import given_configuration, given_inputs
from symofros.simulation.analysis.unresolved_modes import (
    Vibrations,
    judged_beams,
    resolution_notes,
    too_high,
    unjudged_notes,
)

# Share of its states of forces below which a mode's coordinates are rounding.
_STILL = 1e-12
# Damping by rounding.
_UNDAMPED = 1e-9


@dataclass(frozen=True)
class Modes:
    """Modes in the order of their frequencies; conjugate eigenvalues count once, as the two of a rigid motion do.

    A motion that is damped more than critically has two real eigenvalues, and two entries here; without such, and
    without states of forces, there are at most nv.

    Attributes:
        eigenvalues: s of each mode, with Im(s) >= 0 [1/s] (k); exactly 0 of rigid motions, which come first.
        frequencies: |s| [rad/s] (k), of motions without oscillation, too: `print(modes)` says which those are.
        damping: -Re(s)/|s|: positive decays, negative grows; a rigid motion (s = 0) counts 0 (k).
        shapes: Coordinates of each mode, scaled to a largest entry of 1 (nv, k); zeros where states of forces alone
            change.
        bendings: Bending of each beam in the state, with the error of its theory.
        notes: Remarks: a state in which forces do not balance, a motion along which the equations change, beams whose
            theory errs by more than a per cent or whose functions are too few for a mode, forces and rates of states of
            forces that have a kink.
        too_high: How far each frequency is above the one of beams with enough shape functions, relative (k): an
            estimate (docs/theory/beams.md, section 10); NaN of what does not oscillate and where there are no beams, or
            none that can be judged, which a note says.
        z_shapes: States of forces of each mode, as they change with `shapes` (nz, k); scaled to a largest entry of 1
            where they alone change.
    """

    eigenvalues: Complex
    frequencies: Array
    damping: Array
    shapes: Complex
    bendings: tuple[BeamBending, ...] = ()
    notes: tuple[str, ...] = ()
    z_shapes: Complex = field(default_factory=lambda: np.zeros((0, 0), dtype=np.complex128))
    too_high: Array = field(default_factory=lambda: np.zeros(0))

    def __str__(self) -> str:
        """A line a mode, in words: what decays or grows without oscillation has no frequency in Hz; then the notes."""
        rates = [f"mode {k}: {_in_words(s)}" for k, s in enumerate(self.eigenvalues.tolist())]
        return "\n".join([*rates, *(f"note: {note}" for note in self.notes)]) or "no modes: nothing moves"


def _in_words(s: complex) -> str:
    """A mode exp(s t) [1/s]."""
    if s == 0.0:
        return "rigid motion"
    if s.imag == 0.0:
        return f"{'grows' if s.real > 0.0 else 'decays'} at {abs(s.real):.6g} 1/s"
    damping = -s.real / abs(s)
    damped = (
        "" if abs(damping) <= _UNDAMPED else f", {'damping' if damping > 0.0 else 'growing, damping'} {damping:.4g}"
    )
    return f"oscillates at {s.imag:.6g} rad/s = {s.imag / (2.0 * np.pi):.6g} Hz{damped}"


@checked
def modes(
    model: Model,
    q: ArrayLike,
    v: ArrayLike | None = None,
    u: ArrayLike | None = None,
    *,
    par: ArrayLike | None = None,
    t: float = 0.0,
    beam_limit: float = BEAM_LIMIT,
    z: ArrayLike | None = None,
) -> Modes:
    """Modes of small motions about a state, which should be an equilibrium or a steady motion (`equilibrium`).

    Args:
        model: Model, with or without constraints.
        q: Configuration (nq).
        v: Speeds (nv); zero if not given.
        u: Inputs (nu); the defaults if not given.
        par: Run-time parameters.
        t: Time.
        beam_limit: Estimated error of the beams' second-order theory in the state beyond which there is no result
            (docs/theory/beams.md, section 6); `math.inf` for no limit.
        z: States of forces (nz); the neutral ones, zeros, if not given.

    Raises:
        AssemblyError: The state violates the constraints, or a closure is closed the wrong way round.
        BeamTheoryError: A beam is bent beyond the limit.
        SymofrosError: The mass matrix is singular.
    """
    model.record.refuse_rigid_contacts("modes")
    v = np.zeros(model.nv) if v is None else vector("v", model.by_name("v", v), model.nv)
    state = (given_configuration(model, q), v, vector("u", given_inputs(model, u), model.nu))
    consistent_jacobian(model.with_precision("double"), (*state[:2], None, state[2]), par, t, ON_CONSTRAINTS)
    states = np.zeros(model.nz) if z is None else vector("z", model.by_name("z", z), model.nz)
    judged = judged_beams(model, par)
    if judged:
        model.prepare("section_forces", *functions_of_modes(model, state[1]))
    A, basis, balanced = _linearised(model, *state, states, par, t)
    # Without constraints A holds the derivatives of the accelerations.
    slopes = None if model.nc else A[model.nv :, : model.nv]
    moving = model.carried
    q, v = (np.asarray(x) for x in model.carry(*state[:2], states))
    bendings = bendings_in_motion(moving, q, v, state[2], par, t, slopes)
    refuse_beyond(model, bendings, beam_limit, "the state of the modes")
    massless = singular_mass(model.with_precision("double"), state[0], par, state[2])
    if massless:
        rule = "accelerations follow from forces by the mass matrix"
        raise SymofrosError(f"model '{model.record.name}': no modes about this state", massless, rule, ADVICE)
    M = model.mass_matrix(state[0], u=state[2], par=par) if model.has("mass_matrix") else np.eye(model.nv)
    inertia = np.where(np.diagonal(M) > 0.0, np.diagonal(M), 1.0)
    shaken = None
    if np.any(state[1]):  # At rest rounding of A tells as much (7c).
        moved = model.integrate(state[0], np.full(model.nv, ROUNDED))
        shaken = np.linalg.eigvals(_linearised(model, moved, *state[1:], states, par, t)[0]).astype(np.complex128)
    s, changes, rigid = _motions(A, basis, inertia, shaken)
    others = np.flatnonzero(~rigid.zeros & (s.imag >= 0.0))
    order = [*rigid.chosen, *others[np.argsort(np.abs(s[others]), kind="stable")]]
    s = s[order]
    size = np.abs(s)
    damping = np.where(size > 0.0, -s.real / np.where(size > 0.0, size, 1.0), 0.0)
    shapes, z_shapes = _shapes(changes[: model.nv, order], changes[2 * model.nv :, order])
    values = model.parameter_values if par is None else model.checked_parameters(par)
    smooth = model.record.smooth_friction_notes(state[1], np.asarray(values))
    notes = (
        bending_notes(bendings, vibrating=True)
        + kink_notes(moving, q, v, state[2], par, t)
        + smooth
        + unjudged_notes(model, par, judged)
    )
    errors = np.full(len(s), np.nan)
    if judged:
        vibrations = Vibrations(s, changes[:, order], M, balanced)
        errors, by_beam = too_high(model.with_precision("double"), (*state, states), par, t, vibrations, judged)
        notes += resolution_notes(s, errors, by_beam)

    def spectrum(q: Array, v: Array) -> Complex:
        A, basis, _ = _linearised(model, q, v, state[2], states, par, t)
        return _motions(A, basis, inertia)[0]

    def matrix(q: Array, u: Array, t: float) -> Array:
        # What rests here may move there: its rate of stiffness is looked at by the same functions.
        A, basis, _ = _linearised(model, q, state[1], u, states, par, t, judged=not balanced)
        return np.asarray(basis @ A @ basis.T)

    double = model.with_precision("double")
    passing = () if balanced else imbalance_notes(double, (*state, states), par, t, spectrum)
    notes = (*(passing or changing_notes(double, state, t, matrix, s, changes[:, order], inertia)), *notes)
    return Modes(s, size, damping, shapes, bendings, notes, z_shapes, errors)


def _motions(
    A: Array, basis: Array, inertia: Array, shaken: Complex | None = None
) -> tuple[Complex, Complex, RigidMotions]:
    """Eigenvalues, which are 0 of rigid motions, their changes of the state, and which are rigid.

    Args:
        A: Matrix of the independent changes (k, k).
        basis: Changes of the state of each (2 nv + nz, k).
        inertia: Diagonal of the mass matrix (nv).
        shaken: Eigenvalues where the state is moved by rounding (k), if those of A may be rounding.
    """
    s, vectors = np.linalg.eig(A)
    if shaken is not None:
        s = np.where(rounding(s, shaken), 0.0, s)
    changes = np.asarray(basis @ vectors, dtype=np.complex128)
    rigid = rigid_motions(A, basis, s, changes, inertia)
    return np.where(rigid.zeros, 0.0, s).astype(np.complex128), changes, rigid


def _shapes(X: Complex, Z: Complex) -> tuple[Complex, Complex]:
    """Coordinates (nv, k) and states (nz, k) of modes, scaled by the largest coordinate, or state where none moves."""
    moves = np.abs(X).max(axis=0, initial=0.0) > _STILL * np.abs(Z).max(axis=0, initial=0.0)
    X = np.where(moves, X, 0.0)
    both = np.concatenate([X, np.where(moves, 0.0, Z)])
    largest = np.take_along_axis(both, np.abs(both).argmax(axis=0)[None], axis=0)
    scale = np.where(largest == 0.0, 1.0, largest)
    return X / scale, Z / scale


def _linearised(
    model: Model, q: Array, v: Array, u: Array, z: Array, par: ArrayLike | None, t: float, *, judged: bool = True
) -> tuple[Array, Array, bool]:
    """A and the basis of `state_space`; at a rest of many elastic coordinates by shorter functions, and whether so."""
    if not np.any(v) and not model.nz:
        A = matrix_at_rest(model.with_precision("double"), q, u, par, t, judged=judged)
        if A is not None:
            return A, np.eye(2 * model.nv), True
    linear_model = about(model.with_precision("double"), q, v, u, par=par, t=t, z=z if model.nz else None)
    return linear_model.A, linear_model.basis, False
