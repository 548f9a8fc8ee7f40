"""Exudyn's connectors as text: springs and dampers of joints and between points, and what closes loops."""

from __future__ import annotations

import numpy as np

from ...interface import Array, Constraint, Joint, Tendon, Tree


def plain(values: object) -> str:
    """Source text of an array."""
    return f"np.array({np.asarray(values, dtype=float).tolist()!r})"


def end_of(link: int, R: Array, p: Array) -> str:
    """Where a connector stands on a link."""
    return f"({link}, {plain(R)}, {plain(p)})"


def connector(name: str, ends: tuple[str, str], arguments: str = "{}") -> str:
    """A connector of a class of Exudyn's."""
    return f"({name!r}, [{', '.join(ends)}], {arguments})"


# Joints whose losses a connector has; those of springs are of one coordinate.
DAMPED = ("revolute", "prismatic", "ball", "free")


def spring(joint: Joint, ends: tuple[str, str]) -> str:
    """The spring and damper of a joint, whose frame is turned as `_Native.turned` says; of balls a damper alone."""
    numbers = {"stiffness": joint.stiffness, "damping": joint.damping, "offset": joint.rest}
    if joint.kind in ("revolute", "prismatic"):
        name = "Torsional" if joint.kind == "revolute" else "Linear"
        return connector(f"ObjectConnector{name}SpringDamper", ends, repr(numbers))
    parts = [joint.damping * (joint.kind == "free")] * 3 + [joint.damping] * 3
    return connector("ObjectConnectorRigidBodySpringDamper", ends, f"{{'damping': np.diag({parts}).tolist()}}")


def line(tree: Tree, one: Tendon) -> str:
    """The spring and damper between two points."""
    ids = {"": -1} | {link.name: k for k, link in enumerate(tree.links)}
    first, second = (end_of(ids[end.link], np.eye(3), np.array(end.p)) for end in one.ends)
    numbers = {"referenceLength": one.rest, "stiffness": one.stiffness, "damping": one.damping}
    return connector("ObjectConnectorSpringDamper", (first, second), repr(numbers))


def loops(tree: Tree) -> dict[str, tuple[str, ...]]:
    """Connectors of a tree's constraints; those that Exudyn has no other connector for are of the generic kind."""
    ids = {"": -1} | {link.name: k for k, link in enumerate(tree.links)}
    made: list[str] = []
    generic: list[str] = []
    for one in tree.constraints:
        if one.kind == "path" and len(one.ends) != 2:
            return {}
        ends = tuple(end_of(ids[end.link], np.array(end.R), np.array(end.p)) for end in one.ends)
        assert len(ends) == 2
        blocked = f"{{'constrainedAxes': {[1, 1, 1, *[int(one.kind == 'weld')] * 3]}}}"
        joint = connector("ObjectJointGeneric", ends, blocked)
        if one.kind == "path":
            made.append(connector("ObjectConnectorDistance", ends, f"{{'distance': {_distance(tree, one)!r}}}"))
            continue
        made.append(connector("ObjectJointSpherical", ends) if one.kind == "point" else joint)
        generic.append(joint)
    stated: dict[str, tuple[str, ...]] = {"loops": (f"loops = [{', '.join(made)}]",)}
    if len(generic) == len(made):
        stated["loops_generic"] = (f"loops_generic = [{', '.join(generic)}]",)
    # The torque of a joint that blocks all rotations need not be one, as its documentation says.
    if all(one.kind == "point" for one in tree.constraints):
        firsts = ", ".join(f"({ids[one.ends[0].link]}, {plain(one.ends[0].R)})" for one in tree.constraints)
        stated["points"] = (f"points = [{firsts}]",)
    return stated


def _distance(tree: Tree, one: Constraint) -> float:
    """Distance of a path's two points with all coordinates zero."""
    poses: dict[str, tuple[Array, Array]] = {"": (np.eye(3), np.zeros(3))}
    for link in tree.links:
        R, p = poses[tree.links[link.parent].name if link.parent >= 0 else ""]
        for joint in link.joints:
            R, p = R @ np.array(joint.R), p + R @ np.array(joint.p)
        poses[link.name] = (R, p)
    first, second = (poses[end.link][1] + poses[end.link][0] @ np.array(end.p) for end in one.ends)
    return float(np.linalg.norm(first - second))
