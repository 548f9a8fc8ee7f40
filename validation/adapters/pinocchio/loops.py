"""Pinocchio's own constrained dynamics: rigid constraints between frames, solved by its proximal method.

A closure of ours is made of Pinocchio's constraints of a point (3D) and of a frame (6D), which hold at closed postures
alone: their rates and ours differ by what a gap adds. Baumgarte's terms are zero. The matrix's plug-in states them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

import symofros as sf

from ...contract.interface import States, Subject, Unsupported
from ...engines.interface import Constraint, End, Tree, rows, vector
from ...engines.plugins.pinocchio import WAYS, write
from ...engines.plugins.writing.source import SourceModel, Way
from ...mechanics.assembly import BASE, Assembly, anchor_name
from ...mechanics.geometry import Array
from ..charted import ChartedEngine
from ..closed import AXES
from ..stated import stated
from . import tree as trees

NAME = "pinocchio-loops"
CAPABILITIES = frozenset({"forward_dynamics", "multipliers", "constraint_force", "closure_gap", "frame_response"})
# Conditions that repeat each other make G M^-1 G^T singular. A proximal method solves it with mu added on the diagonal,
# again and again, and reaches the solution itself; a mu of zero gives NaN. Redundant parts never settle to ACCURACY, so
# that MOST iterations are done: each costs a solve of the factored matrix.
MU, ACCURACY, MOST = 1e-8, 1e-13, 200
# A direction that a closure leaves free may be blocked if the tree has no way to move in it: a Jacobian of rounding.
_FLAT, _TRIALS = 1e-10, 3
_SOLVED = f"""cd = pin.StdVec_RigidConstraintData([one.createData() for one in cm])
ps = pin.ProximalSettings({ACCURACY}, {MU}, {MOST})
pin.initConstraintDynamics(m, d, cm, cd)
a = pin.constraintDynamics(m, d, q, v, tau, cm, cd, ps)
"""
_WAYS = WAYS | {
    "forward_dynamics": Way("constraintDynamics", f"{_SOLVED}value = a"),
    # With its own Jacobian.
    "constraint_force": Way(
        "getConstraintsJacobian",
        f"{_SOLVED}f = np.array(d.lambda_c)\n"
        "value = np.reshape(pin.getConstraintsJacobian(m, d, cm, cd), (-1, m.nv)).T @ f",
    ),
    "wrenches": Way("contact_force", f"{_SOLVED}value = [one.contact_force.vector for one in cd]"),
    # Of a point the last is none: only a frame's constraint holds its rotation.
    "gaps": Way(
        "c1Mc2",
        f"{_SOLVED}value = [[*one.c1Mc2.translation, np.linalg.norm(pin.log3(one.c1Mc2.rotation))] for one in cd]",
    ),
}


class Tie(NamedTuple):
    """One of Pinocchio's constraints, which represents a closure or a part of it.

    Attributes:
        closure: Index of the closure that it is a part of.
        offset: Offset of its point from the origin of the first frame, along that frame's axes (3,).
        stated: The constraint.
    """

    closure: int
    offset: Array
    stated: Constraint


@dataclass(frozen=True)
class LoopEngine(ChartedEngine):
    """A `pinocchio.Model` with rigid constraints.

    Attributes:
        closures: Closures of the description.
        ties: Pinocchio's constraints, in order.
    """

    closures: tuple[sf.Closure, ...] = ()
    ties: tuple[Tie, ...] = ()

    def ties_as_numbers(self) -> list[str]:
        """Constraints of a loop for programs in C++: 3 or 6, then twice joint, R row by row and p on it."""
        lines = []
        for m in self.names["cm"]:
            ends = (m.joint1_id, m.joint1_placement), (m.joint2_id, m.joint2_placement)
            numbers = [
                " ".join([str(joint), *(repr(float(x)) for x in (*X.rotation.ravel(), *X.translation))])
                for joint, X in ends
            ]
            lines.append(" ".join(["6" if m.type == pin.ContactType.CONTACT_6D else "3", *numbers]))
        return lines

    def multipliers(self, states: States) -> Array:
        """Components of the closures' wrenches along the blocked directions (N, nc); Pinocchio's signs are reversed."""
        wrenches = -self.asked("wrenches", states)
        force, torque = np.zeros((2, len(states), len(self.closures), 3))
        for k, tie in enumerate(self.ties):
            force[:, tie.closure] += wrenches[:, k, :3]
            torque[:, tie.closure] += wrenches[:, k, 3:] + np.cross(tie.offset, wrenches[:, k, :3])
        columns = []
        for i, closure in enumerate(self.closures):
            columns += [force[:, i, AXES.index(axis)] for axis in closure.translations]
            columns += [torque[:, i, AXES.index(axis)] for axis in closure.rotations]
        return np.stack(columns, axis=1)

    def constraint_force(self, states: States) -> Array:
        """J^T lambda by Pinocchio's Jacobian and forces (N, nv), both of which have signs opposite to ours."""
        return self.chart.our_forces(states.q, self.asked("constraint_force", states))

    def closure_gap(self, states: States) -> Array:
        """Largest distance along blocked translations, or angle between welded frames (N,)."""
        gaps = np.abs(self.asked("gaps", states))
        held = np.zeros(gaps.shape[1:], dtype=bool)
        for row, tie in zip(held, self.ties, strict=True):
            row[[AXES.index(axis) for axis in self.closures[tie.closure].translations]] = True
            row[3] = tie.stated.kind == "weld"
        return np.asarray(np.max(gaps, axis=(1, 2), where=held, initial=0.0))

    def frame_response(self, states: States) -> Array:
        """Accelerations of frames, from forward kinematics."""
        return self.frame_acceleration(replace(states, a=self.forward_dynamics(states)))


def build(subject: Subject) -> LoopEngine | Unsupported:
    """Pinocchio's model of a description with closures."""
    plain = trees.build(subject)
    if isinstance(plain, Unsupported):
        return plain
    tree = stated(subject, whole=False, merged=False).tree
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
        ties += [Tie(i, offset, _rigid(subject.assembly, tree, item, offset)) for offset in offsets]
    source = write(replace(tree, constraints=tuple(tie.stated for tie in ties)))
    if isinstance(source, Unsupported):
        return source
    model = SourceModel(source, _WAYS)
    for tie, one in zip(ties, model.names["cm"], strict=True):
        if not _only_blocks(model.names["m"], one, closures[tie.closure]):
            name = closures[tie.closure].name
            return Unsupported(f"closure '{name}': it leaves a direction free in which the bodies do move")
    given = vars(plain) | {"name": NAME, "answers": model, "capabilities": CAPABILITIES}
    return LoopEngine(**given, closures=tuple(closures), ties=tuple(ties))


def _points(item: sf.Closure) -> list[Array]:
    """Where along the first frame's axes points are to coincide: one of a ball or a weld, two of a hinge."""
    here = np.zeros(3)
    if len(item.rotations) == 2 and len(item.translations) == 3:
        return [here, np.eye(3)[next(k for k in range(3) if AXES[k] not in item.rotations)]]
    whole = not item.rotations or (len(item.rotations) == 3 and len(item.translations) == 3)
    return [here] if whole and item.translations else []


def _rigid(assembly: Assembly, tree: Tree, item: sf.Closure, offset: Array) -> Constraint:
    """A weld or point constraint for a closure, at an offset along the first frame's axes."""
    ends = []
    for anchor in (item.first, item.second):
        name = anchor_name(assembly, anchor)
        if not name:
            ends.append(End("", p=vector(offset)))
            continue
        site = assembly.frames[name]
        link = tree.links[site.mover].name if site.mover != BASE else ""
        ends.append(End(link, rows(site.X_BF.R), vector(site.X_BF.p + site.X_BF.R @ offset)))
    return Constraint("weld" if len(item.rotations) == 3 else "point", tuple(ends))


def _only_blocks(model: Any, one: Any, item: sf.Closure) -> bool:
    """Whether what it blocks beyond the closure does not move anyway, as across the plane of a planar mechanism."""
    free = [k for k in range(3) if AXES[k] not in item.translations]
    data, rng = model.createData(), np.random.default_rng(0)
    models = pin.StdVec_RigidConstraintModel([one])
    datas = pin.StdVec_RigidConstraintData([one.createData()])
    for _ in range(_TRIALS if free else 0):
        q = pin.integrate(model, pin.neutral(model), rng.uniform(-1, 1, model.nv))
        pin.computeAllTerms(model, data, q, np.zeros(model.nv))
        J = np.array(pin.getConstraintsJacobian(model, data, models, datas))
        if np.abs(J.reshape(-1, model.nv)[free]).max() > _FLAT:
            return False
    return True
