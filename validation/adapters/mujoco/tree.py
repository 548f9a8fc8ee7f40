"""MuJoCo: its tree algorithms, without contacts and without its integrators (github.com/google-deepmind/mujoco)."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from ...contract.conventions import Chart, Encoding, Slot, angular_first_to_linear_first, xyzw_to_wxyz
from ...contract.interface import States, Subject, TreeEngine, Unsupported
from ...contract.quantities import TREE_QUANTITIES
from ...mechanics.assembly import BASE, Assembly, Mover
from ...mechanics.geometry import Array, Placement, matrix_quaternion
from ...mechanics.joint_kinds import PartKind
from ..reach import armature, offered, unrepresented

NAME = "mujoco"
VERSION: str = mujoco.__version__
# Kinds of simple joints that it has.
_JOINTS: frozenset[PartKind] = frozenset({"revolute", "prismatic", "ball", "free"})

_SITE = mujoco.mjtObj.mjOBJ_SITE
_HINGE, _SLIDE = mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE
_BALL, _FREE = mujoco.mjtJoint.mjJNT_BALL, mujoco.mjtJoint.mjJNT_FREE


@dataclass(frozen=True)
class MujocoEngine:
    """An `MjModel` behind the `Engine` protocol.

    Attributes:
        name: "mujoco", or "mujoco-urdf" for its own reading of a file.
        model: MuJoCo's model.
        chart: Map between its coordinates and ours.
        sites: Indices of the subject's frames among its sites.
        capabilities: Quantities that it offers on this route.
    """

    name: str
    model: Any
    chart: Chart
    sites: tuple[int, ...] = ()
    capabilities: frozenset[str] = TREE_QUANTITIES
    version: str = VERSION

    def write(self, path: Path) -> None:
        """Write the MuJoCo model to a binary file, for programs in C."""
        mujoco.mj_saveModel(self.model, str(path))

    def body(self, name: str) -> int:
        """MuJoCo's index of one of our moving bodies, by name."""
        return int(self.model.body(name).id)

    def _each(self, states: States, result: Callable[[Any], Any]) -> Array:
        """One state at a time: positions, velocities and M are up to date in the data that `result` gets."""
        m, d = self.model, mujoco.MjData(self.model)
        q, v = self.chart.coordinates(states.q), self.chart.speeds(states.q, states.v)
        results = []
        for d.qpos[:], d.qvel[:] in zip(q, v, strict=True):
            mujoco.mj_kinematics(m, d)
            mujoco.mj_comPos(m, d)
            mujoco.mj_makeM(m, d)
            mujoco.mj_comVel(m, d)
            results.append(np.array(result(d)))
        return np.array(results)

    def _inertia(self, states: States) -> Array:
        def result(d: Any) -> Array:
            M = np.zeros((self.model.nv, self.model.nv))
            mujoco.mj_fullM(self.model, d, M)
            return M

        return self._each(states, result)

    def _newton_euler(self, d: Any, with_acceleration: bool) -> Array:
        force = np.zeros(self.model.nv)
        mujoco.mj_rne(self.model, d, int(with_acceleration), force)
        return force

    def mass_matrix(self, states: States) -> Array:
        """Composite rigid bodies."""
        return self.chart.mass_matrix(states.q, self._inertia(states))

    def bias(self, states: States) -> Array:
        """Newton-Euler without accelerations."""
        h = self._each(states, lambda d: self._newton_euler(d, with_acceleration=False))
        return self.chart.bias(states.q, states.v, h, self._inertia(states))

    def kinetic_energy(self, states: States) -> Array:
        """v^T M v / 2 by the engine's own sparse product."""

        def result(d: Any) -> float:
            mujoco.mj_energyVel(self.model, d)
            return float(d.energy[1])

        return self._each(states, result)

    def potential_energy(self, states: States) -> Array:
        """Gravitational potential energy (N,) [J]."""

        def result(d: Any) -> float:
            mujoco.mj_energyPos(self.model, d)
            return float(d.energy[0])

        return self._each(states, result)

    def inverse_dynamics(self, states: States) -> Array:
        """Newton-Euler with accelerations; it leaves armatures out, which MuJoCo adds afterwards."""
        a = iter(self.chart.accelerations(states.q, states.v, states.a))

        def result(d: Any) -> Array:
            d.qacc[:] = next(a)
            force: Array = self._newton_euler(d, with_acceleration=True) + self.model.dof_armature * d.qacc
            return force

        return self.chart.our_forces(states.q, self._each(states, result)) - states.passive

    def forward_dynamics(self, states: States) -> Array:
        """Sparse LDL^T of M."""
        forces = iter(self.chart.forces(states.q, states.applied))

        def result(d: Any) -> Array:
            a = np.zeros((1, self.model.nv))
            net = next(forces) - self._newton_euler(d, with_acceleration=False)
            mujoco.mj_factorM(self.model, d)
            mujoco.mj_solveM(self.model, d, a, net[None])
            return np.asarray(a[0])

        return self.chart.our_accelerations(states.q, states.v, self._each(states, result))

    def frame_pose(self, states: States) -> Array:
        """Poses of the sites: p_WF and the rows of R_WF (N, F, 12)."""
        return self._each(states, lambda d: [np.append(d.site_xpos[s], d.site_xmat[s]) for s in self.sites])

    def frame_velocity(self, states: States) -> Array:
        """Velocities of the sites (linear; angular) in world axes (N, F, 6)."""

        def one(d: Any, site: int) -> Array:
            velocity = np.zeros(6)
            mujoco.mj_objectVelocity(self.model, d, _SITE, site, velocity, 0)
            return angular_first_to_linear_first(velocity)

        return self._each(states, lambda d: [one(d, site) for site in self.sites])

    def frame_acceleration(self, states: States) -> Array:
        """Of sites; MuJoCo accelerates the world by -gravity, which is taken out again."""
        gravity: Array = np.append(self.model.opt.gravity, np.zeros(3))
        a = iter(self.chart.accelerations(states.q, states.v, states.a))

        def one(d: Any, site: int) -> Array:
            acceleration = np.zeros(6)
            mujoco.mj_objectAcceleration(self.model, d, _SITE, site, acceleration, 0)
            return angular_first_to_linear_first(acceleration) + gravity

        def result(d: Any) -> list[Array]:
            d.qacc[:] = next(a)
            mujoco.mj_rnePostConstraint(self.model, d)
            return [one(d, site) for site in self.sites]

        return self._each(states, result)

    def _site_jacobian(self, d: Any, site: int) -> Array:
        J = np.zeros((6, self.model.nv))
        mujoco.mj_jacSite(self.model, d, J[:3], J[3:], site)
        return J

    def _site_jacobian_rate(self, d: Any, site: int) -> Array:
        rate = np.zeros((6, self.model.nv))
        body = int(self.model.site_bodyid[site])
        mujoco.mj_jacDot(self.model, d, rate[:3], rate[3:], d.site_xpos[site].copy(), body)
        return rate

    def _jacobians(self, states: States, one: Callable[[Any, int], Array]) -> Array:
        return self._each(states, lambda d: [one(d, site) for site in self.sites])

    def frame_jacobian(self, states: States) -> Array:
        """Jacobians of the sites (linear; angular) in world axes (N, F, 6, nv)."""
        return self.chart.jacobian(states.q, self._jacobians(states, self._site_jacobian))

    def frame_jacobian_rate(self, states: States) -> Array:
        """Time derivatives of the Jacobians of points fixed on the sites' bodies (N, F, 6, nv)."""
        J = self._jacobians(states, self._site_jacobian)
        J_rate = self._jacobians(states, self._site_jacobian_rate)
        return self.chart.jacobian_rate(states.q, states.v, J, J_rate)


def build(subject: Subject) -> TreeEngine | Unsupported:
    """MuJoCo's model of a description, body by body, with everything fixed to a body merged into it."""
    assembly = subject.assembly
    obstacle = unrepresented(subject.system, assembly, _JOINTS)
    if obstacle is not None:
        return obstacle
    for mover in assembly.movers:
        if mover.kind == "free" and armature(subject.system, mover):
            # The rate of world components is another acceleration than the rate of body components.
            return Unsupported(f"joint '{mover.joint.name}': an armature along body axes")
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.option.gravity = assembly.gravity
    bodies = [spec.worldbody]
    for parts in _composite_joints(assembly):
        # Parts of one joint are several joints of one MuJoCo body, whose inertia the last part has.
        X_PB = _placements_of_body(parts)
        if parts[0].has_quaternion and len(parts) > 1:
            return Unsupported(f"joint '{parts[0].joint.name}': a quaternion among the coordinates of a series")
        body = _add_body(bodies[parts[0].parent + 1], parts[0].X_AP @ X_PB[0], parts[-1])
        for mover, X in zip(parts, X_PB, strict=True):
            bodies.append(body)
            _add_joints(body, mover, X, armature(subject.system, mover))
    for frame in subject.frames:
        site = assembly.frames[frame]
        bodies[site.mover + 1].add_site(name=frame, **_pose(site.X_BF))
    model = compiled(spec)
    if isinstance(model, Unsupported):
        return model
    sites = tuple(mujoco.mj_name2id(model, _SITE, frame) for frame in subject.frames)
    return MujocoEngine(NAME, model, chart_of(model, assembly), sites, offered(MujocoEngine, subject.system))


def compiled(spec: Any) -> Any | Unsupported:
    """An MjModel, or what MuJoCo has against it."""
    try:
        return spec.compile()
    except ValueError as error:
        return Unsupported(explain(str(error)))


@contextmanager
def quiet() -> Iterator[None]:
    """Without MuJoCo's warnings: it would log them into a file in the folder that the user happens to be in."""
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda message: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)


def explain(message: str) -> str:
    """MuJoCo's two-line complaint as one phrase that begins with the name of the thing."""
    complaint, _, where = message.partition("\n")
    complaint = complaint.removeprefix("Error: ").strip()
    name = re.search(r"name '([^']+)'", where)
    return f"body '{name[1]}': {complaint}" if name else complaint


def _pose(X: Placement) -> dict[str, Array]:
    return {"pos": X.p, "quat": xyzw_to_wxyz(matrix_quaternion(X.R))}


def _composite_joints(assembly: Assembly) -> list[list[Mover]]:
    """Movers, those of one joint together, from the parent outwards."""
    joints: list[list[Mover]] = []
    for mover in assembly.movers:
        if mover.continues:
            joints[-1].append(mover)
        else:
            joints.append([mover])
    return joints


def _placements_of_body(parts: list[Mover]) -> list[Placement]:
    """The body in the proximal frame P of each part of a joint, all parts after it in their neutral positions."""
    placements = [Placement.identity()]
    for mover in reversed(parts[1:]):
        placements.append(mover.X_AP @ placements[-1])
    return placements[::-1]


def _add_body(parent: Any, X_AB: Placement, last: Mover) -> Any:
    body = parent.add_body(name=last.body, **_pose(X_AB))
    merged = last.merged()
    # MuJoCo's own diagonalisation stops at 1e-12, which shows in the light bodies of a hand; LAPACK's does not.
    moments, axes = np.linalg.eigh(merged.J_BC)
    axes[:, 2] *= np.linalg.det(axes)
    body.mass, body.inertia, body.explicitinertial = merged.mass, moments, True
    body.ipos, body.iquat = merged.p_BC, xyzw_to_wxyz(matrix_quaternion(axes))
    return body


def _add_joints(body: Any, mover: Mover, X_PB: Placement, armature: float) -> None:
    """Joints of one part, stated in the body's frame: MuJoCo's anchors and axes are fixed on the body."""
    name, X_BP = mover.name, X_PB.inverse()
    if mover.kind == "free" and mover.parent == BASE:
        body.add_joint(name=name, type=_FREE, armature=armature)
    elif mover.kind == "free":
        for axis in np.eye(3):
            body.add_joint(name=f"{name}.{'xyz'[int(axis.argmax())]}", type=_SLIDE, axis=axis, armature=armature)
        body.add_joint(name=name, type=_BALL, armature=armature)
    elif mover.kind == "ball":
        body.add_joint(name=name, type=_BALL, pos=X_BP.p, armature=armature)
    else:
        kind = _SLIDE if mover.kind == "prismatic" else _HINGE
        body.add_joint(name=name, type=kind, pos=X_BP.p, axis=X_BP.R @ mover.axis, armature=armature)


def chart_of(model: Any, assembly: Assembly, names: Mapping[str, str] | None = None) -> Chart:
    """Where MuJoCo put our joints.

    Args:
        model: An MjModel.
        assembly: Assembly of the description.
        names: Our joints' names -> its names, where they may differ.

    Raises:
        KeyError: The model lacks one of our joints.
    """
    slots = [_slot(model, mover, (names or {}).get(mover.name, mover.name)) for mover in assembly.movers]
    return Chart(tuple(slots), model.nq, model.nv)


def _slot(model: Any, mover: Mover, name: str) -> Slot:
    split = mover.kind == "free" and mover.parent != BASE
    joint = model.joint(f"{name}.x" if split else name)
    encoding: Encoding = "same"
    if mover.kind == "free":
        encoding = "free_in_parent" if split else "free_in_world"
    elif mover.kind == "ball":
        encoding = "wxyz"
    return Slot(mover, int(joint.qposadr[0]), int(joint.dofadr[0]), encoding)
