"""Linear state space in independent coordinates (docs/theory/linear.md, eq. 6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from symofros.base.arguments import checked
from symofros.base.arrays import Array, numeric
from symofros.base.measures import Measures
from symofros.errors import AssemblyError, SymofrosError
from symofros.runtime.constrained import null_space, pseudo_inverse
from symofros.runtime.model import ArrayLike, Model, Output
from symofros.simulation.analysis.kinematics.consistency import Refusal, consistent_jacobian
from symofros.simulation.analysis.singular_mass import ADVICE, singular_mass
from symofros.simulation.analysis.states import given_inputs

ON_CONSTRAINTS = Refusal(
    AssemblyError,
    "the state",
    "a linear model is about a state with phi = 0 and G v = b",
    "q and v from sf.assemble or model.project",
    1e-4,  # What runs with Baumgarte's stabilization meet: 1e-6 to 1e-5. Linear models are off by as much.
)


@dataclass(frozen=True)
class StateSpace:
    """xi' = A xi + B u, y = C xi + D u for the small changes that the constraints allow.

    Attributes:
        A: (n, n).
        B: (n, nu).
        C: (p, n).
        D: (p, nu).
        basis: S, whose orthonormal columns lead to the state's changes: (along q, of v, of z) = S xi (2 nv + nz, n).
    """

    A: Array
    B: Array
    C: Array
    D: Array
    basis: Array


@checked
def state_space(
    model: Model,
    q: ArrayLike,
    v: ArrayLike | None = None,
    u: ArrayLike | None = None,
    *,
    outputs: Sequence[Output] = (),
    par: ArrayLike | None = None,
    t: float = 0.0,
    z: ArrayLike | None = None,
) -> StateSpace:
    """Linearise about a state, on the constraints.

    Without constraints xi is the state's change itself. With them, xi are coordinates of what phi = 0 and G v = b
    leave; inputs must not move the constraints (as a prescribed joint inside a loop would).

    Args:
        model: Model, with or without constraints.
        q: Configuration (nq), on the constraints.
        v: Speeds (nv); zero if not given.
        u: Inputs (nu); the defaults if not given.
        outputs: Outputs that y stacks, as in `Model.linearize`.
        par: Run-time parameters.
        t: Time.
        z: States of forces (nz); the neutral ones, zeros, if not given.

    Raises:
        AssemblyError: The state violates the constraints, or a closure is closed the wrong way round.
        UnknownNameError: No such output or frame.
        SymofrosError: The accelerations have no derivatives, as where the mass matrix is singular.
    """
    model.record.refuse_rigid_contacts("state_space")
    model = model.with_precision("double")
    v = np.zeros(model.nv) if v is None else numeric("v", model.by_name("v", v))
    u = given_inputs(model, u)
    consistent_jacobian(model, (q, v, None, u), par, t, ON_CONSTRAINTS)
    return about(model, q, v, u, outputs=outputs, par=par, t=t, z=z)


def about(
    model: Model,
    q: ArrayLike,
    v: Array,
    u: Array,
    *,
    outputs: Sequence[Output] = (),
    par: ArrayLike | None = None,
    t: float = 0.0,
    z: ArrayLike | None = None,
) -> StateSpace:
    """`state_space` of a model in double precision about a state that may be off the constraints by a little."""
    A, B, C, D = model.linearize(q, v, u, outputs=outputs, par=par, t=t, z=z)
    if not np.all(np.isfinite(A)):
        configuration = numeric("q", model.by_name("q", q))
        raise SymofrosError(
            f"model '{model.record.name}': no linear model about this state",
            singular_mass(model, configuration, par, u) or "derivatives that are not finite",
            "accelerations and their derivatives are finite",
            ADVICE,
        )
    S = np.eye(len(A))
    if model.nc:  # Constraints do not bind states of forces.
        allowed = _allowed(model, q, v, u, par, t)
        S = np.block(
            [[allowed, np.zeros((len(allowed), model.nz))], [np.zeros((model.nz, allowed.shape[1])), np.eye(model.nz)]]
        )
    return StateSpace(S.T @ A @ S, S.T @ B, C @ S, D, S)


def _allowed(model: Model, q: ArrayLike, v: Array, u: Array, par: ArrayLike | None, t: float) -> Array:
    """A basis of the changes that the constraints of a model allow."""
    rate_by_q = model.constraint_rate_derivative(q, v, u=u, par=par, t=t)
    G = model.constraint_jacobian(q, u=u, par=par, t=t)
    names = model.names.constraints
    on_positions = [i for i, name in enumerate(names) if name not in model.record.speed_conditions]
    return allowed_changes(G, rate_by_q, on_positions, model.record.measures, np.ones(model.nv, dtype=np.bool_))


def allowed_changes(
    G: Array, rate_by_q: Array, on_positions: Sequence[int], measures: Measures, moving: npt.NDArray[np.bool_]
) -> Array:
    """A basis (2 nv, n) of the solutions of P dq = 0, (d(G v - b)/dq) dq + G dv = 0 (eq. 5).

    Args:
        G: Constraint Jacobian (nc, nv).
        rate_by_q: d(G v - b)/dq (nc, nv).
        on_positions: Rows of G that bind coordinates: those of P.
        measures: Measures of G.
        moving: Whether each coordinate is one (nv); others, of states that are integrated as speeds, have no changes.
    """
    nv = len(moving)
    changes, speeds = null_space(G[on_positions], measures.of_rows(on_positions)), null_space(G, measures)
    if not moving.all():  # The others are free directions of their own.
        directions, _, _ = np.linalg.svd(changes * moving[:, np.newaxis], full_matrices=False)
        changes = directions[:, : changes.shape[1] - np.count_nonzero(~moving)]
    followed = -pseudo_inverse(G, measures) @ rate_by_q @ changes
    basis = np.block([[changes, np.zeros((nv, speeds.shape[1]))], [followed, speeds]])
    return np.asarray(np.linalg.qr(basis)[0], dtype=np.float64)
