"""Inverse kinematics of many poses, shared among threads."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symofros.base.arguments import checked
from symofros.base.arrays import Array, real_array
from symofros.errors import ShapeError
from symofros.runtime.beams import BEAM_LIMIT, BeamBending
from symofros.runtime.calls import NativeMemory, together
from symofros.runtime.manifold import at_unit_length
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.kinematics.assembly import free_speeds
from symofros.simulation.analysis.kinematics.inverse_kinematics import Reached, check_starts, inverse_kinematics
from symofros.simulation.analysis.kinematics.posture_search import DRAWN_STEPS, STARTS
from symofros.simulation.analysis.kinematics.posture_solver import PostureSolver, Wish, solver_of
from symofros.simulation.analysis.kinematics.restarts import default_start
from symofros.simulation.analysis.kinematics.targets import (
    CLOSED_TO,
    Target,
    finite_array,
    poses_of,
    task_inputs,
    wishes_of,
)
from symofros.simulation.analysis.states import check_search

# Poses of one call of C, between looks at Ctrl-C: some hundredths of a second.
_AT_ONCE = 256


@dataclass(frozen=True)
class ReachedBatch:
    """The configurations nearest to what was wanted; entry i is that of pose i.

    Attributes:
        q: Configurations (n, nq).
        error: Largest remaining error of targets (n): of position [m] and rotation [rad].
        converged: Whether the targets are reached (n), as of `Reached`.
        iterations: Steps taken (n).
        distance: Distance from rest (n); 0 without rest.
        gradient: Norm of the distance's gradient along the solutions, times the distance (n); 0 without rest.
        bendings: Bending of each beam (n).
        notes: Remarks (n).
        gap: Largest residual of the constraints (n) [m, rad].
        starts: Number of starts that were followed (n).
    """

    q: Array
    error: Array
    converged: npt.NDArray[np.bool_]
    iterations: npt.NDArray[np.int64]
    distance: Array
    gradient: Array
    bendings: tuple[tuple[BeamBending, ...], ...]
    notes: tuple[tuple[str, ...], ...]
    gap: Array
    starts: npt.NDArray[np.int64]


@checked
def inverse_kinematics_batch(
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
    threads: int | None = None,
) -> ReachedBatch:
    """`inverse_kinematics` of n poses: the same results to the last bit, shared among threads.

    The number of threads changes no result. Poses that are not reached, and all poses of interpreted models, of models
    with beams or with closures of rotations, or with a posture of rest, are looked at one after the other.

    Args:
        model: Model, whose joint limits are kept.
        targets: Frame -> where it is wanted: positions (n, 3), rotations (n, 3, 3), or one of them for all poses.
        q: Guesses (n, nq), or one for all (nq); as of `inverse_kinematics` if not given.
        rest: Configuration to stay nearest to with the freedom that is left (nq).
        held: Names of speeds whose coordinates stay.
        u: Inputs, for prescribed motions.
        par: Run-time parameters.
        tolerance: Bound of the targets' largest error; constraints close to 1e-10 however large it is.
        iterations: Most steps from one start.
        beam_limit: As of `inverse_kinematics`.
        starts: Most starts of one pose.
        threads: Number of threads; by default that of the model (`Model.with_threads`).

    Raises:
        UnknownNameError: No such frame or speed.
        ShapeError: A target, the guess or rest does not fit, or is not of finite numbers.
        SymofrosError: A target's matrix is not a rotation, or nothing is asked for; or starts, iterations or tolerance
            is out of range.
    """
    model = model.with_precision("double")
    check_search("inverse kinematics", tolerance, iterations)
    check_starts(starts)
    wishes, n = wishes_of(targets), _count(targets, q)
    poses, guesses = poses_of(targets, wishes, n), _guesses(model, q, n)
    search = Search(model, wishes, *task_inputs(model, u, par))

    def alone(i: int) -> Reached:
        return inverse_kinematics(
            model,
            {wish.frame: _target(wish, pose) for wish, pose in zip(wishes, poses[i], strict=True)},
            None if q is None else guesses[i],
            rest=rest,
            held=held,
            u=u,
            par=par,
            tolerance=tolerance,
            iterations=iterations,
            beam_limit=beam_limit,
            starts=starts,
        )

    found = _Found(guesses)
    solver = search.solver
    if rest is None and not solver.facing and not solver.elastic:
        free = free_speeds(model, held) if held else solver.everything
        batch = _Batch(poses, guesses, iterations, starts, found)
        batch.run(search, free, tolerance, model.threads if threads is None else threads)
    return found.completed(alone)


class Search(NamedTuple):
    """Settings that every thread searches by.

    Attributes:
        model: Model, in double precision.
        wishes: Frames that are wanted somewhere.
        u: Inputs (nu).
        par: Run-time parameters (npar).
    """

    model: Model
    wishes: tuple[Wish, ...]
    u: Array | tuple[float, ...]
    par: Array

    @property
    def solver(self) -> PostureSolver:
        """The solver of this thread."""
        solver = solver_of(self.model, self.wishes, self.par)
        solver.loaded = self
        solver.u[...] = self.u
        return solver


class _Found:
    """Results of C, and what they become.

    Args:
        guesses: Guesses (n, nq).
    """

    def __init__(self, guesses: Array) -> None:
        n, nq = guesses.shape
        self.q, self.error, self.gap = np.zeros((n, nq)), np.zeros(n), np.zeros(n)
        self.met, self.steps, self.starts = np.zeros(n, np.int32), np.zeros(n, np.int64), np.zeros(n, np.int64)

    def completed(self, alone: Callable[[int], Reached]) -> ReachedBatch:
        """The results, those of poses that C did not reach by a search of their own."""
        n = len(self.met)
        batch = ReachedBatch(
            self.q,
            self.error,
            self.met != 0,
            self.steps,
            np.zeros(n),
            np.zeros(n),
            ((),) * n,
            ((),) * n,
            self.gap,
            self.starts,
        )
        left = np.flatnonzero(self.met == 0).tolist()
        if not left:
            return batch
        reached = {i: alone(i) for i in left}
        bendings, notes = list(batch.bendings), list(batch.notes)
        for i, one in reached.items():
            for name in ("q", "error", "converged", "iterations", "distance", "gradient", "gap", "starts"):
                getattr(batch, name)[i] = getattr(one, name)
            bendings[i], notes[i] = one.bendings, one.notes
        return replace(batch, bendings=tuple(bendings), notes=tuple(notes))


class _Batch:
    """A sym_posture_batch.

    Args:
        poses: Wanted poses (n, targets, 12).
        guesses: Guesses (n, nq).
        iterations: Most steps from a guess.
        starts: Most starts.
        found: Where results go.
    """

    def __init__(self, poses: Array, guesses: Array, iterations: int, starts: int, found: _Found) -> None:
        self._memory, self._n, self._starts = NativeMemory(), len(guesses), starts
        self._batch = batch = self._memory.ffi.new("sym_posture_batch *")
        batch.wanted_stride, batch.guess_stride = poses[0].size if len(poses) else 0, guesses.shape[1]
        batch.wanted, batch.guess = (self._memory.shared(np.ascontiguousarray(x)) for x in (poses, guesses))
        batch.most, batch.most_drawn, batch.n_starts = iterations, min(iterations, DRAWN_STEPS), starts
        for name, array in vars(found).items():
            setattr(batch, name, self._memory.shared(array))

    def run(self, search: Search, free: npt.NDArray[np.intp], tolerance: float, threads: int) -> None:
        """Search, poses in turn by so many threads at most; of interpreted models by this one."""
        if search.solver.interpreted:
            threads = 1

        def part(k: int) -> None:
            solver = search.solver
            solver.use(free, tolerance, min(tolerance, CLOSED_TO))
            solver.reserve_starts(self._starts)
            for first in range(k * _AT_ONCE, self._n, threads * _AT_ONCE):
                solver.search(self._batch, first, min(first + _AT_ONCE, self._n))

        together([partial(part, k) for k in range(max(1, min(threads, -(-self._n // _AT_ONCE))))])


def _count(targets: Mapping[str, Target], q: ArrayLike | None) -> int:
    """Number of poses: of the first array that holds several.

    Raises:
        ShapeError: None does.
    """
    for target in targets.values():
        for values, rank in ((target.position, 1), (target.rotation, 2)):
            array = None if values is None else real_array(values)
            if array is not None and array.ndim == rank + 1:
                return len(array)
    guesses = None if q is None or isinstance(q, Mapping) else real_array(q)
    if guesses is not None and guesses.ndim == 2:
        return len(guesses)
    raise ShapeError(
        "inverse kinematics of a batch: no batch",
        "one pose and one guess",
        "positions (n, 3), rotations (n, 3, 3) or guesses (n, nq) say how many poses there are",
        "sf.inverse_kinematics is for one pose",
    )


def _guesses(model: Model, q: ArrayLike | None, n: int) -> Array:
    """Guesses (n, nq) on the manifold; where none are given, those of `inverse_kinematics` without rest."""
    if q is None:
        return np.tile(default_start(model), (n, 1))
    stated = model.by_name("q", q)
    array = real_array(stated)
    shape = (model.nq,) if array is None or array.ndim < 2 else (n, model.nq)
    remedy = "give one row of coordinates a pose, or one for all of them"
    guesses = finite_array("inverse kinematics of a batch: q", stated, shape, remedy)
    return np.array(np.broadcast_to(at_unit_length(model.record, "q", guesses, "q"), (n, model.nq)))


def _target(wish: Wish, pose: Array) -> Target:
    return Target(pose[:3] if wish.position else None, pose[3:].reshape(3, 3) if wish.rotation else None)
