"""Inverse kinematics: configurations, speeds and accelerations that put frames where they are wanted."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from symofros.base.arguments import checked
from symofros.base.measures import ANGLE, LENGTH, Measures
from symofros.errors import AssemblyError, Problem, SymofrosError
from symofros.runtime.beams import BEAM_LIMIT, BeamBending, bending_notes
from symofros.runtime.calls.kernel import Array
from symofros.runtime.constrained import LARGEST_STEP, pseudo_inverse
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.beam_theory import bendings_in_motion
from symofros.simulation.analysis.input_rotations import given_inputs
from symofros.simulation.analysis.kinematics.assembly import Indices, free_speeds
from symofros.simulation.analysis.kinematics.facing import facings
from symofros.simulation.analysis.kinematics.nearest_posture import OPTIMALITY, NearestPosture, coordinate_limits
from symofros.simulation.analysis.kinematics.targets import Target as Target
from symofros.simulation.analysis.kinematics.targets import Task, finite_array, rotations_checked

# Damping of the least squares, relative to the largest singular value: first value, and factors after a good step and
# a bad one (Levenberg-Marquardt).
_DAMPING, _RELAX, _TIGHTEN = 1e-3, 0.2, 8.0
_SMALLEST_GAIN = 1e-16


@dataclass(frozen=True)
class Reached:
    """The configuration nearest to what was wanted.

    Attributes:
        q: Configuration (nq), within its limits.
        error: Largest remaining error of position [m], rotation [rad] and constraints.
        converged: Whether the error is below the tolerance and, with a posture of rest, the distance from it is least
            among the solutions nearby, to first order, and no beam is bent beyond its theory; otherwise the target is
            out of reach from here.
        iterations: Steps taken.
        distance: Distance from rest: norm of differences of coordinates and of rotation vectors; 0 without rest.
        gradient: Norm of the distance's gradient along the solutions, times the distance: of what remains of q - rest
            in the null space of the targets' Jacobian, less what joint limits hold; 0 without rest.
        bendings: Bending of each beam, with the error of its theory.
        notes: Remarks: beams whose theory errs by more than a per cent.
    """

    q: Array
    error: float
    converged: bool
    iterations: int
    distance: float = 0.0
    gradient: float = 0.0
    bendings: tuple[BeamBending, ...] = ()
    notes: tuple[str, ...] = ()


@checked
def inverse_kinematics(
    model: Model,
    targets: Mapping[str, Target],
    q: ArrayLike | None = None,
    *,
    rest: ArrayLike | None = None,
    held: Collection[str] = (),
    u: ArrayLike | None = None,
    par: ArrayLike | None = None,
    tolerance: float = 1e-10,
    iterations: int = 200,
    beam_limit: float = BEAM_LIMIT,
) -> Reached:
    """Damped least squares on the targets and, for mechanisms with loops, on their constraints.

    With a posture of rest, descent on the solutions follows, from what is reached from the guess and from what is
    reached from rest, and the nearer end counts (docs/theory/constraints.md, section 9). It is a local minimum:
    branches of solutions that neither start leads to are not searched.

    Args:
        model: Model, whose joint limits are kept.
        targets: Frame -> where it is wanted.
        q: Guess (nq); rest, or the neutral configuration, if not given.
        rest: Configuration to stay nearest to with the freedom that is left (nq).
        held: Names of speeds whose coordinates stay.
        u: Inputs, for prescribed motions.
        par: Run-time parameters.
        tolerance: Bound of the largest error.
        iterations: Most steps from one start.
        beam_limit: Estimated error of the beams' second-order theory, relative to the deflection, beyond which a
            configuration does not count as reached (docs/theory/beams.md, section 6).

    Raises:
        UnknownNameError: No such frame or speed.
        ShapeError: A target, the guess or rest does not fit, or is not of finite numbers.
        SymofrosError: A target's matrix is not a rotation, or nothing is asked for.
    """
    model = model.with_precision("double")
    free = free_speeds(model, held)
    task = Task(model, targets, u, par)
    resting = None if rest is None else _configuration(model, "rest", rest)
    if q is not None:
        starts = [_configuration(model, "q", q)]
    else:
        starts = [np.array(model.neutral() if resting is None else resting)]
    if resting is None:
        return _judged(task, _reach(task, starts[0], free, tolerance, iterations), beam_limit)
    if q is not None and not held:
        starts.append(resting)
    nearest = min(
        (_reach_near(task, start, resting, free, tolerance, iterations) for start in starts),
        key=lambda reached: (not reached.converged, reached.distance if reached.converged else reached.error),
    )
    return _judged(task, nearest, beam_limit)


def _judged(task: Task, reached: Reached, beam_limit: float) -> Reached:
    """The same with its beams as they are when released there.

    It has not converged where one is bent beyond the limit, or a closure is closed the wrong way round.
    """
    model, given = task.model, task.inputs["u"]
    u = given_inputs(model, given)
    bendings = bendings_in_motion(model, reached.q, np.zeros(model.nv), u, task.inputs["par"])
    within = all(bending.error <= beam_limit for bending in bendings)
    opposite = [closure for closure, cosine in facings(model, reached.q, u, task.inputs["par"]) if cosine < 0.0]
    notes = tuple(f"closure '{closure}' is closed the wrong way round" for closure in opposite)
    converged = reached.converged and within and not opposite
    return replace(reached, converged=converged, bendings=bendings, notes=notes + bending_notes(bendings))


def _reach(task: Task, q: Array, free: Indices, tolerance: float, iterations: int) -> Reached:
    """Damped least squares from a guess, within the limits."""
    model = task.model
    q = _within(model, q, free)
    error, damping, count = task.error(q), _DAMPING, 0
    _refuse_nan(task, error)
    while np.abs(error).max(initial=0.0) > tolerance and count < iterations:
        J = task.jacobian(q)
        movable = _movable(model, q, J.T @ error, free)
        step = np.zeros(model.nv)
        step[movable] = _damped(J[:, movable], error, damping)
        step *= min(1.0, LARGEST_STEP / max(float(np.abs(step).max(initial=0.0)), 1e-300))
        tried = _within(model, model.integrate(q, step), free)
        error_tried = task.error(tried)
        count += 1
        gain = float(error @ error - error_tried @ error_tried)
        if gain > 0.0:
            q, error, damping = tried, error_tried, damping * _RELAX
        else:
            damping *= _TIGHTEN
        if damping > 1e8 or 0.0 <= gain <= _SMALLEST_GAIN * float(error @ error):
            break
    left = float(np.abs(error).max(initial=0.0))
    return Reached(q, left, left <= tolerance, count)


def _polished(task: Task, q: Array, free: Indices) -> Array:
    """The solution after a step without damping, to rounding: distances of solutions are compared to all digits."""
    error, J = task.error(q), task.jacobian(q)
    movable = _movable(task.model, q, J.T @ error, free)
    step = np.zeros(task.model.nv)
    step[movable] = pseudo_inverse(J[:, movable], task.measures.of_speeds(movable)) @ error
    tried = _within(task.model, task.model.integrate(q, step), free)
    return tried if np.linalg.norm(task.error(tried)) < np.linalg.norm(error) else q


def _reach_near(task: Task, q: Array, rest: Array, free: Indices, tolerance: float, iterations: int) -> Reached:
    """A solution from a guess, then descent of the distance from rest among the solutions."""
    reached = _reach(task, q, free, tolerance, iterations)

    def restore(at: Array, movable: Indices, most: int) -> tuple[Array, float, int]:
        near = _reach(task, at, movable, tolerance, most)
        return (_polished(task, near.q, movable) if near.converged else near.q), near.error, near.iterations

    nearest = NearestPosture(task, rest, free, restore, tolerance)
    q, count = reached.q, 0
    if reached.converged:
        q, count = nearest.descend(_polished(task, q, free), iterations - reached.iterations)
    error, distance = float(np.abs(task.error(q)).max(initial=0.0)), nearest.distance(q)
    gradient = float(np.linalg.norm(nearest.projected_pull(q)[0]))
    converged = error <= tolerance and gradient <= OPTIMALITY * (1.0 + distance)
    return Reached(q, error, converged, reached.iterations + count, distance, gradient)


@checked
def joint_motion(
    model: Model,
    frame: str,
    positions: npt.ArrayLike,
    velocities: npt.ArrayLike,
    accelerations: npt.ArrayLike,
    rotations: npt.ArrayLike | None = None,
    *,
    q: ArrayLike | None = None,
    par: ArrayLike | None = None,
    tolerance: float = 1e-9,
) -> tuple[Array, Array, Array]:
    """A frame's motion -> q, v and v' at each of its samples.

    Args:
        model: A tree.
        frame: Frame whose motion is given.
        positions: p_WF (n, 3) [m].
        velocities: Linear, then angular velocity in world axes (n, 6); (n, 3) if rotations do not matter.
        accelerations: Linear, then angular accelerations in world axes (n, 6) or (n, 3).
        rotations: R_WF (n, 3, 3); none if they do not matter.
        q: Guess for the first sample (nq); each next one starts from the last.
        par: Run-time parameters.
        tolerance: Tolerance of the largest error.

    Returns:
        q (n, nq), v (n, nv), v' (n, nv): of least norm where there is freedom.

    Raises:
        AssemblyError: A sample is out of reach; says which.
        ShapeError: An array does not fit the others, or is not of finite numbers.
        SymofrosError: A matrix is not a rotation.
    """
    model = model.with_precision("double")
    what = f"motion of frame '{frame}'"
    p = finite_array(f"{what}: positions", positions, ("n", 3), "give one row of x, y and z a sample")
    n, columns = len(p), 3 if rotations is None else 6
    R = None
    if rotations is not None:
        R = finite_array(f"{what}: rotations", rotations, (n, 3, 3), "give one matrix R_WF for each position")
        R = rotations_checked(what, R)
    remedy = f"give {columns} columns and one row for each position; linear first, then angular if rotations are given"
    V, A = (
        finite_array(f"{what}: {name}", x, (n, columns), remedy)
        for name, x in (("velocities", velocities), ("accelerations", accelerations))
    )
    rows = 3 if R is None else 6
    motion: list[tuple[Array, Array, Array]] = []
    units = (LENGTH, LENGTH, LENGTH, ANGLE, ANGLE, ANGLE)
    measures = Measures((0, 0, 0, 3, 3, 3)[:rows], units[:rows], model.record.measures.speed)
    for i in range(len(p)):
        at = inverse_kinematics(
            model, {frame: Target(p[i], None if R is None else R[i])}, q, par=par, tolerance=tolerance
        )
        if not at.converged:
            raise AssemblyError(
                Problem(
                    f"model '{model.record.name}': frame '{frame}' can't follow",
                    "; ".join([f"an error of {at.error:.3g} at sample {i}", *at.notes]),
                    "every sample is within reach",
                    "move the path, or start from another configuration",
                )
            )
        q = at.q
        J = model.frame_jacobian(frame, q, par=par)[:rows]
        inverse = pseudo_inverse(J, measures)
        v = inverse @ V[i]
        rate = model.frame_jacobian_rate(frame, q, v, par=par)[:rows]
        motion.append((q, v, inverse @ (A[i] - rate @ v)))
    qs, vs, accs = zip(*motion, strict=True)
    return np.array(qs), np.array(vs), np.array(accs)


def _damped(J: Array, error: Array, damping: float) -> Array:
    U, s, Vt = np.linalg.svd(J, full_matrices=False)
    floor = damping * s.max(initial=0.0)
    return np.asarray(Vt.T @ (s / (s**2 + floor**2 + 1e-300) * (U.T @ error)))


def _movable(model: Model, q: Array, wish: Array, free: Indices) -> Indices:
    """The free speeds without those that would push a coordinate through its limit."""
    limits = coordinate_limits(model)
    stuck = {k for i, k, low, high in limits if (q[i] <= low and wish[k] < 0.0) or (q[i] >= high and wish[k] > 0.0)}
    return np.array([k for k in free if k not in stuck], dtype=np.intp)


def _within(model: Model, q: Array, free: Indices) -> Array:
    """The configuration with its free coordinates moved to their limits where they are beyond them."""
    q, movable = np.array(q), set(free.tolist())
    for i, k, low, high in coordinate_limits(model):
        if k in movable:
            q[i] = min(max(q[i], low), high)
    return q


def _configuration(model: Model, name: str, values: ArrayLike) -> Array:
    """A configuration (nq) on the manifold."""
    remedy = f"give one number for each of {', '.join(model.names.q[:8])}" + (", …" if model.nq > 8 else "")
    q = finite_array(f"inverse kinematics: {name}", model.by_name("q", values), (model.nq,), remedy)
    with np.errstate(all="ignore"):
        on_manifold = model.integrate(q, np.zeros(model.nv))
    return finite_array(f"inverse kinematics: {name}", on_manifold, (model.nq,), "give quaternions that are not zero")


def _refuse_nan(task: Task, error: Array) -> None:
    if np.all(np.isfinite(error)):
        return
    raise SymofrosError(
        Problem(
            f"model '{task.model.record.name}': the error of the targets is not a number",
            f"{error[~np.isfinite(error)][0]} at the guess",
            "poses and constraints are finite at the guess",
            "check the inputs and parameters that are passed, or start from another guess",
        )
    )
