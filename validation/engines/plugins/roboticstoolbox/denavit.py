"""Robots by Denavit and Hartenberg's parameters, and what is asked of arms."""

from __future__ import annotations

from dataclasses import replace
from math import atan2

import numpy as np

from ...interface import Array, Joint, Link, Slot, Tree, Unsupported
from ...tree import BASE, GRIPPER, MODIFIED
from ...truth.arms import AT, BURDEN
from ..writing.source import Source, Way, ways_of

_POSES = (
    "every = [X.A for X in robot.fkine_all(q)][1 : len(links) + 1]\n"
    "value = [[*X[:3, 3], *X[:3, :3].flat] for X in every]"
)
# About the base's origin, along its axes.
_FROM_BASE = "value = robot.base.inv().Ad().T @ own"
# Ways that only robots by parameters have.
DENAVIT_WAYS = ways_of(f"""
== end_loads_local | rne with a wrench | value = robot.rne(q, 0 * v, 0 * v, fext=tau) - robot.rne(q, 0 * v, 0 * v)
== end_loads_local:rne_python | rne_python with a wrench
value = robot.rne_python(q, 0 * v, 0 * v, fext=tau) - robot.rne_python(q, 0 * v, 0 * v)
== base_wrench | rne, base_wrench | _, own = robot.rne(q, v, a, base_wrench=True)\n{_FROM_BASE}
== base_wrench:rne_python | rne_python, base_wrench | _, own = robot.rne_python(q, v, a, base_wrench=True)\n{_FROM_BASE}
== gravity:argument | rne with gravity | value = robot.rne(q, 0 * v, 0 * v, gravity=robot.gravity)
== inverse_dynamics:rne_python | rne_python | value = robot.rne_python(q, v, a)
== bias:rne_python | rne_python | value = robot.rne_python(q, v, 0 * v)
== link_poses:fkine_all of parameters | DHRobot.fkine_all | {_POSES}
== link_poses:A | DHRobot.A
every = [robot.base.A @ robot.A([0, k], q).A for k in range(len(links))]
value = [[*X[:3, 3], *X[:3, :3].flat] for X in every]
""")
_FLAT = "X = {of}.A\nvalue = [*X[:3, 3], *X[:3, :3].flat]"
ARM_WAYS = {
    "end_pose": Way("fkine", _FLAT.format(of="robot.fkine(q)")),
    "end_jacobian": Way("jacob0", "value = robot.jacob0(q)"),
    "end_jacobian_local": Way("jacobe", "value = robot.jacobe(q)"),
    "end_jacobian_rate": Way("jacob0_dot", "value = robot.jacob0_dot(q, v)"),
    "end_jacobian_dq": Way("hessian0", "value = np.transpose(robot.hessian0(q), (1, 2, 0))"),
    "end_jacobian_of_rpy": Way("jacob0_analytical", "value = robot.jacob0_analytical(q, representation='rpy/zyx')"),
    "manipulability": Way("manipulability", "value = [robot.manipulability(q)]"),
    "manipulability_dq": Way("jacobm", "value = np.ravel(robot.jacobm(q))"),
    "end_mass_matrix": Way("inertia_x", "value = robot.inertia_x(q, representation='rpy/zyx')"),
    "end_gravity": Way("gravload_x", "value = robot.gravload_x(q, representation='rpy/zyx')"),
    "inertia_forces": Way("itorque", "value = robot.itorque(q, a)"),
    "end_point_mass": Way("payload", f"robot.payload({BURDEN}, {list(AT)})\nvalue = robot.gravload(q)"),
}
WAYS = DENAVIT_WAYS | ARM_WAYS
_PLAIN = (
    *("mass_matrix", "coriolis_forces", "gravity", "inverse_dynamics", "bias", "forward_dynamics", "joint_limits"),
    *DENAVIT_WAYS,
)


def _angle(R: Array, axis: str) -> float | None:
    """Angle of a rotation about x or z; None of one about other axes."""
    i, j, k = (1, 2, 0) if axis == "x" else (0, 1, 2)
    return atan2(R[j, i], R[i, i]) if R[k, k] == 1.0 else None


def _arguments(joint: Joint, after: tuple[Joint, ...], is_modified: bool) -> tuple[float, float, float, float] | None:
    """Theta, d, a, alpha beside the joint's coordinate; None where a link has none."""
    R, p = np.array(joint.R), np.array(joint.p)
    if joint.axis != (0.0, 0.0, 1.0):
        return None
    if is_modified:
        alpha, theta = atan2(-R[1, 2], R[2, 2]), atan2(-R[0, 1], R[0, 0])
        d = p[2] / R[2, 2]
        # Placed as the parameters have it, and nothing after it.
        is_so = not after and R[0, 2] == 0.0 and abs(p[1] - d * R[1, 2]) < 1e-15
        return (theta, d, p[0], alpha) if is_so else None
    if len(after) != 1:
        return None
    about_z, about_x = _angle(R, "z"), _angle(np.array(after[0].R), "x")
    if about_z is None or about_x is None or np.any(p[:2]) or after[0].p[1]:
        return None
    return about_z, p[2] + after[0].p[2], after[0].p[0], about_x


def _link(link: Link, is_modified: bool) -> str | None:
    """The call that makes a link; None where it has no parameters."""
    moving, *after = link.joints
    arguments = _arguments(moving, tuple(after), is_modified) if moving.kind in ("revolute", "prismatic") else None
    if arguments is None:
        return None
    theta, d, a, alpha = arguments
    turns = moving.kind == "revolute"
    own = f"d={d!r}, offset={theta!r}" if turns else f"theta={theta!r}, offset={d!r}"
    motor = f", Jm={moving.armature[0]!r}, G=1" if any(moving.armature) else ""
    body = f"m={link.mass!r}, r={list(link.com)!r}, I=np.array({[*map(list, link.inertia)]!r}){motor}"
    name = f"{'Revolute' if turns else 'Prismatic'}{'M' if is_modified else ''}DH"
    return f"{name}({own}, a={a!r}, alpha={alpha!r}, {body})".replace("np.float64(", "(")


def without_tool(tree: Tree) -> tuple[tuple[Link, ...], Joint | None]:
    """The links of an arm, and its tool's placement."""
    if tree.asked == "arms" and tree.links[-1].joints[0].kind == "fixed":
        return tree.links[:-1], tree.links[-1].joints[0]
    return tree.links, None


def pose(joint: Joint) -> str:
    """The text of a placement."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = joint.R, joint.p
    return f"SE3(np.array({T.tolist()!r}), check=False)"


def write(tree: Tree) -> Source | Unsupported:
    """Text that builds a chain by its parameters."""
    links, tool = without_tool(tree)
    first, *rest = links
    base = first.joints[0] if first.joints[0].kind == "fixed" else None
    links = (replace(first, joints=first.joints[1:] if base else first.joints), *rest)
    calls = [_link(one, tree.stated == MODIFIED) for one in links]
    if any(one.parent != k - 1 for k, one in enumerate(links)) or None in calls:
        return Unsupported("no such parameters", offered=False)
    setup = (
        "import numpy as np",
        "import roboticstoolbox as rtb",
        "from roboticstoolbox import PrismaticDH, PrismaticMDH, RevoluteDH, RevoluteMDH",
        "from spatialmath import SE3",
    )
    more = f", tool={pose(tool)}" if tool else ""
    more += f", base={pose(base)}" if base else ""
    robot = f"robot = rtb.DHRobot([{', '.join(filter(None, calls))}], gravity={list(tree.gravity)!r}{more})"
    slots = tuple(
        (Slot("angle" if one.joints[0].kind == "revolute" else "length", (k,), (k,)),) for k, one in enumerate(links)
    )
    names = [one.name for one in links]
    every = slots if tool is None else (*slots, ())
    return Source(setup, every, len(links), len(links), {"links": (f"links = {names!r}",)}, closing=(robot,))


def lacking(stated: str, ways: tuple[str, ...]) -> tuple[str, ...]:
    """Ways that a tree that is stated so has not."""
    if stated in ("", BASE, GRIPPER):
        return tuple(DENAVIT_WAYS)
    return tuple(way for way in ways if way not in (*_PLAIN, *ARM_WAYS))
