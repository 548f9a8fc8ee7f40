"""Robotics Toolbox for Python: robots as elementary transforms, Newton and Euler's recursion by spatial vectors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...interface import Array, Convention, Slot, Tree, Unsupported, Vector
from ...tree import BASE, DENAVIT, GRIPPER, MODIFIED
from ..loops import goals
from ..writing.numbering import numbered
from ..writing.source import NO_SOLUTION, Source, SourcePlugin, Way, ways_of
from . import denavit
from .denavit import lacking, pose, without_tool

# Before 1.1 robots of elementary transforms had a class of their own.
_ROBOT = "Robot = getattr(rtb, 'ERobot', None) if getattr(rtb.Robot, '__abstractmethods__', ()) else rtb.Robot"
_IMPORTS = ("import numpy as np", "import roboticstoolbox as rtb", "from roboticstoolbox import ET, ETS, Link", _ROBOT)
_CHARTS = {"revolute": "angle", "prismatic": "length"}
_LETTERS = {(1.0, 0.0, 0.0): "x", (0.0, 1.0, 0.0): "y", (0.0, 0.0, 1.0): "z"}
# In the axes of the link: those of the robot's frame are turned where the axis is oblique.
_IN_LINKS = """value = np.zeros((len(links), 6, robot.n))
for J, (name, (A, path)) in zip(value, links.items()):
    J[:, path] = np.kron(np.eye(2), A) @ robot."""
# Jacobians are along the axes of the robot's base.
_TURN = "turn = np.kron(np.eye(2), robot.base.R)\n"
# Its first index is the coordinate that is differentiated by.
_HESSIANS = f"""{_TURN}value = np.zeros((len(links), 6, robot.n, robot.n))
for H, (name, (_, path)) in zip(value, links.items()):
    H[np.ix_(range(6), path, path)] = np.tensordot(turn, robot."""
WAYS = (
    ways_of(f"""
== mass_matrix | inertia | value = robot.inertia(q)
== # The call takes the links from the robot: each call has a robot of its own.
== coriolis_forces | coriolis | value = robot.coriolis(q, v) @ v
== gravity | gravload | value = robot.gravload(q)
== inverse_dynamics | rne | value = robot.rne(q, v, a)
== bias | rne | value = robot.rne(q, v, np.zeros(len(v)))
== forward_dynamics | accel | value = robot.accel(q, v, tau)
== joint_limits | qlim | value = np.transpose(robot.qlim)
== link_poses | fkine
T = [robot.fkine(q, end=name).A for name in links]
value = [[*X[:3, 3], *(X[:3, :3] @ np.transpose(A)).flat] for X, (A, _) in zip(T, links.values())]
== link_poses:fkine_all | fkine_all
every = robot.fkine_all(q)
T = [every[robot.link_dict[name].number].A for name in links]
value = [[*X[:3, 3], *(X[:3, :3] @ np.transpose(A)).flat] for X, (A, _) in zip(T, links.values())]
== link_jacobians | jacob0
{_TURN}value = np.zeros((len(links), 6, robot.n))
for J, (name, (_, path)) in zip(value, links.items()):
    J[:, path] = turn @ robot.jacob0(q, end=name)
== link_jacobians:ETS | ETS.jacob0
{_TURN}value = np.zeros((len(links), 6, robot.n))
for J, (name, (_, path)) in zip(value, links.items()):
    J[:, path] = turn @ robot.ets(end=name).jacob0(q[path])
== jacobian_local | jacobe | {_IN_LINKS}jacobe(q, end=name)
== jacobian_local:ETS | ETS.jacobe | {_IN_LINKS}ets(end=name).jacobe(q[path])
== jacobian_dq_aligned | hessian0 | {_HESSIANS}hessian0(q, end=name), (1, 1)).transpose(0, 2, 1)
== jacobian_dq_aligned:ETS | ETS.hessian0 | {_HESSIANS}ets(end=name).hessian0(q[path]), (1, 1)).transpose(0, 2, 1)
""")
    | denavit.WAYS
)
# Rows of a trajectory, of which the second is what is asked.
_MANY = "Q, V, A, F = (np.stack([x / 2, x, 2 * x]) for x in (q, v, a, tau))\n"
# Of one joint rows are taken for joints.
_SECOND = f"""{_MANY}T = []
for name, (_, path) in links.items(): T.append(({{of}}).A[1] if {{n}} > 1 else robot.fkine(q, end=name).A)
value = [[*X[:3, 3], *(X[:3, :3] @ np.transpose(A)).flat] for X, (A, _) in zip(T, links.values())]"""
WAYS |= {
    f"{name}:trajectory": Way(f"{native} of a trajectory", f"{_MANY}value = robot.{native}({rows})[1]")
    for name, native, rows in (
        ("mass_matrix", "inertia", "Q"),
        ("gravity", "gravload", "Q"),
        ("inverse_dynamics", "rne", "Q, V, A"),
        ("forward_dynamics", "accel", "Q, V, F"),
        ("inertia_forces", "itorque", "Q, A"),
    )
}
WAYS |= ways_of(f"""
== link_poses:trajectory | fkine of a trajectory | {_SECOND.format(n="robot.n", of="robot.fkine(Q, end=name)")}
== link_poses:ETS, trajectory | ETS.fkine of a trajectory
{_SECOND.format(n="len(path)", of="robot.base * robot.ets(end=name).fkine(Q[:, path])")}
""")


_AGAINST = {(-x, -y, -z): letter for (x, y, z), letter in _LETTERS.items()}


def _step(kind: str, axis: Vector, place: int) -> str:
    """The elementary transform of a joint; one against an axis is flipped."""
    letter, flip = _LETTERS.get(axis, _AGAINST.get(axis, "z")), ", flip=True" if axis in _AGAINST else ""
    return f"ET.{'R' if kind == 'revolute' else 't'}{letter}(jindex={place}{flip})"


def _turned(axis: Vector) -> Array:
    """A rotation whose third column is the axis; the identity for axes that elementary transforms have."""
    if axis in _LETTERS or axis in _AGAINST:
        return np.eye(3)
    w = np.array(axis)
    u = np.cross(w, np.eye(3)[int(np.argmin(np.abs(w)))])
    u /= np.linalg.norm(u)
    return np.stack([u, np.cross(w, u), w], axis=1)


def _symmetric(matrix: Array) -> Array:
    """A matrix made symmetric, off by roundings alone: links with an asymmetric inertia are refused."""
    return np.asarray((matrix + matrix.T) / 2.0)


def write(tree: Tree) -> Source | Unsupported:
    """Text that builds a tree; where an axis is oblique, the link's frame is turned so that it is z."""
    if tree.stated in (DENAVIT, MODIFIED):
        made = denavit.write(tree)
        return made if isinstance(made, Unsupported) else replace(made, lacks=lacking(tree.stated, tuple(WAYS)))
    bodies, tool = without_tool(tree)
    lines: list[str] = []
    # For each link: variable, joints on its path, turn of its frame.
    ends: list[str] = []
    paths: list[list[int]] = []
    slots: list[tuple[Slot, ...]] = []
    turns: list[Array] = []
    count = 0
    for k, link in enumerate(bodies):
        own: list[Slot] = []
        before, turn = ("None", np.eye(3)) if link.parent < 0 else (ends[link.parent], turns[link.parent])
        for place, joint in enumerate(link.joints):
            last = place == len(link.joints) - 1
            title = link.name if last else f"{link.name}_{place}"
            T = np.eye(4)
            # The base has what is before the first joint.
            if tree.stated != BASE or link.parent >= 0 or place:
                T[:3, :3], T[:3, 3] = turn.T @ joint.R, turn.T @ joint.p
            turn = np.eye(3)
            moves = motor = ""
            if joint.kind != "fixed":
                if joint.kind not in ("revolute", "prismatic") or joint.form or joint.mimics:
                    return Unsupported(f"no elementary transform for {joint.kind} {joint.form}".strip(), offered=False)
                turn = _turned(joint.axis)
                T[:3, :3] = T[:3, :3] @ turn
                moves = _step(joint.kind, joint.axis, count)
                own.append(Slot("angle" if joint.kind == "revolute" else "length", (count,), (count,)))
                count += 1
                if any(joint.armature):
                    motor = f", Jm={joint.armature[0]!r}, G=1"
            inertia = ""
            if last:
                com, moments = (turn.T @ link.com).tolist(), _symmetric(turn.T @ link.inertia @ turn).tolist()
                inertia = f", m={link.mass!r}, r={com!r}, I=np.array({moments!r})"
            name = f"l{k}_{place}"
            placed = f"ET.SE3(np.array({T.tolist()!r}))" if not moves or not np.array_equal(T, np.eye(4)) else ""
            steps = ", ".join(filter(None, (placed, moves)))
            lines.append(f"{name} = Link(ETS([{steps}]), name={title!r}, parent={before}{inertia}{motor})")
            before = name
        paths.append([*([] if link.parent < 0 else paths[link.parent]), *(slot.v[0] for slot in own)])
        slots.append(tuple(own))
        ends.append(before)
        turns.append(turn)
    every = ", ".join(line.split(" =")[0] for line in lines)
    more = f", base={pose(tree.links[0].joints[0])}" if tree.stated == BASE else ""
    more += f", tool={pose(tool)}" if tool else ""
    held = next((k for k, link in enumerate(bodies) if link.joints[0].kind == "fixed"), None)
    more += f", gripper_links=[l{held}_0]" if tree.stated == GRIPPER and held is not None else ""
    robot = f"robot = Robot([{every}], gravity={list(tree.gravity)!r}{more})"
    imports = ("from spatialmath import SE3",) if more else ()
    setup = (*_IMPORTS, *imports)
    slots += [()] if tool else []
    # Turn of each link's frame, and the joints that move it.
    pairs = zip(bodies, turns, paths, strict=True)
    links = f"links = {{{', '.join(f'{link.name!r}: ({turn.tolist()!r}, {path})' for link, turn, path in pairs)}}}"
    return Source(setup, tuple(slots), count, count, {"links": (links,)}, lacking(tree.stated, ()), (*lines, robot))


def write_reading(tree: Tree, form: str, text: str) -> Source | Unsupported:
    """Text that has its reader of URDF read a file."""
    charts = {(kind, shape): chart for kind, chart in _CHARTS.items() for shape in ("", "unbounded")}
    made = Unsupported("joints that mimic are independent", offered=False) if _mimics(tree) else numbered(tree, charts)
    if isinstance(made, Unsupported):
        return made
    slots, nq, nv = made
    paths: list[list[int]] = []
    for link, own in zip(tree.links, slots, strict=True):
        paths.append([*([] if link.parent < 0 else paths[link.parent]), *(slot.v[0] for slot in own)])
    setup = (
        "import io",
        "import numpy as np",
        "import roboticstoolbox as rtb",
        _ROBOT,
        "from roboticstoolbox.models.URDF.URDFRobot import URDF_file",
        f"TEXT = {text!r}",
    )
    names = {link.name: (np.eye(3).tolist(), path) for link, path in zip(tree.links, paths, strict=True)}
    robot = f"robot = Robot(URDF_file(io.StringIO(TEXT))[0], gravity={list(tree.gravity)!r})"
    return Source(setup, slots, nq, nv, {"links": (f"links = {names!r}",)}, lacking("", ()), (robot,))


def _mimics(tree: Tree) -> bool:
    return any(joint.mimics for link in tree.links for joint in link.joints)


PLUGIN = SourcePlugin(
    name="roboticstoolbox",
    package="roboticstoolbox-python",
    extra="symofros[engine-roboticstoolbox]",
    conventions=(
        Convention("axes", "x, y, z of the joint's frame; others by turning the frame"),
        Convention("Jacobians", "columns of the path to the link only"),
        Convention("coriolis", "a matrix C with C v = h - g"),
        Convention("armature", "motor inertia Jm, times G^2"),
        Convention("gravity", "acceleration of gravity, as its name says (since 1.0; before, its negative)"),
        Convention("Jacobians of a robot with a base", "along the base's axes; of a DHRobot along the world's"),
        Convention(
            "fext of rne", "what the last link exerts, at its frame, along its axes; the tool has no part in it"
        ),
        Convention("floating base", "none"),
    ),
    kinds={
        "revolute x": "ET.Rx",
        "revolute y": "ET.Ry",
        "revolute z": "ET.Rz",
        "prismatic": "ET.tx",
    },
    ways=WAYS | goals.ROBOTICS_TOOLBOX,
    demands={
        BASE: "base",
        DENAVIT: "DHRobot of RevoluteDH, PrismaticDH",
        MODIFIED: "DHRobot of RevoluteMDH, PrismaticMDH",
        GRIPPER: "gripper_links",
        "arms": "tool",
        "goals": "ikine_LM, ik_LM",
    },
    write=write,
    refusals=(NO_SOLUTION,),
    formats=("urdf",),
    write_reading=write_reading,
)
