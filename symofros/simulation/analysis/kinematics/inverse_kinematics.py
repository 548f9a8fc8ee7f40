"""Inverse kinematics: configurations, speeds and accelerations that put frames where they are wanted."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from symofros.base.arguments import checked
from symofros.base.arrays import Array
from symofros.base.measures import ANGLE, LENGTH, Measures
from symofros.errors import AssemblyError, SymofrosError
from symofros.runtime.beams import BEAM_LIMIT, BeamBending, bending_notes
from symofros.runtime.constrained import pseudo_inverse
from symofros.runtime.manifold import at_unit_length
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.beam_theory import bendings_in_motion
from symofros.simulation.analysis.kinematics.assembly import free_speeds
from symofros.simulation.analysis.kinematics.posture_search import STARTS, Posture, PostureSearch
from symofros.simulation.analysis.kinematics.restarts import default_start
from symofros.simulation.analysis.kinematics.targets import CLOSED_TO, Task, finite_array, rotations_checked
from symofros.simulation.analysis.kinematics.targets import Target as Target
from symofros.simulation.analysis.states import check_search, given_inputs

# Beyond so many starts a target counts as out of reach: hours would pass without an answer.
_MAX_STARTS = 100_000
# Share of the largest rate of a motion that joints may miss, and the largest one of a frame that is taken to stand.
_MISSED, _SLOW = 1e-3, 1e-6


@dataclass(frozen=True)
class Reached:
    """The configuration nearest to what was wanted.

    Attributes:
        q: Configuration (nq); constraints hold there, whether or not the targets are reached.
        error: Largest remaining error of targets: of position [m] and rotation [rad].
        converged: Whether error and gap are below the tolerance and, with a posture of rest, the distance from it is
            least among the solutions nearby, to first order, and no beam is bent beyond its theory; otherwise no start
            led to the targets, and q misses them by least, as far as was found.
        iterations: Steps taken.
        distance: Distance from rest: norm of differences of coordinates and of rotation vectors; 0 without rest.
        gradient: Norm of the distance's gradient along the solutions, times the distance: of what remains of q - rest
            in the null space of the targets' Jacobian, less what joint limits hold; 0 without rest.
        bendings: Bending of each beam, with the error of its theory.
        notes: Remarks: beams whose theory errs by more than a per cent, loops that no start closes.
        gap: Largest residual of the constraints [m, rad].
        starts: Number of starts that were followed.
    """

    q: Array
    error: float
    converged: bool
    iterations: int
    distance: float = 0.0
    gradient: float = 0.0
    bendings: tuple[BeamBending, ...] = ()
    notes: tuple[str, ...] = ()
    gap: float = 0.0
    starts: int = 1


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
    tolerance: float = CLOSED_TO,
    iterations: int = 200,
    beam_limit: float = BEAM_LIMIT,
    starts: int = STARTS,
) -> Reached:
    """Damped least squares on the targets and, for mechanisms with loops, on their constraints.

    Where the guess does not lead to the targets, drawn starts follow, the same for the same model and guess, and of
    the solutions that the first successful round of them finds the one nearest to the guess counts. Where none leads
    there, the targets are out of reach as far as was found: the posture on the constraints and within the limits that
    misses them by least is returned. With a posture of rest, descent on the solutions follows, from what is reached
    from the guess and from what is reached from rest, and the nearer end counts. It is a local minimum: branches of
    solutions that neither start leads to are not searched (docs/theory/constraints.md, section 9).

    Args:
        model: Model, whose joint limits are kept.
        targets: Frame -> where it is wanted.
        q: Guess (nq); rest, or the neutral configuration with coordinates in the middle of limits that it breaks, if
            not given.
        rest: Configuration to stay nearest to with the freedom that is left (nq).
        held: Names of speeds whose coordinates stay.
        u: Inputs, for prescribed motions.
        par: Run-time parameters.
        tolerance: Bound of the targets' largest error; constraints close to 1e-10 however large it is.
        iterations: Most steps from one start; a descent to what misses the targets by least takes its own.
        beam_limit: Estimated error of the beams' second-order theory, relative to the deflection, beyond which a
            configuration does not count as reached (docs/theory/beams.md, section 6).
        starts: Most starts; with 1 the solution is on the branch that the guess leads to, or none is found.

    Raises:
        UnknownNameError: No such frame or speed.
        ShapeError: A target, the guess or rest does not fit, or is not of finite numbers.
        SymofrosError: A target's matrix is not a rotation, or nothing is asked for; or starts, iterations or tolerance
            is out of range.
    """
    model = model.with_precision("double")
    check_search("inverse kinematics", tolerance, iterations)
    check_starts(starts)
    task = Task(model, targets, u, par)
    solver = task.solver
    free = free_speeds(model, held) if held else solver.everything
    resting = None if rest is None else _configuration(model, "rest", rest)
    if q is not None:
        guess = _configuration(model, "q", q)
    else:
        guess = default_start(model) if resting is None else resting
    search = PostureSearch(task, guess, resting, free, tuple(held), tolerance, iterations)
    end = search.from_guess()
    if end.met and rest is None and not solver.facing and not solver.elastic:  # C knows all that counts.
        return Reached(end.q, float(solver.posture.error), True, end.steps, gap=float(solver.posture.gap))
    _refuse_nan(task, task.error(guess))
    return _judged(task, search.best(end, starts), tolerance, beam_limit)


def _judged(task: Task, found: Posture, tolerance: float, beam_limit: float) -> Reached:
    """The posture with its beams as they are when released there; not converged where one is bent beyond the limit."""
    bendings = _bendings(task, found.q) if task.solver.elastic else ()
    within = all(bending.error <= beam_limit for bending in bendings)
    missing = np.abs(task.error(found.q))
    error, gap = (float(part.max(initial=0.0)) for part in np.split(missing, [task.wishes]))
    notes = bending_notes(bendings)
    if gap > min(tolerance, CLOSED_TO):
        notes = (*notes, f"no start closes the loops: constraints are missed by {gap:.3g}")
    elif found.wrong_way_round:
        notes = (*notes, "a closure is closed the wrong way round: axes that are to be parallel point apart")
    return Reached(
        found.q,
        error,
        found.solved and within,
        found.steps,
        found.distance,
        found.gradient,
        bendings,
        notes,
        gap,
        found.starts,
    )


def _bendings(task: Task, q: Array) -> tuple[BeamBending, ...]:
    """Bending of each beam where the mechanism is released at a configuration."""
    model = task.model
    u = given_inputs(model, task.inputs["u"])
    return bendings_in_motion(model, q, np.zeros(model.nv), u, task.inputs["par"])


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
        AssemblyError: A sample, or its velocity or acceleration, is out of reach; says which.
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
        target = {frame: Target(p[i], None if R is None else R[i])}
        # From the second sample on, a motion that goes on never changes to another branch of solutions.
        at = inverse_kinematics(model, target, q, par=par, tolerance=tolerance, starts=1 if i else STARTS)
        if not at.converged:
            raise AssemblyError(
                f"model '{model.record.name}': frame '{frame}' can't follow",
                "; ".join([f"an error of {at.error:.3g} at sample {i}", *at.notes]),
                "every sample is within reach",
                "move the path, or start from another configuration",
            )
        q = at.q
        J = model.frame_jacobian(frame, q, par=par)[:rows]
        inverse = pseudo_inverse(J, measures)
        v = inverse @ V[i]
        bias = model.frame_jacobian_rate(frame, q, v, par=par)[:rows] @ v
        a = inverse @ (A[i] - bias)
        _refuse_missed(f"{what}: velocities", i, J @ v, V)
        _refuse_missed(f"{what}: accelerations", i, J @ a + bias, A)
        motion.append((q, v, a))
    qs, vs, accs = zip(*motion, strict=True)
    return np.array(qs), np.array(vs), np.array(accs)


def _refuse_missed(what: str, sample: int, found: Array, wanted: Array) -> None:
    """Refuse rates (n, rows) that no motion of the joints has at a sample; linear and angular ones are held apart.

    Raises:
        AssemblyError: They are missed by more than numeric differentiation errs.
    """
    for part in (slice(0, 3), slice(3, 6)):
        missed = float(np.abs(found[part] - wanted[sample, part]).max(initial=0.0))
        largest = float(np.abs(wanted[:, part]).max(initial=0.0))
        if missed > _MISSED * max(largest, _SLOW):
            units = "of linear ones" if part.start == 0 else "of angular ones"
            raise AssemblyError(
                f"{what} can't be followed",
                f"missed by {missed:.3g} at sample {sample}, {units} that reach {largest:.3g}",
                "the joints can move the frame as it is to move, and rates belong to the positions",
                "mend the rates, leave rotations out, or keep away from singular postures",
            )


def check_starts(starts: int) -> None:
    """Refuse a number of starts that would take hours, or is none.

    Raises:
        SymofrosError: It is.
    """
    if not 1 <= starts <= _MAX_STARTS:
        raise SymofrosError(
            "inverse kinematics: starts is out of range",
            str(starts) if abs(starts) < 10 * _MAX_STARTS else "a number far outside of it",
            f"the guess is the first start, and {_MAX_STARTS} are the most",
            "leave it out, or give 1 for the guess alone",
        )


def _configuration(model: Model, name: str, values: ArrayLike) -> Array:
    """A configuration (nq) on the manifold."""
    if type(values) is np.ndarray and values.dtype == np.float64 and values.shape == (model.nq,):
        if not model.record.quaternions and math.isfinite(float(values @ values)):
            return values
    remedy = f"give one number for each of {', '.join(model.names.q[:8])}" + (", …" if model.nq > 8 else "")
    q = finite_array(f"inverse kinematics: {name}", model.by_name("q", values), (model.nq,), remedy)
    return at_unit_length(model.record, "q", q, name)


def _refuse_nan(task: Task, error: Array) -> None:
    if np.all(np.isfinite(error)):
        return
    raise SymofrosError(
        f"model '{task.model.record.name}': the error of the targets is not a number",
        f"{error[~np.isfinite(error)][0]} at the guess",
        "poses and constraints are finite at the guess",
        "check the inputs and parameters that are passed, or start from another guess",
    )
