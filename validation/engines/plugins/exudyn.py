"""Exudyn: its kinematic trees (ObjectKinematicTree)."""

from __future__ import annotations

import numpy as np

from ..interface import STEP, Array, Convention, Link, Slot, Tree, Unsupported
from .turns.exudyn_items import QUIET
from .writing import copies
from .writing.source import Source, SourcePlugin, Way, series, ways_of

_SETUP = """import numpy as np
import exudyn as exu
from exudyn import itemInterface as items
container = exu.SystemContainer()
mbs = container.AddSystem()
n = len(types)
still = [0.0] * n
node = mbs.AddNode(items.NodeGenericODE2(referenceCoordinates=still, initialCoordinates=still,
    initialCoordinates_t=still, numberOfODE2Coordinates=n))
tree = mbs.AddObject(items.ObjectKinematicTree(nodeNumber=node, gravity=gravity,
    jointTypes=[getattr(exu.JointType, name) for name in types], linkParents=parents,
    jointTransformations=exu.Matrix3DList([np.array(R) for R in rotations]), jointOffsets=exu.Vector3DList(offsets),
    linkInertiasCOM=exu.Matrix3DList([np.array(J) for J in inertias]), linkCOMs=exu.Vector3DList(coms),
    linkMasses=masses, jointPControlVector=stiffness, jointPositionOffsetVector=rest, jointDControlVector=damping,
    jointVelocityOffsetVector=still))
if any(armatures):
    mbs.AddObject(items.ObjectGenericODE2(nodeNumbers=[node], massMatrix=np.diag(armatures)))
def sensor(link, place, name):
    kind = getattr(exu.OutputVariableType, name)
    return mbs.AddSensor(items.SensorKinematicTree(objectNumber=tree, linkNumber=link, localPosition=place,
        outputVariableType=kind, writeToFile=False))
names = ("Position", "RotationMatrix", "Velocity", "AngularVelocity", "Acceleration", "AngularAcceleration")
# Of the world there are none.
sensors = [[sensor(link, place, name) for name in names if link >= 0] for link, place in zip(links, places)]
def read(k): return [[*mbs.GetSensorValues(s[k]), *mbs.GetSensorValues(s[k + 1])] if s else [0.0] * 6 for s in sensors]
mbs.Assemble()
solver = exu.MainSolverImplicitSecondOrder()
settings = exu.SimulationSettings()
{quiet}
solver.InitializeSolver(mbs, settings)
def state(q, v=None, a=None):
    now = exu.ConfigurationType.Current
    mbs.systemData.SetODE2Coordinates(q, configuration=now)
    mbs.systemData.SetODE2Coordinates_t(np.zeros(n) if v is None else v, configuration=now)
    mbs.systemData.SetODE2Coordinates_tt(np.zeros(n) if a is None else a, configuration=now)
def forces():
    solver.ComputeODE2RHS(mbs)
    return np.array(solver.GetSystemResidual()[:n])""".replace("{quiet}", QUIET)


def _step(kind: str) -> Way:
    """A step of SolveDynamic."""
    return Way(
        f"SolveDynamic, {kind}",
        f"""initial, s = exu.ConfigurationType.Initial, mbs.systemData
mbs.SetObjectParameter(tree, "jointForceVector", tau.tolist())
s.SetODE2Coordinates(q, configuration=initial)
s.SetODE2Coordinates_t(v, configuration=initial)
settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = 1, {STEP}
settings.timeIntegration.verboseMode, settings.timeIntegration.adaptiveStep = 0, False
try: mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.{kind})
finally: mbs.SetObjectParameter(tree, "jointForceVector", still)
value = np.r_[s.GetODE2Coordinates(), s.GetODE2Coordinates_t()]""",
    )


WAYS = {
    "sizes": Way("numberOfODE2Coordinates", "value = [n, n]"),
    "mass_matrix": Way(
        "ComputeMassMatrix", "state(q)\nsolver.ComputeMassMatrix(mbs)\nvalue = solver.GetSystemMassMatrix()"
    ),
    "bias": Way("-ComputeODE2RHS", "state(q, v)\nvalue = -forces()"),
    "gravity": Way("-ComputeODE2RHS", "state(q)\nvalue = -forces()"),
    "link_poses": Way(
        "SensorKinematicTree",
        "state(q)\nvalue = [[*mbs.GetSensorValues(s[0]), *(mbs.GetSensorValues(s[1]).reshape(3, 3) @ np.array(T).T)"
        ".flat] if s else [*p, *np.array(T).T.flat] for s, p, T in zip(sensors, places, turns)]",
    ),
    "link_velocities": Way("SensorKinematicTree", "state(q, v)\nvalue = read(2)"),
    "link_accelerations": Way("SensorKinematicTree", "state(q, v, a)\nvalue = read(4)"),
    "link_jacobians": Way(
        "SensorKinematicTree, by columns",
        "value = np.zeros((len(links), 6, n))\nfor k, unit in enumerate(np.eye(n)):\n    state(q, unit)\n"
        "    value[:, :, k] = read(2)",
    ),
    "step_euler": _step("ExplicitEuler"),
    "step_midpoint": _step("ExplicitMidpoint"),
    "step_rk4": _step("RK44"),
    # Newton's method ends at a relative residual of 1e-8, which the equation's condition makes larger in the speeds.
    "step_trapezoidal": _step("TrapezoidalIndex2")._replace(slack=1e-7),
}
# Trees in Python, of links without springs, dampers and armature.
_PARTS = """from exudyn import kinematicTree as kt, rigidBodyUtilities as rbu
short = [name[0] + name[-1].lower() for name in types]
turned, moved = [np.array(R) for R in rotations], [np.array(p) for p in offsets]
"""
_TREE66 = f"""{_PARTS}shifts = [rbu.RotationTranslation2T66Inverse(R, p) for R, p in zip(turned, moved)]
bodies = [kt.MassCOMinertia2T66(m, c, np.array(J)) for m, c, J in zip(masses, coms, inertias)]
python = kt.KinematicTree66(short, shifts, bodies, parents, gravity)
"""
_TREE33 = f"""{_PARTS}full = [np.array(J) + m * (np.dot(c, c) * np.eye(3) - np.outer(c, c))
    for J, m, c in zip(inertias, masses, coms)]
python = kt.KinematicTree33(short, turned, moved, full, [np.array(c) for c in coms], masses, parents, gravity)
"""
_ROBOT = f"""{_PARTS}from exudyn.robotics import Robot, RobotLink
python = Robot(gravity=gravity)
for m, c, J, kind, parent, R, p in zip(masses, coms, inertias, short, parents, turned, moved):
    python.AddLink(RobotLink(m, c, np.array(J), jointType=kind, parent=parent,
        preHT=rbu.HomogeneousTransformation(R, p)))
frames = python.JointHT(q)
"""
_IN_PYTHON = {
    f"{name}:{tree}": Way(f"{tree}.{native}", f"{text}value = python.{native}({call}{place}")
    for tree, text in (("KinematicTree66", _TREE66), ("KinematicTree33", _TREE33))
    for name, native, call, place in (
        ("mass_matrix", "ComputeMassMatrixAndForceTerms", "q, 0 * q)", "[0]"),
        ("bias", "ComputeMassMatrixAndForceTerms", "q, v)", "[1]"),
        ("forward_dynamics", "ForwardDynamicsCRB", "q, v, tau)", ""),
    )
} | ways_of(f"""
== link_poses:Robot | Robot.JointHT
{_ROBOT}at = [(np.array(rbu.HT2rotationMatrix(X)), np.array(rbu.HT2translation(X))) for X in frames]
value = [[*(at[k][1] + at[k][0] @ p), *(at[k][0] @ np.array(T).T).flat] if k >= 0 else [*p, *np.array(T).T.flat] for \
k, p, T in zip(links, places, turns)]
== link_jacobians:Robot | Robot.Jacobian
{_ROBOT}value = np.zeros((len(links), 6, n))
for i, (k, p) in enumerate(zip(links, places)):
    if k >= 0:
        R, x = rbu.HT2rotationMatrix(frames[k]), rbu.HT2translation(frames[k])
        value[i] = python.Jacobian(frames, toolPosition=np.array(x) + np.array(R) @ p, linkIndex=k)
""")
WAYS |= _IN_PYTHON
_KEPT = (
    "state(q, v)\n",
    "kept = mbs.systemData.GetSystemState()\nstate(0 * q)\nmbs.systemData.SetSystemState(kept)\n",
)
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


class _Links:
    """Exudyn's links of a tree, and the placement of each of our links on the Exudyn link that carries it."""

    def __init__(self) -> None:
        self.types: list[str] = []
        self.parents: list[int] = []
        self.masses: list[float] = []
        self.armatures: list[float] = []
        # Of each link's joint: damping, stiffness, coordinate at rest.
        self.forces: list[tuple[float, float, float]] = []
        self.rotations: list[Array] = []
        self.offsets: list[Array] = []
        self.inertias: list[Array] = []
        self.coms: list[Array] = []
        # Of each link of Exudyn's, its axes in the frame of ours.
        self.turns: list[Array] = []
        # Of each of our links, Exudyn's that carries it, and its placement there in our frame.
        self.carriers: list[tuple[int, Array, Array]] = []
        self.slots: list[tuple[Slot, ...]] = []

    def add(self, link: Link) -> Unsupported | None:
        """Append a link, preceded by massless ones for joints in series; `Unsupported` if Exudyn has no such link."""
        steps, (R_end, p_end) = series(link.joints)
        carrier, R0, p0 = self.carriers[link.parent] if link.parent >= 0 else (-1, np.eye(3), np.zeros(3))
        if not steps and link.mass == 0.0 and not np.any(link.inertia):
            self.carriers.append((carrier, R0 @ R_end, p0 + R0 @ p_end))
            self.slots.append(())
            return None
        if not steps or np.any(p_end) or not np.array_equal(R_end, np.eye(3)):
            return Unsupported("a link stands at a joint of its own", offered=False)
        own = []
        for R, p, joint in steps:
            if joint.kind not in ("revolute", "prismatic") or joint.form or joint.mimics:
                return Unsupported("links turn about, or slide along, one axis", offered=False)
            R, p = R0 @ R, p0 + R0 @ p
            R0, p0 = np.eye(3), np.zeros(3)
            T, T_parent = _turn(joint.axis), self.turns[carrier] if carrier >= 0 else np.eye(3)
            self.types.append(joint.kind.capitalize() + _LETTERS.get(joint.axis, "Z"))
            self.parents.append(carrier)
            self.rotations.append(T_parent.T @ R @ T)
            self.offsets.append(T_parent.T @ p)
            self.turns.append(T)
            self.masses.append(0.0)
            self.armatures.append(sum(joint.armature))
            self.forces.append((joint.damping, joint.stiffness, joint.rest))
            self.coms.append(np.zeros(3))
            self.inertias.append(np.zeros((3, 3)))
            carrier = len(self.types) - 1
            own.append(Slot("angle" if joint.kind == "revolute" else "length", (carrier,), (carrier,)))
        T = self.turns[carrier]
        self.masses[carrier], self.coms[carrier] = link.mass, T.T @ np.array(link.com)
        self.inertias[carrier] = T.T @ np.array(link.inertia) @ T
        self.carriers.append((carrier, np.eye(3), np.zeros(3)))
        self.slots.append(tuple(own))
        return None


def write(tree: Tree) -> Source | Unsupported:
    """Python text that builds a kinematic tree; joints in series hang on links without mass."""
    made = _Links()
    for link in tree.links:
        obstacle = made.add(link)
        if obstacle is not None:
            return obstacle
    listed = ("rotations", "offsets", "coms", "inertias")
    axes = [*made.turns, np.eye(3)]  # The last are the world's.
    places = [axes[k].T @ p for k, _, p in made.carriers]
    turns = [R.T @ axes[k] for k, R, _ in made.carriers]
    lines = (
        f"types, parents, masses = {made.types!r}, {made.parents!r}, {made.masses!r}",
        *(f"{name} = [{', '.join(map(_plain, getattr(made, name)))}]" for name in listed),
        *(f"{name} = {[row[k] for row in made.forces]!r}" for k, name in enumerate(("damping", "stiffness", "rest"))),
        f"gravity, armatures = {list(tree.gravity)!r}, {made.armatures!r}",
        f"links, places = {[k for k, _, _ in made.carriers]!r}, [{', '.join(map(_plain, places))}]",
        f"turns = [{', '.join(map(_plain, turns))}]",
        _SETUP,
    )
    is_plain = not any(made.armatures) and not any(any(row[:2]) for row in made.forces)
    lacks = () if is_plain else tuple(_IN_PYTHON)
    return Source(lines, tuple(made.slots), len(made.types), len(made.types), lacks=lacks)


PLUGIN = SourcePlugin(
    name="exudyn",
    package="exudyn",
    extra="exudyn",
    conventions=(
        Convention("right-hand side", "forces applied less h"),
        Convention("coordinates", "offsets from reference values, here zero"),
        Convention("axes", "x, y, z of a joint's frame; others by turning the link's frame"),
        Convention("armature", "none; an object of its own on the same coordinates"),
        Convention("joints", "revolute and prismatic; others are bodies with Euler parameters and constraints"),
    ),
    kinds={
        "revolute x": "RevoluteX",
        "revolute y": "RevoluteY",
        "revolute z": "RevoluteZ",
        "revolute oblique": "RevoluteZ",
        "prismatic": "PrismaticX",
        "prismatic oblique": "PrismaticZ",
    },
    ways=WAYS | copies.of_state(WAYS, {"GetSystemState": _KEPT}, ("bias", "link_velocities")),
    write=write,
    demands={"dampers": "jointDControlVector", "springs": "jointPControlVector"},
    calls=4,
)
