"""Exudyn: its kinematic trees (ObjectKinematicTree)."""

from __future__ import annotations

import numpy as np

from ..interface import Array, Difference, Slot, Tree, Unsupported
from .writing.source import Source, SourcePlugin, Way, series

_SETUP = """import numpy as np
import exudyn as exu
from exudyn import itemInterface as items
mbs = exu.SystemContainer().AddSystem()
n = len(types)
still = [0.0] * n
node = mbs.AddNode(items.NodeGenericODE2(referenceCoordinates=still, initialCoordinates=still,
    initialCoordinates_t=still, numberOfODE2Coordinates=n))
tree = mbs.AddObject(items.ObjectKinematicTree(nodeNumber=node, gravity=gravity,
    jointTypes=[getattr(exu.JointType, name) for name in types], linkParents=parents,
    jointTransformations=exu.Matrix3DList([np.array(R) for R in rotations]), jointOffsets=exu.Vector3DList(offsets),
    linkInertiasCOM=exu.Matrix3DList([np.array(J) for J in inertias]), linkCOMs=exu.Vector3DList(coms),
    linkMasses=masses))
def sensor(link, name):
    kind = getattr(exu.OutputVariableType, name)
    return mbs.AddSensor(items.SensorKinematicTree(objectNumber=tree, linkNumber=link, localPosition=[0, 0, 0],
        outputVariableType=kind, writeToFile=False))
names = ("Position", "RotationMatrix", "Velocity", "AngularVelocity")
sensors = [[sensor(link, name) for name in names] for link in links]
mbs.Assemble()
solver = exu.MainSolverImplicitSecondOrder()
settings = exu.SimulationSettings()
settings.solution.file.write, settings.solution.file.name = False, ""
solver.InitializeSolver(mbs, settings)
def state(q, v=None):
    now = exu.ConfigurationType.Current
    mbs.systemData.SetODE2Coordinates(q, configuration=now)
    mbs.systemData.SetODE2Coordinates_t(np.zeros(n) if v is None else v, configuration=now)
def forces():
    solver.ComputeODE2RHS(mbs)
    return np.array(solver.GetSystemResidual()[:n])"""
WAYS = {
    "sizes": Way("numberOfODE2Coordinates", "value = [n, n]"),
    "mass_matrix": Way(
        "ComputeMassMatrix", "state(q)\nsolver.ComputeMassMatrix(mbs)\nvalue = solver.GetSystemMassMatrix()"
    ),
    "bias": Way("-ComputeODE2RHS", "state(q, v)\nvalue = -forces()"),
    "gravity": Way("-ComputeODE2RHS", "state(q)\nvalue = -forces()"),
    "link_poses": Way(
        "SensorKinematicTree",
        "state(q)\nvalue = [[*mbs.GetSensorValues(s[0]),"
        " *(mbs.GetSensorValues(s[1]).reshape(3, 3) @ np.array(T).T).flat] for s, T in zip(sensors, turns)]",
    ),
    "link_velocities": Way(
        "SensorKinematicTree",
        "state(q, v)\nvalue = [[*mbs.GetSensorValues(s[2]), *mbs.GetSensorValues(s[3])] for s in sensors]",
    ),
    "link_jacobians": Way(
        "SensorKinematicTree, by columns",
        "value = np.zeros((len(links), 6, n))\nfor k, unit in enumerate(np.eye(n)):\n    state(q, unit)\n"
        "    value[:, :, k] = [[*mbs.GetSensorValues(s[2]), *mbs.GetSensorValues(s[3])] for s in sensors]",
    ),
}
_LETTERS = {(1.0, 0.0, 0.0): "X", (0.0, 1.0, 0.0): "Y", (0.0, 0.0, 1.0): "Z"}


def _turn(axis: tuple[float, float, float]) -> Array:
    """Axes of a link's frame in Exudyn: its own, or ones whose z axis is the joint's."""
    if axis in _LETTERS:
        return np.eye(3)
    z = np.array(axis) / np.linalg.norm(axis)
    x = np.cross(np.eye(3)[int(np.argmin(np.abs(z)))], z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)


def _plain(values: Array) -> str:
    return repr(np.asarray(values, dtype=float).tolist())


def write(tree: Tree) -> Source | Unsupported:
    """Text that builds a kinematic tree; joints in series hang on links without mass."""
    types: list[str] = []
    parents: list[int] = []
    rotations, offsets, inertias, coms, turns = ([] for _ in range(5))  # type: ignore[var-annotated]
    masses: list[float] = []
    last: list[int] = []
    slots: list[tuple[Slot, ...]] = []
    for link in tree.links:
        steps, (R_end, p_end) = series(link.joints)
        if not steps or np.any(p_end) or not np.array_equal(R_end, np.eye(3)):
            return Unsupported("a link stands at a joint of its own", offered=False)
        parent, own = last[link.parent] if link.parent >= 0 else -1, []
        for R, p, joint in steps:
            if joint.kind not in ("revolute", "prismatic") or joint.form or joint.mimics or any(joint.armature):
                return Unsupported("links turn about, or slide along, one axis", offered=False)
            T, T_parent = _turn(joint.axis), turns[parent] if parent >= 0 else np.eye(3)
            types.append(joint.kind.capitalize() + _LETTERS.get(joint.axis, "Z"))
            parents.append(parent)
            rotations.append(T_parent.T @ R @ T)
            offsets.append(T_parent.T @ p)
            turns.append(T)
            masses.append(0.0)
            coms.append(np.zeros(3))
            inertias.append(np.zeros((3, 3)))
            parent = len(types) - 1
            own.append(Slot("angle" if joint.kind == "revolute" else "length", (parent,), (parent,)))
        T = turns[parent]
        masses[parent], coms[parent] = link.mass, T.T @ np.array(link.com)
        inertias[parent] = T.T @ np.array(link.inertia) @ T
        last.append(parent)
        slots.append(tuple(own))
    lines = (
        f"types, parents, masses = {types!r}, {parents!r}, {masses!r}",
        *(
            f"{name} = [{', '.join(map(_plain, values))}]"
            for name, values in (
                ("rotations", rotations), ("offsets", offsets), ("coms", coms), ("inertias", inertias),
            )
        ),
        f"gravity, links = {list(tree.gravity)!r}, {last!r}",
        f"turns = [{', '.join(_plain(turns[k]) for k in last)}]",
        _SETUP,
    )  # fmt: off
    return Source(lines, tuple(slots), len(types), len(types))


PLUGIN = SourcePlugin(
    name="exudyn",
    package="exudyn",
    extra="exudyn",
    conventions=(
        Difference("right-hand side", "forces applied less h"),
        Difference("coordinates", "offsets from reference values, here zero"),
        Difference("axes", "x, y, z of a joint's frame; others by turning the link's frame"),
        Difference("armature", "none; an object of its own on the same coordinates"),
        Difference("joints", "revolute and prismatic; others are bodies with Euler parameters and constraints"),
    ),
    kinds={
        "revolute x": "RevoluteX",
        "revolute y": "RevoluteY",
        "revolute z": "RevoluteZ",
        "revolute oblique": "RevoluteZ",
        "prismatic": "PrismaticX",
        "prismatic oblique": "PrismaticZ",
    },
    ways=WAYS,
    write=write,
)
