"""Searches by native/stepping/posture/posture.c on a model's functions: docs/theory/constraints.md, section 9."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.errors import CompileError
from symofros.runtime.calls import CompiledKernel, InterpretedFunction, Kernel, NativeMemory, constants, native_library
from symofros.runtime.model import Model

_SIZES = constants()
# Starts of one round, of whose solutions the nearest to the guess counts; ends of drawn starts that are kept.
ROUND, KEPT, POSE = (_SIZES[f"SYM_POSTURE_{name}"] for name in ("ROUND", "KEPT", "POSE"))
# Solvers of one model that a thread keeps.
_MOST_KEPT = 16


class Wish(NamedTuple):
    """A frame that is wanted somewhere.

    Attributes:
        frame: Its name.
        position: Whether its position is.
        rotation: Whether its rotation is.
    """

    frame: str
    position: bool
    rotation: bool


class PostureSolver:
    """A sym_posture: the residual of some wishes and of the constraints, and searches for where it vanishes.

    It keeps what it was loaded with last: for one thread.

    Args:
        model: Model, in double precision.
        wishes: Frames that are wanted somewhere.
        par: Run-time parameters (npar).

    Attributes:
        everything: Indices of all speeds (nv).
        elastic: Whether the model has elastic beams.
        facing: Whether a closure may be closed the wrong way round.
        posture: The sym_posture.
        q: Configuration (carried.nq) of the search: its start, then its end.
        wanted: Wanted poses (n, 12): p_WF, R_WF row by row.
        free: Whether each speed (nv) may be used.
        conditions: Rows of phi that bind coordinates.
        loaded: What the caller has loaded last.
    """

    def __init__(self, model: Model, wishes: Sequence[Wish], par: Array) -> None:
        self.native, self.memory = native_library(), NativeMemory()
        self.ffi = self.memory.ffi
        self.loaded: object = None
        self.interpreted: list[InterpretedFunction] = []
        self._pre: list[tuple[Kernel, Any, InterpretedFunction | None]] = []
        self.par, self._given_par = par.copy(), par
        self.posture = self.ffi.new("sym_posture *")
        # The model itself is not kept: it keeps its solvers.
        carried, self.nq, self.nv = model.carried, model.nq, model.nv
        self._carried_nq, self._carried_nv = carried.nq, carried.nv
        self.everything = np.arange(model.nv)
        self.elastic = bool(model.beams(par))
        self.facing = any(closure.parallel for closure in model.record.closures)
        self._fill_system(carried)
        self._fill_tables(carried)
        self._fill_functions(carried, wishes)
        self.posture.q, self.q = self._array(carried.nq)
        self.posture.wanted, wanted = self._array(POSE * len(wishes))
        self.wanted = wanted.reshape(-1, POSE)
        self.native.sym_posture_start(self.posture, self.memory.zeros(self.native.sym_posture_size(self.posture)))
        self.rows, self.wishes = int(self.posture.m), int(self.posture.wishes)
        self._draws = 0
        turning = (segment for segment in carried.record.segments if segment.kind != "linear")
        self._turning = tuple(segment.v + segment.translations for segment in turning)
        self.kept = self.memory.view(self.posture.kept, KEPT * carried.nq).reshape(KEPT, -1)
        self.round = self.memory.view(self.posture.round, ROUND * carried.nq).reshape(ROUND, -1)
        self.round_met = self.memory.view(self.posture.round_met, ROUND)

    def _array(self, size: int) -> tuple[Any, Array]:
        pointer = self.memory.zeros(size)
        return pointer, self.memory.view(pointer, size)

    def _fill_system(self, model: Model) -> None:
        """Sizes, segments, and the evaluation point."""
        memory = self.memory
        system = self.system = self.ffi.new("sym_system *")
        memory.keep(system)
        system.nq, system.nv, system.nu, system.nc = model.nq, model.nv, model.nu, model.nc
        segments = [(_SIZES[s.constant], s.q, s.v, s.size) for s in model.record.segments]
        system.n_segments, system.segments = len(segments), memory.own("sym_segment[]", segments)
        system.q, system.v, system.t = (memory.zeros(size) for size in (model.nq, model.nv, 1))
        system.u, self.u = self._array(model.nu)
        self.posture.system = system

    def _fill_tables(self, model: Model) -> None:
        """Limits, kinds of coordinates and speeds, rows of the constraints."""
        posture, memory, record = self.posture, self.memory, model.record
        posture.free, self.free = self._integers(model.nv)
        posture.kind, kinds = self._integers(model.nv)
        posture.periodic, periodic = self._integers(model.nq)
        kinds[:], periodic[:] = record.measures.speed, record.periodic
        posture.lower, posture.upper = memory.doubles(record.q_lower), memory.doubles(record.q_upper)
        names = model.names.constraints
        self.conditions = [i for i, name in enumerate(names) if name not in record.speed_conditions]
        posture.n_conditions, posture.conditions = len(self.conditions), memory.own("int32_t[]", self.conditions)

    def _integers(self, size: int) -> tuple[Any, Any]:
        array = np.zeros(max(1, size), dtype=np.int32)
        return self.memory.shared(array), array[:size]

    def _fill_functions(self, model: Model, wishes: Sequence[Wish]) -> None:
        """The functions of the frames and of the constraints, at the evaluation point."""
        posture = self.posture
        posture.n_targets, posture.targets = len(wishes), self.memory.own("sym_target[]", len(wishes))
        for i, wish in enumerate(wishes):
            target = posture.targets[i]
            target.position, target.rotation = wish.position, wish.rotation
            self._bind(target.pose, model.kernel("frame_pose", wish.frame))
            self._bind(target.jacobian, model.kernel("frame_jacobian", wish.frame))
        if self.conditions:
            self._bind(posture.constraint, model.kernel("constraint"))
            self._bind(self.system.constraint_jacobian, model.kernel("constraint_jacobian"))

    def _bind(self, call: Any, kernel: Kernel) -> None:
        made = None
        if isinstance(kernel, CompiledKernel):
            self.memory.bind(call, kernel, self.par)
        else:
            made = self.memory.bind_interpreted(call, kernel, self.par)
            self.interpreted.append(made)
        if not self.native.sym_system_bind(self.system, self.ffi.addressof(call)):
            raise CompileError(f"inverse kinematics does not know every input of '{kernel.signature.name}'")
        self._pre.append((kernel, call.pre, made))

    def set_parameters(self, par: Array) -> None:
        """Run-time parameters (npar) from here on."""
        if par is self._given_par and not par.flags.writeable or np.array_equal(par, self.par):
            return
        self.par[...] = par
        self._given_par = par
        for kernel, pointer, made in self._pre:
            pre = kernel.prepare(par.reshape(1, -1)) if made is None else made.prepare(par)
            self.memory.view(pointer, pre.size)[...] = pre.reshape(-1)

    def done(self, result: Any) -> Any:
        """What C returns, where no interpreted function has failed; what it raised is raised here."""
        for function in self.interpreted:
            if function.failure is not None:
                failure, function.failure = function.failure, None
                raise failure
        return result

    def residual(self, q: Array, jacobian: bool = False) -> tuple[Array, Array]:
        """What is missing (m) at a configuration (nq), and, if wanted, how speeds take of it (m, nv)."""
        e, J = np.zeros(max(1, self.rows)), np.zeros((max(1, self.rows), self._carried_nv))
        at = self.joined(q)
        to = self._read(J) if jacobian and J.size else self.ffi.NULL
        self.done(self.native.sym_posture_residual(self.posture, self._read(at), self._read(e), to))
        return e[: self.rows], J[: self.rows, : self.nv]

    def joined(self, q: Array) -> Array:
        """A configuration (nq) with the idle coordinates of forces' states (carried.nq)."""
        joined = np.zeros(self._carried_nq)
        joined[: self.nq] = q
        return joined

    def use(self, free: npt.NDArray[np.intp], tolerance: float, closed: float) -> None:
        """What the searches that follow may move, and by how much targets and constraints may be missed."""
        self.free[:] = 0
        self.free[free] = 1
        self.posture.tolerance, self.posture.closed = tolerance, closed

    def descend(self, q: Array, steps: int) -> Array:
        """Damped least squares from a configuration (nq), at most so many steps; the end (nq)."""
        self.q[: self.nq] = q
        self.posture.steps = 0
        self.done(self.native.sym_posture_descend(self.posture, steps))
        return self.end()

    def search(self, batch: Any, first: int, end: int) -> None:
        """Searches `first` to `end` of a sym_posture_batch."""
        self.native.sym_posture_batch_run(self.posture, batch, first, end)

    def within(self, q: Array) -> Array:
        """A configuration (nq), free coordinates moved to their limits where they are beyond them (carried.nq)."""
        at = self.joined(q)
        self.native.sym_posture_limit(self.posture, self._read(at))
        return at

    def windows(self, guess: Array) -> bool:
        """Begin further starts about a guess (carried.nq) within the limits; whether any speed is of use."""
        self.posture.steps = self.posture.starts = 0
        return bool(self.done(self.native.sym_posture_windows(self.posture, self._read(guess))))

    def used(self) -> npt.NDArray[np.intp]:
        """The speeds of use, after `windows`."""
        return np.flatnonzero(self.memory.view(self.posture.depends, self.nv))

    def again(self, guess: Array, near: Array, first: int, end: int, steps: int) -> bool:
        """Rounds of starts, from number `first` to `end`, until one has a solution; q is the one nearest to `near`."""
        numbers = self._read(guess), self._read(near), first, end, steps
        return bool(self.done(self.native.sym_posture_again(self.posture, *numbers)))

    def follow_round(self, guess: Array, first: int, n: int, steps: int) -> None:
        """A round of n starts: `round` are their ends, `round_met` says which are solutions."""
        self.done(self.native.sym_posture_round(self.posture, self._read(guess), first, n, steps))

    def nearest(self, guess: Array, near: Array, n: int) -> bool:
        """Take the solution of that round that is nearest to `near`; whether there is one."""
        numbers = self._read(guess), self._read(near), n
        return bool(self.done(self.native.sym_posture_nearest(self.posture, *numbers)))

    def _read(self, array: Array) -> Any:
        return self.ffi.from_buffer("double[]", array)

    def end(self) -> Array:
        """The configuration (nq) that the search is at."""
        return np.array(self.q[: self.nq])

    def reserve_starts(self, count: int) -> None:
        """Draws of so many starts and more, for the search."""
        if count <= self._draws:
            return
        table = drawn(self._carried_nv, self._turning, 1 << max(7, (count - 1).bit_length()))
        self.posture.draws, self.posture.n_draws = self.memory.shared(table), len(table)
        self._draws = len(table)


@cache
def drawn(nv: int, turning: tuple[int, ...], count: int) -> Array:
    """Draws of starts (count, nv): shares of windows from 0 to 1; of whole rotations, rotation vectors.

    The same for every search; more of them begin with the same ones.

    Args:
        nv: Number of speeds.
        turning: First of the three speeds of each whole rotation.
        count: Number of starts.
    """
    table = np.random.default_rng(0).random((count, nv))
    for k, first in enumerate(turning):
        random = np.random.default_rng(1 + k)
        normal = random.standard_normal((count, 4))
        axes = normal[:, :3] / np.linalg.norm(normal[:, :3], axis=1, keepdims=True)
        table[:, first : first + 3] = axes * np.pi * table[:, first : first + 1]
    return table


def settled(poses: Array, most: float, refused: Callable[[int], Array]) -> Array:
    """Wanted poses (n, 12) in place, their matrices the rotations nearest to them.

    Args:
        poses: p_WF, R_WF row by row.
        most: Frobenius norm of R^T R - 1 beyond which a matrix is looked at by `refused`.
        refused: Gives the nearest rotation (3, 3) of the pose of a number, or raises.
    """
    at, n, native, memory = 0, len(poses), native_library(), NativeMemory()
    rows = memory.shared(poses)
    while (at := native.sym_posture_poses(at, n, most, rows)) < n:
        poses[at, 3:] = refused(at).reshape(-1)
        at += 1
    return poses


class _Solvers(threading.local):
    """The solvers that a thread has bound, by model and by what is wanted."""

    def __init__(self) -> None:
        self.bound: WeakKeyDictionary[Model, dict[tuple[Wish, ...], PostureSolver]] = WeakKeyDictionary()


_SOLVERS = _Solvers()


def solver_of(model: Model, wishes: tuple[Wish, ...], par: Array) -> PostureSolver:
    """The solver of this thread, bound at the first time.

    Args:
        model: Model, in double precision.
        wishes: Frames that are wanted somewhere.
        par: Run-time parameters (npar).
    """
    bound = _SOLVERS.bound.setdefault(model, {})
    solver = bound.get(wishes)
    if solver is None:
        if len(bound) >= _MOST_KEPT:
            del bound[next(iter(bound))]
        solver = bound[wishes] = PostureSolver(model, wishes, par)
    else:
        solver.set_parameters(par)
    return solver
