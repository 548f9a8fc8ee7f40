"""Exudyn in redundant coordinates: every link a rigid body with a node of its own, every joint a connector.

Exudyn gives the mass matrix M of its nodes' coordinates x, the forces f, the conditions of its joints and their
Jacobian C. With x' = D v, D from the placements that the tree states, and s what x'' is where v' = 0,

    D^T M D,    h = D^T (M s - f)                                                                        (1)

are the tree's own, and the accelerations that Exudyn's joints allow are those of

    M x'' + C^T lam = f + F,    C x'' = -C' x',    D^T F = tau,    v' = D^+ (x'' - s)                      (2)

solved by least squares: planar loops repeat conditions, and joints have rows of zeros for what they leave free. C' x'
is a difference of sixth order along the motion, exact for conditions that are polynomials of degree six or less, as
those of Euler parameters are.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...interface import Array, Convention, Joint, Slot, Tree, Unsupported
from .. import turns
from ..turns import exudyn as turning
from ..writing.source import Source, SourcePlugin, Way, series, ways_of
from . import exudyn_connectors as connectors
from . import exudyn_systems
from .exudyn_connectors import connector, end_of, plain

_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
# Of conditions that are no polynomials, with steps of 4e-3: rounding over the step, and its sixth power.
_DIFFERENCE = 1e-9
_FREE = [0] * 6
# Motions along all axes, which need no frame of their own -> what is blocked.
_SLIDING = {
    "slide slide slide": [0, 0, 0, 1, 1, 1],
    "slide slide slide ball": _FREE,
    "slide slide slide hinge hinge hinge": _FREE,
}


class _Step(NamedTuple):
    """An elementary motion: "hinge" and "slide" along an axis, "ball" by a quaternion (w, x, y, z)."""

    kind: str
    axis: tuple[float, float, float]
    q: int
    v: int


class _Native(NamedTuple):
    """How Exudyn has a joint.

    Attributes:
        blocked: Components that ObjectJointGeneric blocks (6): displacements, rotations.
        special: Exudyn's own joint for it; "" for none.
        turned: Rotation (3, 3) of the joint's frame: its z axis is a hinge's, its x axis a slide's.
    """

    blocked: list[int]
    special: str = ""
    turned: Array = np.eye(3)


# Kind of a joint -> elementary motions, chart.
_CHARTS = {
    "revolute": "angle",
    "prismatic": "length",
    "universal": "two angles",
    "euler": "three angles",
    "translation": "three lengths",
    "ball": "quaternion wxyz, body speeds",
    "free": "free wxyz, linear before and angular after",
    "planar": "planar angle",
}


def _steps(joint: Joint, q: int, v: int) -> list[_Step]:
    axes = (_X, _Y, _Z)
    match joint.kind:
        case "revolute":
            return [_Step("hinge", joint.axis, q, v)]
        case "prismatic":
            return [_Step("slide", joint.axis, q, v)]
        case "universal":
            return [_Step("hinge", joint.axis, q, v), _Step("hinge", joint.second, q + 1, v + 1)]
        case "euler":
            return [_Step("hinge", axes["XYZ".index(a)], q + k, v + k) for k, a in enumerate(joint.sequence)]
        case "translation":
            return [_Step("slide", axis, q + k, v + k) for k, axis in enumerate(axes)]
        case "planar":
            slides = [_Step("slide", axis, q + k, v + k) for k, axis in enumerate(axes[:2])]
            return [*slides, _Step("hinge", _Z, q + 2, v + 2)]
        case "ball":
            return [_Step("ball", _Z, q, v)]
        case _:
            slides = [_Step("slide", axis, q + k, v + k) for k, axis in enumerate(axes)]
            return [*slides, _Step("ball", _Z, q + 3, v + 3)]


def _along(axis: tuple[float, float, float], place: int) -> Array:
    """A rotation, one column of which is an axis."""
    e = np.array(axis)
    if axis in (_X, _Y, _Z):
        return np.roll(np.eye(3), place - axis.index(1.0), axis=1)
    first = np.cross(np.eye(3)[int(np.argmin(np.abs(e)))], e)
    first /= np.linalg.norm(first)
    return np.roll(np.stack([e, first, np.cross(e, first)], axis=1), place, axis=1)


def _native(steps: list[_Step]) -> _Native | None:
    """The joint of a series of motions about one point."""
    shape = " ".join(step.kind for step in steps)
    axes = [step.axis for step in steps]
    match shape:
        case "":
            return _Native([1, 1, 1, 1, 1, 1])
        case "hinge":
            return _Native([1, 1, 1, 1, 1, 0], "ObjectJointRevoluteZ", _along(axes[0], 2))
        case "slide":
            return _Native([0, 1, 1, 1, 1, 1], "ObjectJointPrismaticX", _along(axes[0], 0))
        case "ball" | "hinge hinge hinge":
            return _Native([1, 1, 1, 0, 0, 0], "ObjectJointSpherical")
        case "hinge hinge" if axes == [_X, _Y]:
            return _Native([1, 1, 1, 0, 0, 1])
        case "slide hinge" if axes[0] == axes[1]:
            return _Native([1, 1, 0, 1, 1, 0], turned=_along(axes[0], 2))
        case "slide ball" if axes[0] == _X:
            return _Native([0, 1, 1, 0, 0, 0])
        case "slide slide hinge" if axes == [_X, _Y, _Z]:
            return _Native([0, 0, 1, 1, 1, 0])
    return _Native(_SLIDING[shape]) if shape in _SLIDING else None


_NODES = {"": "EP", ":Rxyz": "Rxyz", ":RotVecLG": "RotVecLG"}
WAYS: dict[str, Way] = {}
for _way, _node in _NODES.items():
    _made = f"s = System('{_node}', [])\n"
    _name = f"NodeRigidBody{_node}"
    WAYS |= ways_of(f"""
== mass_matrix{_way} | {_name}: ComputeMassMatrix | {_made}_, D, _, M, _ = s.at(q, 0 * v)\nvalue = D.T @ M @ D
== bias{_way} | {_name}: ComputeODE2RHS | {_made}_, D, second, M, f = s.at(q, v)\nvalue = D.T @ (M @ second - f)
== link_poses{_way} | {_name}: Position, RotationMatrix
{_made}value = s.outputs(q, 0 * v, 0 * v, 'Position', 'RotationMatrix')
== link_velocities{_way} | {_name}: Velocity, AngularVelocity
{_made}value = s.outputs(q, v, 0 * v, 'Velocity', 'AngularVelocity')
== link_accelerations{_way} | {_name}: Acceleration, AngularAcceleration
{_made}value = s.outputs(q, v, a, 'Acceleration', 'AngularAcceleration')
== kinetic_energy{_way} | {_name}: KineticEnergy | {_made}value = np.sum(s.outputs(q, v, 0 * v, 'KineticEnergy'))
== passive_forces{_way} | {_name}: spring-dampers, ComputeODE2RHS
springs
{_made}_, D, _, _, alone = s.at(q, v)
value = D.T @ (System('{_node}', springs).at(q, v)[-1] - alone)
""")
WAYS |= ways_of(f"""
== forward_dynamics | ObjectJointRevoluteZ, PrismaticX, Spherical
value = System('EP', special).solved(q, v, tau, 0.1)[0]
== forward_dynamics:generic | ObjectJointGeneric | value = System('EP', generic).solved(q, v, tau, 0.1)[0]
== forward_dynamics:generic, Rxyz ~ {_DIFFERENCE} | ObjectJointGeneric, NodeRigidBodyRxyz
value = System('Rxyz', generic).solved(q, v, tau, 4e-3)[0]
== constrained_acceleration ~ {_DIFFERENCE} | ObjectJointSpherical, Generic, ConnectorDistance
loops
value = System('EP', special + loops).solved(q, v, tau, 4e-3)[0]
== constrained_acceleration:generic ~ {_DIFFERENCE} | ObjectJointGeneric
loops_generic
value = System('EP', generic + loops_generic).solved(q, v, tau, 4e-3)[0]
== # Of the first body's point, in the world.
== constraint_forces ~ {_DIFFERENCE} | ObjectJointSpherical: Force
points
forces = System('EP', special + loops).reactions(q, v, tau, 'Force')
frames = moved(q, v)
value = np.concatenate([(frames[k][0] @ R if k >= 0 else R).T @ f for (k, R), f in zip(points, forces)])
== constraint_forces:generic ~ {_DIFFERENCE} | ObjectJointGeneric: ForceLocal
points
value = np.concatenate(System('EP', generic + loops_generic).reactions(q, v, tau, 'ForceLocal'))
""")
_NEEDED = {
    "quaternion": tuple(exudyn_systems.QUATERNION.split("\n")),
    "cross": tuple(exudyn_systems.MOVED.split("\n")),
    "System": tuple(exudyn_systems.SYSTEM.split("\n")),
}


_INITIAL = """container = exu.SystemContainer()
mbs, matrix = container.AddSystem(), ut.EulerParameters2RotationMatrix
body = mbs.CreateRigidBody(
    inertia=ut.InertiaCuboid(1000, [1, 1, 1]), referenceRotationMatrix=matrix(q), initialRotationMatrix=matrix(q2),
    nodeType=exu.NodeType.{node})
mbs.Assemble()
what, when = exu.OutputVariableType.RotationMatrix, exu.ConfigurationType.Initial
value = mbs.GetObjectOutputBody(body, what, [0, 0, 0], when)"""
WAYS |= {
    f"rotation_composed{way}": Way("CreateRigidBody: initialRotationMatrix", _INITIAL.format(node=node))
    for way, node in (
        ("", "RotationEulerParameters"),
        (":Rxyz", "RotationRxyz"),
        (":rotation vector", "RotationRotationVector"),
    )
}
WAYS |= turning.WAYS


def write(tree: Tree) -> Source | Unsupported:
    """Text that states links and connectors; each call makes the system that it asks."""
    if tree.asked == "turns":
        return turns.source("import exudyn as exu", "import exudyn.utilities as ut", *turning.IMPORTS)
    links: list[str] = []
    special: list[str] = []
    generic: list[str] = []
    springs: list[str] = []
    slots: list[tuple[Slot, ...]] = []
    nq = nv = 0
    for k, link in enumerate(tree.links):
        folded, (R_end, p_end) = series(link.joints)
        motions: list[_Step] = []
        stated: list[str] = []
        own: list[Slot] = []
        for number, (R, p, joint) in enumerate(folded):
            if joint.kind not in _CHARTS or joint.form or joint.mimics or any(joint.armature):
                return Unsupported(f"no connector for {joint.kind} {joint.form}".strip(), offered=False)
            if number and (np.any(p) or not np.array_equal(R, np.eye(3))):
                return Unsupported("a body between two joints in series has no mass", offered=False)
            parts = _steps(joint, nq, nv)
            for place, step in enumerate(parts):
                before = (plain(R), plain(p)) if not place else (plain(np.eye(3)), plain(np.zeros(3)))
                stated.append(f"({', '.join(before)}, {step.kind!r}, {plain(step.axis)}, {step.q}, {step.v})")
            size = {"ball": (4, 3), "free": (7, 6)}.get(joint.kind, (len(parts), len(parts)))
            own.append(Slot(_CHARTS[joint.kind], tuple(range(nq, nq + size[0])), tuple(range(nv, nv + size[1]))))
            nq, nv = nq + size[0], nv + size[1]
            motions += parts
        lossy = [joint for _, _, joint in folded if joint.stiffness or joint.damping]
        if lossy and (len(folded) > 1 or lossy[0].kind not in connectors.DAMPED):
            return Unsupported("no connector damps these motions", offered=False)
        native = _native(motions)
        if native is None:
            return Unsupported("no connector leaves these motions free", offered=False)
        stated.append(f"({plain(R_end)}, {plain(p_end)}, '', {plain(_Z)}, 0, 0)")
        c, mass = np.array(link.com), link.mass
        J = np.array(link.inertia) + mass * (c @ c * np.eye(3) - np.outer(c, c))
        moments = [J[0, 0], J[1, 1], J[2, 2], J[1, 2], J[0, 2], J[0, 1]]
        body = f"{mass!r}, {np.asarray(c).tolist()!r}, {[float(x) for x in moments]!r}"
        links.append(f"({link.parent}, [{', '.join(stated)}], {body})")
        slots.append(tuple(own))
        R, p = (folded[0][0], folded[0][1]) if folded else (np.eye(3), np.zeros(3))
        ends = (
            end_of(link.parent, R @ native.turned, p),
            end_of(k, R_end.T @ native.turned, -R_end.T @ p_end) if folded else end_of(k, R_end.T, -R_end.T @ p_end),
        )
        springs += [connectors.spring(joint, ends) for joint in lossy]
        if native.blocked == _FREE:
            continue
        blocked = f"{{'constrainedAxes': {native.blocked}}}"
        generic.append(connector("ObjectJointGeneric", ends, blocked))
        special.append(connector(native.special, ends) if native.special else generic[-1])
    if any(one.kind != "path" or len(one.ends) != 2 for one in tree.tendons):
        return Unsupported("springs run straight from point to point", offered=False)
    springs += [connectors.line(tree, one) for one in tree.tendons]
    lines = (
        "import numpy as np",
        "import exudyn as exu",
        "from exudyn import itemInterface as items",
        f"n, gravity = {nv}, {list(tree.gravity)!r}",
        f"links = [{', '.join(links)}]",
    )
    optional: dict[str, tuple[str, ...]] = {
        "springs": (f"springs = [{', '.join(springs)}]",),
        "special": (f"special = [{', '.join([*special, *springs])}]",),
        "generic": (f"generic = [{', '.join([*generic, *springs])}]",),
    }
    optional |= connectors.loops(tree)
    return Source((*lines, *(line for part in _NEEDED.values() for line in part)), tuple(slots), nq, nv, optional)


PLUGIN = SourcePlugin(
    name="exudyn-joints",
    package="exudyn",
    extra="exudyn",
    conventions=(
        Convention("coordinates", "six or seven of each body; here they follow from those of the joints"),
        Convention("joints", "conditions between two markers; equations of index 1 are solved outside of Exudyn"),
        Convention("inertia", "about the body's reference point, as xx, yy, zz, yz, xz, xy"),
        Convention("NodeRigidBodyEP", "Euler parameters (w, x, y, z), their unit length a condition of its own"),
        Convention("NodeRigidBodyRxyz", "R = Rx Ry Rz; rates of the angles"),
        Convention("NodeRigidBodyRotVecLG", "rotation vector; the velocity is the angular one, in the body"),
        Convention("universal joint", "ObjectJointGeneric that blocks the rotation about z: x before, y after"),
        Convention("armature", "none"),
    ),
    kinds={
        "revolute x": "ObjectJointRevoluteZ",
        "revolute y": "ObjectJointRevoluteZ",
        "revolute z": "ObjectJointRevoluteZ",
        "revolute oblique": "ObjectJointRevoluteZ",
        "prismatic": "ObjectJointPrismaticX",
        "prismatic oblique": "ObjectJointPrismaticX",
        "ball": "ObjectJointSpherical",
        "euler zyx": "ObjectJointSpherical",
        "euler xyz": "ObjectJointSpherical",
        "three hinges": "ObjectJointSpherical",
        "universal": "ObjectJointGeneric",
        "translation": "ObjectJointGeneric",
        "planar": "ObjectJointGeneric",
        "cylindrical": "ObjectJointGeneric",
        "two slides and a hinge": "ObjectJointGeneric",
        "slide and ball": "ObjectJointGeneric",
        "free": "a body without a joint",
        "free between links": "a body without a joint",
        "translation and euler zyx": "a body without a joint",
    },
    ways=WAYS,
    write=write,
    demands={
        "turns": "CreateRigidBody, rigidBodyUtilities, lieGroupBasics, connectors, loads, sensors, AddLidar",
        "dampers": "TorsionalSpringDamper, LinearSpringDamper, RigidBodySpringDamper",
        "springs": "TorsionalSpringDamper, LinearSpringDamper",
        "tendons": "SpringDamper",
    },
    constraints={
        "point": "ObjectJointSpherical",
        "weld": "ObjectJointGeneric",
        "path": "ObjectConnectorDistance",
    },
)
