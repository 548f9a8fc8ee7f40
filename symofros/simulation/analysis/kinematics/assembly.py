"""Assembly: a configuration that closes every loop, near a guess, and speeds that keep it closed."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from symofros.base.arguments import checked
from symofros.base.arrays import numeric
from symofros.errors import AssemblyError, Problem, UnknownNameError, did_you_mean
from symofros.runtime.calls.kernel import Array
from symofros.runtime.constrained import (
    LARGEST_STEP,
    RESIDUAL_ROUNDING,
    eliminate,
    pseudo_inverse,
    residual_rounding,
    residual_weights,
    step_factor,
)
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.input_rotations import given_inputs
from symofros.simulation.analysis.kinematics.targets import finite_array
from symofros.simulation.settings import refuse_lengths

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
    tolerance: float = 1e-12,
    iterations: int = 100,
) -> Assembled:
    """Solve phi(q) = 0 and G v = b by damped Gauss-Newton steps of least norm.

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
        iterations: Most steps to take.

    Raises:
        AssemblyError: No such configuration was found; names the constraint that is worst.
        UnknownNameError: `held` names something that is not a speed.
        SymofrosError: A quaternion of the guess or of the inputs is no rotation.
    """
    free = free_speeds(model, held)
    model = model.with_precision("double")
    q = model.neutral() if q is None else numeric("q", model.by_name("q", q))
    refuse_lengths(model, q)
    u = given_inputs(model, u)
    speeds = np.zeros(model.nv) if v is None else model.by_name("v", v)
    wished = finite_array("assemble: v", speeds, (model.nv,), "give one number a speed")

    def residual(at: Array) -> Array:
        return model.constraint(at, u=u, par=par, t=t)

    phi, count = residual(q), 0
    if model.nc:  # A small mechanism closes to its own measure.
        G = model.constraint_jacobian(q, u=u, par=par, t=t)
        tolerance /= float(residual_weights(G, model.record.measures).max())
    while np.abs(phi).max(initial=0.0) > tolerance and count < iterations:
        G = model.constraint_jacobian(q, u=u, par=par, t=t)
        step = np.zeros(model.nv)
        step[free] = -_inverse(model, G[:, free], free) @ phi
        step *= step_factor(G, model.record.measures, step, LARGEST_STEP)
        for _ in range(30):
            tried = model.integrate(q, step)
            phi_tried = residual(tried)
            if np.linalg.norm(phi_tried) < np.linalg.norm(phi):
                break
            step *= 0.5
        else:
            break
        q, phi, count = tried, phi_tried, count + 1
    G = model.constraint_jacobian(q, u=u, par=par, t=t)
    _accept(model, phi, _bounds(model, q, G, tolerance), count, held)
    _check_rotations(model, q, u, par)
    speeds, inverse = wished.copy(), _inverse(model, G[:, free], free)
    for _ in range(2):  # The second time against the rounding of columns of unlike sizes.
        speeds[free] -= inverse @ model.constraint_rate(q, speeds, u=u, par=par, t=t)
    left = model.constraint_rate(q, speeds, u=u, par=par, t=t)
    bounds = _bounds(model, q, G, tolerance) * (1.0 + float(np.abs(wished).max(initial=0.0)))
    if np.any(np.abs(left) > 1e3 * bounds):
        worst = int(np.argmax(np.abs(left) / bounds))
        raise AssemblyError(
            Problem(
                f"model '{model.record.name}': no speeds keep it closed",
                f"G v - b = {left[worst]:.3g} at '{model.names.constraints[worst]}'",
                "the speeds that are held must allow G v = b",
                "hold fewer speeds",
            )
        )
    rank = eliminate(G, model.record.measures, np.ones(model.nv)).rank
    return Assembled(q, speeds, float(np.abs(phi).max(initial=0.0)), count, rank)


def _inverse(model: Model, G: Array, free: Indices) -> Array:
    """The pseudo-inverse of the constraints' Jacobian by the free speeds."""
    if not np.all(np.isfinite(G)):
        worst = model.names.constraints[int(np.argmin(np.isfinite(G).all(axis=1)))]
        raise AssemblyError(
            Problem(
                f"model '{model.record.name}': can't be assembled from this guess",
                f"'{worst}' has no finite derivative there",
                "constraints are smooth near the guess; a disc that lies flat has no contact, for example",
                "start from another guess",
            )
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
                Problem(
                    f"held: no speed '{name}'",
                    name,
                    "held names speeds of the model",
                    did_you_mean(name, model.names.v) or "see model.names.v",
                )
            )
    return np.array([i for i, name in enumerate(model.names.v) if name not in held], dtype=np.intp)


def _bounds(model: Model, q: Array, G: Array, tolerance: float) -> Array:
    """Largest |phi| that closes each condition (nc): the tolerance, or the rounding of coordinates and lengths."""
    rounding = np.maximum(
        residual_rounding(G, model.record.measures), RESIDUAL_ROUNDING * (1.0 + np.abs(q).max(initial=0))
    )
    return np.asarray(np.maximum(tolerance, rounding), dtype=np.float64)


def _accept(model: Model, phi: Array, bounds: Array, count: int, held: Collection[str]) -> None:
    if np.all(np.abs(phi) <= bounds):
        return
    worst = int(np.argmax(np.abs(phi) / bounds))
    also = f"; held: {', '.join(held)}" if held else ""
    raise AssemblyError(
        Problem(
            f"model '{model.record.name}': can't be assembled from this guess",
            f"after {count} steps phi = {phi[worst]:.3g} at '{model.names.constraints[worst]}'{also}",
            f"|phi| <= {bounds[worst]:.2g}; either no configuration closes it, or the guess leads to none",
            "start nearer, hold fewer coordinates, or check lengths",
        )
    )


def _check_rotations(model: Model, q: Array, u: ArrayLike | None, par: ArrayLike | None) -> None:
    """Conditions on rotations vanish at the opposite posture, too; that one is not closed."""
    for closure in model.record.closures:
        if not closure.rotations:
            continue
        R_A, R_B = (
            np.eye(3) if frame is None else model.frame_pose(frame, q, u=u, par=par)[1]
            for frame in (closure.first, closure.second)
        )
        cosines = np.diag(R_A.T @ R_B)
        blocked = closure.rotations
        judged = {3: [0, 1, 2], 2: [k for k in range(3) if k not in blocked]}.get(len(blocked), [])
        worst = min((float(cosines[k]) for k in judged), default=1.0)
        if worst < 0.0:
            angle = np.degrees(np.arccos(max(worst, -1.0)))
            raise AssemblyError(
                Problem(
                    f"model '{model.record.name}': closure '{closure.name}' is closed the wrong way round",
                    f"axes that are to be parallel are {angle:.0f} degrees apart",
                    "conditions on rotations hold up to a right angle from the closed posture",
                    "start from a guess on the right side",
                )
            )
