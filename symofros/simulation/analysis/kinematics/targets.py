"""Targets of frames, checked, with their errors and how speeds change them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.base.arguments import CheckedCalls
from symofros.base.arrays import Array, real_array, vector
from symofros.base.measures import ANGLE, LENGTH, Measures
from symofros.errors import ShapeError, SymofrosError
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.kinematics.posture_solver import POSE, PostureSolver, Wish, settled, solver_of
from symofros.simulation.analysis.states import given_inputs

# Deviation of a target's matrix from a rotation, max |R R^T - 1|, up to which the nearest rotation stands for it.
# Entries in single precision (6e-8) or typed with seven digits pass, as they do in descriptions; what is farther off is
# no rotation written with few digits. A deviation d leaves the nearest rotation uncertain by d/2: below any tolerance
# on how near to the target a frame comes that such digits can mean.
ROTATION_TOLERANCE = 1e-6
# Largest residual of a constraint [m, rad] that counts as closed, and the default tolerance of targets.
CLOSED_TO = 1e-10


@dataclass(frozen=True)
class Target(metaclass=CheckedCalls):
    """Where a frame is wanted.

    Attributes:
        position: p_WF (3,) [m]; None if it does not matter. Of a batch (n, 3), or one for all.
        rotation: R_WF (3, 3); None if it does not matter. Of a batch (n, 3, 3), or one for all. Rounded to seven
            digits, it stands for the nearest rotation.
    """

    position: npt.ArrayLike | None = None
    rotation: npt.ArrayLike | None = None


class Task:
    """Errors of targets and constraints, and how speeds change them: evaluated by C, in the thread that makes it.

    Args:
        model: Model, in double precision.
        targets: Frame -> where it is wanted.
        u: Inputs, for prescribed motions.
        par: Run-time parameters.

    Raises:
        ShapeError: A position or a rotation has the wrong shape, or is not of finite numbers.
        SymofrosError: A matrix is not a rotation, or a target is not one.
        UnknownNameError: There is no such frame.
    """

    def __init__(self, model: Model, targets: Mapping[str, Target], u: ArrayLike | None, par: ArrayLike | None) -> None:
        self.model = model
        self.inputs: dict[str, Any] = {"u": u, "par": par}
        self._wishes = wishes_of(targets)
        self.poses = poses_of(targets, self._wishes, None)[0]
        self._u, self._par = task_inputs(model, u, par)
        self._solver = solver_of(model, self._wishes, self._par)
        self.coordinates = self._solver.conditions

    @property
    def solver(self) -> PostureSolver:
        """The searches of this task, in C."""
        solver = self._solver
        if solver.loaded is not self:
            solver.loaded = self
            solver.set_parameters(self._par)
            solver.u[...] = self._u
            solver.wanted[...] = self.poses
        return solver

    @property
    def measures(self) -> Measures:
        """Measures of the rows and columns of `jacobian`."""
        group: list[int] = []
        unit: list[int] = []
        for wish in self._wishes:
            for wanted, of in ((wish.position, LENGTH), (wish.rotation, ANGLE)):
                if wanted:
                    group += [len(group)] * 3
                    unit += [of] * 3
        of_constraints = self.model.record.measures.of_rows(self.coordinates)
        group += [len(unit) + first for first in of_constraints.group]
        return Measures(tuple(group), (*unit, *of_constraints.unit), of_constraints.speed)

    @property
    def conditions(self) -> Task:
        """The constraints alone, without targets."""
        return Task(self.model, {}, **self.inputs)

    @property
    def wishes(self) -> int:
        """Number of rows of the targets, which come before those of the constraints."""
        return self._solver.wishes

    def bounds(self, tolerance: float) -> Array:
        """Largest entries of the error that count as met: constraints are closed however coarse the targets may be."""
        of_constraints = np.full(len(self.coordinates), min(tolerance, CLOSED_TO))
        return np.concatenate([np.full(self.wishes, tolerance), of_constraints])

    def error(self, q: Array) -> Array:
        """Errors (m), targets minus poses: positions [m], rotation vectors [rad] in world axes; -phi of constraints."""
        return self.solver.residual(q)[0]

    def jacobian(self, q: Array) -> Array:
        """How speeds (nv) take of the error (m, nv): docs/theory/constraints.md, (18c)."""
        return self.solver.residual(q, jacobian=True)[1]


def finite_array(what: str, values: npt.ArrayLike, shape: tuple[int | str, ...], remedy: str) -> Array:
    """The values as an array of finite numbers.

    Args:
        what: Name of the values in messages.
        values: Values.
        shape: Shape; a name stands for any number.
        remedy: Change to make where they do not fit.

    Raises:
        ShapeError: They are not such an array.
    """
    array = real_array(values)
    fits = (
        array is not None
        and array.ndim == len(shape)
        and all(isinstance(n, str) or n == size for n, size in zip(shape, array.shape, strict=True))
    )
    if array is not None and fits and np.all(np.isfinite(array)):
        return np.array(array)
    if array is None:
        seen = f"{type(values).__name__} {values!r:.60}"
    else:
        seen = f"{array[~np.isfinite(array)][0]} among its numbers" if fits else f"shape {array.shape}"
    size = f"({', '.join(map(str, shape))}{',' if len(shape) == 1 else ''})"
    raise ShapeError(f"{what} does not fit", seen, f"finite real numbers of shape {size}", remedy)


def rotations_checked(what: str, R: Array) -> Array:
    """The rotations nearest to matrices (..., 3, 3) that are rotations but for rounding.

    Raises:
        SymofrosError: One of them is none, or a reflection.
    """
    U, s, Vt = np.linalg.svd(R)
    # The singular values are those of R: max |s^2 - 1| bounds every entry of R R^T - 1.
    with np.errstate(over="ignore", invalid="ignore"):
        error, determinant = np.abs(s**2 - 1.0).max(axis=-1), np.linalg.det(R)
    bad = np.flatnonzero((error > ROTATION_TOLERANCE) | (determinant < 0.0))
    if bad.size:
        at = f" of sample {bad[0]}" if R.ndim > 2 else ""
        error, determinant = np.ravel(error)[bad[0]], np.ravel(determinant)[bad[0]]
        raise SymofrosError(
            f"{what}: the matrix{at} is not a rotation",
            f"|R R^T - 1| = {error:.2g}, determinant {determinant:.3g}",
            f"R R^T = 1 within {ROTATION_TOLERANCE:g} and determinant +1",
            "give columns of unit length that form a right-handed frame, to seven digits or more",
        )
    return np.asarray(U @ Vt)


def task_inputs(model: Model, u: ArrayLike | None, par: ArrayLike | None) -> tuple[Array | tuple[float, ...], Array]:
    """Inputs (nu) and run-time parameters (npar) that a task is evaluated with; the defaults where none are given."""
    return (
        model.record.u_default if u is None else vector("u", given_inputs(model, u), model.nu),
        model.parameter_values if par is None else vector("par", model.checked_parameters(par), model.npar),
    )


def wishes_of(targets: Mapping[str, Target]) -> tuple[Wish, ...]:
    """Targets of each frame.

    Raises:
        SymofrosError: Nothing is.
    """
    wishes = []
    for frame, target in targets.items():
        if not isinstance(target, Target) or (target.position is None and target.rotation is None):
            raise SymofrosError(
                f"target of frame '{frame}': says nothing of where the frame is wanted",
                f"{target!r:.80}",
                "a target is a Target with a position, a rotation or both",
                "write Target(position), Target(rotation=R) or Target(position, R)",
            )
        wishes.append(Wish(frame, target.position is not None, target.rotation is not None))
    return tuple(wishes)


def poses_of(targets: Mapping[str, Target], wishes: Sequence[Wish], n: int | None) -> Array:
    """Wanted poses (n, targets, 12): p_WF, R_WF row by row; what is not wanted is 0 and 1.

    Args:
        targets: Frame -> where it is wanted.
        wishes: What is wanted of each.
        n: Number of poses of each frame, some of one for all; None: one each.

    Raises:
        ShapeError: A position or a rotation has the wrong shape, or is not of finite numbers.
        SymofrosError: A matrix is not a rotation.
    """
    poses = np.zeros((1 if n is None else n, len(wishes), POSE))
    poses[:, :, 3::4] = 1.0
    for k, (frame, target) in enumerate(targets.items()):
        if target.position is not None:
            remedy = "give x, y and z in world axes, in metres; planar targets too"
            poses[:, k, :3] = _numbers(f"target of frame '{frame}': position", target.position, (3,), n, remedy)
        if target.rotation is not None:
            remedy = "give the matrix R_WF; sf.Rotation forms and quaternions are converted before"
            R = _numbers(f"target of frame '{frame}': rotation", target.rotation, (3, 3), n, remedy)
            poses[:, k, 3:] = R.reshape(*R.shape[:-2], 9)

    def looked_at(i: int) -> Array:
        at = "" if n is None else f" {i // len(wishes)}"
        return rotations_checked(
            f"target{at} of frame '{wishes[i % len(wishes)].frame}'", _rows(poses)[i, 3:].reshape(3, 3)
        )

    if wishes:
        settled(_rows(poses), ROTATION_TOLERANCE, looked_at)
    return poses


def _rows(poses: Array) -> Array:
    return poses.reshape(-1, POSE)


def _numbers(what: str, values: npt.ArrayLike, shape: tuple[int, ...], n: int | None, remedy: str) -> Array:
    """Finite numbers of that shape; with n, or of n times that shape."""
    if type(values) is np.ndarray and values.dtype == np.float64 and values.shape == shape:
        flat = values.reshape(-1)
        if math.isfinite(float(flat @ flat)):
            return values
    if n is None or np.ndim(values) == len(shape):
        return finite_array(what, values, shape, remedy)
    return finite_array(what, values, (n, *shape), remedy)
