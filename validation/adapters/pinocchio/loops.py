"""Pinocchio's own constrained dynamics: rigid constraints between frames, solved by its proximal method.

A closure of ours is made of Pinocchio's constraints of a point (3D) and of a frame (6D), which hold at closed postures
alone: their rates and ours differ by what a gap adds. Baumgarte's terms are zero.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

import symofros as sf

from ...contract.interface import States, Subject, Unsupported
from ...mechanics.assembly import BASE, Assembly, anchor_name
from ...mechanics.geometry import Array
from ..charted import ChartedEngine
from ..closed import AXES
from . import tree as trees

NAME = "pinocchio-loops"
CAPABILITIES = frozenset({"forward_dynamics", "multipliers", "constraint_force", "closure_gap", "frame_response"})
# Conditions that repeat each other make G M^-1 G^T singular. A proximal method solves it with mu added on the diagonal,
# again and again, and reaches the solution itself; a mu of zero gives NaN. Redundant parts never settle to ACCURACY, so
# that MOST iterations are done: each costs a solve of the factored matrix.
MU, ACCURACY, MOST = 1e-8, 1e-13, 200
# A direction that a closure leaves free may be blocked if the tree has no way to move in it: a Jacobian of rounding.
_FLAT, _TRIALS = 1e-10, 3


class Tie(NamedTuple):
    """One constraint of Pinocchio's, in the place of (a part of) a closure of ours.

    Attributes:
        model: Pinocchio's.
        closure: Index of the closure.
        offset: Offset of its point from the origin of the first frame, along that frame's axes (3,).
    """

    model: Any
    closure: int
    offset: Array


@dataclass(frozen=True)
class LoopEngine:
    """A `pinocchio.Model` with rigid constraints.

    Attributes:
        tree: Pinocchio's model without constraints.
        closures: Closures of the description.
        ties: Pinocchio's, in order.
    """

    tree: ChartedEngine
    closures: tuple[sf.Closure, ...]
    ties: tuple[Tie, ...]
    name: str = NAME
    version: str = pin.__version__
    capabilities: frozenset[str] = CAPABILITIES

    def ties_as_numbers(self) -> list[str]:
        """Its constraints for programs in C++: 3 or 6, then twice joint, R row by row and p of the place on it."""
        lines = []
        for tie in self.ties:
            m = tie.model
            ends = (m.joint1_id, m.joint1_placement), (m.joint2_id, m.joint2_placement)
            size = "6" if m.type == pin.ContactType.CONTACT_6D else "3"
            numbers = [
                [str(joint), *(repr(float(x)) for x in (*X.rotation.ravel(), *X.translation))] for joint, X in ends
            ]
            lines.append(" ".join([size, *numbers[0], *numbers[1]]))
        return lines

    def forward_dynamics(self, states: States) -> Array:
        """Accelerations v' by `constraintDynamics`."""
        a = self._each(states, lambda solved: solved.a)
        return self.tree.chart.our_accelerations(states.q, states.v, a)

    def multipliers(self, states: States) -> Array:
        """Components of the wrenches between the frames, along the blocked directions."""
        return self._each(states, self._wrenches)

    def constraint_force(self, states: States) -> Array:
        """J^T of its forces, with its own Jacobian; of both, the signs are opposite to ours."""
        forces = self._each(states, lambda solved: solved.jacobian.T @ solved.forces)
        return self.tree.chart.our_forces(states.q, forces)

    def closure_gap(self, states: States) -> Array:
        """The largest distance between points that are to coincide, and angle between axes that are to be parallel."""
        return self._each(states, self._gap)

    def frame_response(self, states: States) -> Array:
        """Accelerations of frames, from forward kinematics."""
        return self.tree.frame_acceleration(replace(states, a=self.forward_dynamics(states)))

    def derivatives(self, states: States) -> tuple[Array, Array, Array]:
        """Derivatives of v' by q, v and the forces, on the constraints (N, nv, nv) each."""

        def result(solved: _Solved) -> Any:
            derivatives = pin.computeConstraintDynamicsDerivatives(
                self.tree.model, solved.data, solved.models, solved.datas, solved.settings
            )
            return [np.array(part) for part in derivatives[:3]]

        parts = self._each(states, result)
        return parts[:, 0], parts[:, 1], parts[:, 2]

    def _each(self, states: States, result: Callable[[_Solved], Any]) -> Array:
        chart = self.tree.chart
        q, v, f = chart.coordinates(states.q), chart.speeds(states.q, states.v), chart.forces(states.q, states.applied)
        solver = _Solver(self.tree.model, [tie.model for tie in self.ties])
        return np.array([np.array(result(solver.at(*state))) for state in zip(q, v, f, strict=True)])

    def _wrenches(self, solved: _Solved) -> Array:
        force, torque = np.zeros((len(self.closures), 3)), np.zeros((len(self.closures), 3))
        for tie, data in zip(self.ties, solved.datas, strict=True):
            wrench = -np.array(data.contact_force.vector)
            force[tie.closure] += wrench[:3]
            torque[tie.closure] += wrench[3:] + np.cross(tie.offset, wrench[:3])
        rows: list[float] = []
        for i, closure in enumerate(self.closures):
            rows += [force[i, AXES.index(axis)] for axis in closure.translations]
            rows += [torque[i, AXES.index(axis)] for axis in closure.rotations]
        return np.array(rows)

    def _gap(self, solved: _Solved) -> float:
        gaps = [0.0]
        for tie, data in zip(self.ties, solved.datas, strict=True):
            blocked = self.closures[tie.closure].translations
            gaps += [abs(data.c1Mc2.translation[AXES.index(axis)]) for axis in blocked]
            if tie.model.type == pin.ContactType.CONTACT_6D:
                gaps.append(float(np.linalg.norm(pin.log3(data.c1Mc2.rotation))))
        return max(gaps)


class _Solved(NamedTuple):
    """One state after `constraintDynamics`; forces (m,) go with its Jacobian (m, nv)."""

    a: Array
    forces: Array
    jacobian: Array
    data: Any
    models: Any
    datas: Any
    settings: Any


class _Solver:
    def __init__(self, model: Any, ties: Sequence[Any]) -> None:
        self.model, self.data = model, model.createData()
        self.models, self.datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
        for tie in ties:
            self.models.append(tie)
            self.datas.append(tie.createData())
        pin.initConstraintDynamics(model, self.data, self.models, self.datas)

    def at(self, q: Array, v: Array, f: Array) -> _Solved:
        settings = pin.ProximalSettings(ACCURACY, MU, MOST)
        a = pin.constraintDynamics(self.model, self.data, q, v, f, self.models, self.datas, settings)
        # Copies: the binding hands out views of what the next state overwrites.
        a, forces = np.array(a), np.array(self.data.lambda_c)
        J = np.array(pin.getConstraintsJacobian(self.model, self.data, self.models, self.datas))
        return _Solved(a, forces, J.reshape(-1, self.model.nv), self.data, self.models, self.datas, settings)


def build(subject: Subject) -> LoopEngine | Unsupported:
    """Pinocchio's model of a description with closures."""
    tree = trees.build(subject)
    if isinstance(tree, Unsupported):
        return tree
    model, assembly = tree.model, subject.assembly
    closures, ties = [], []
    for i, item in enumerate(subject.system.constraints):
        if not isinstance(item, sf.Closure):
            return Unsupported(
                f"'{item.name}': Pinocchio's constraints join frames or points; no {type(item).__name__}"
            )
        offsets = _points(item)
        if not offsets:
            return Unsupported(f"closure '{item.name}': neither a point, a hinge nor a weld")
        closures.append(item)
        ends = [_site(assembly, anchor) for anchor in (item.first, item.second)]
        made = [Tie(_rigid(model, item, ends, offset), i, offset) for offset in offsets]
        if any(not _only_blocks(model, tie, item) for tie in made):
            return Unsupported(f"closure '{item.name}': it leaves a direction free in which the bodies do move")
        ties += made
    return LoopEngine(tree, tuple(closures), tuple(ties))


def _points(item: sf.Closure) -> list[Array]:
    """Where along the first frame's axes points are to coincide: one of a ball or a weld, two of a hinge."""
    here = np.zeros(3)
    if len(item.rotations) == 2 and len(item.translations) == 3:
        return [here, np.eye(3)[next(k for k in range(3) if AXES[k] not in item.rotations)]]
    whole = not item.rotations or (len(item.rotations) == 3 and len(item.translations) == 3)
    return [here] if whole and item.translations else []


def _site(assembly: Assembly, anchor: tuple[str, str | None]) -> tuple[int, Any]:
    """Pinocchio's joint that carries an anchor, and the anchor's place on it."""
    name = anchor_name(assembly, anchor)
    if not name:
        return 0, pin.SE3.Identity()
    frame = assembly.frames[name]
    return frame.mover - BASE, pin.SE3(frame.X_BF.R, frame.X_BF.p)


def _rigid(model: Any, item: sf.Closure, ends: list[tuple[int, Any]], offset: Array) -> Any:
    kind = pin.ContactType.CONTACT_6D if len(item.rotations) == 3 else pin.ContactType.CONTACT_3D
    shift = pin.SE3(np.eye(3), offset)
    (first, X1), (second, X2) = ends
    return pin.RigidConstraintModel(kind, model, first, X1 * shift, second, X2 * shift, pin.ReferenceFrame.LOCAL)


def _only_blocks(model: Any, tie: Tie, item: sf.Closure) -> bool:
    """Whether what it blocks beyond the closure does not move anyway, as across the plane of a planar mechanism."""
    free = [k for k in range(3) if AXES[k] not in item.translations]
    solver, rng = _Solver(model, [tie.model]), np.random.default_rng(0)
    still = np.zeros(model.nv)
    for _ in range(_TRIALS if free else 0):
        q = pin.integrate(model, pin.neutral(model), rng.uniform(-1, 1, model.nv))
        pin.computeAllTerms(model, solver.data, q, still)
        J = np.array(pin.getConstraintsJacobian(model, solver.data, solver.models, solver.datas))
        if np.abs(J.reshape(-1, model.nv)[free]).max() > _FLAT:
            return False
    return True
