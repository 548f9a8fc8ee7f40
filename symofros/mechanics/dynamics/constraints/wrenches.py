"""Forces and moments of a constraint on the bodies it joins (docs/theory/constraints.md, eq. 14)."""

from __future__ import annotations

from collections.abc import Sequence

from symofros.description.constraints import BETWEEN_FRAMES, BY_FORMULA
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Vec3
from symofros.mechanics.dynamics.applied.loads import at_frame
from symofros.mechanics.dynamics.constraints.rows import Row
from symofros.mechanics.kinematics.frames import FrameKinematics
from symofros.mechanics.kinematics.links import TreeKinematics
from symofros.mechanics.spatial.wrench import Wrench, no_wrench
from symofros.mechanics.topology.tree import BASE, frame_of

# Force and moment about a frame's origin, in world axes (6).
FrameWrench = tuple[Edge, ...]


def closure_wrenches(frames: FrameKinematics, rows: Sequence[Row]) -> tuple[list[FrameWrench], list[FrameWrench]]:
    """The wrench of each constraint on its second frame and on its first, each about that frame's origin.

    The first frame of what binds a single body is the world.

    Args:
        frames: Kinematics of the tree's frames.
        rows: Rows of all constraints, in order.
    """
    tree, g = frames.kinematics.tree, frames.g
    on_second, on_first, at = [], [], 0
    for constraint in tree.system.constraints:
        count = len(constraint.conditions)
        own = [(g.input("lam", at + i), row) for i, row in enumerate(rows[at : at + count])]
        at += count
        if isinstance(constraint, BY_FORMULA):
            continue
        if isinstance(constraint, BETWEEN_FRAMES):
            first, second = (frame_of(tree, *anchor) for anchor in (constraint.first, constraint.second))
            on_first.append(_sum(g, own, first.qualified))
        else:
            second = frame_of(tree, *constraint.anchor)
            on_first.append(_on_ground(g, _sum(g, own, second.qualified), frames.pose(second).p_WF))
        on_second.append(_sum(g, own, second.qualified))
    return on_second, on_first


def wrenches_on_links(kinematics: TreeKinematics, frames: FrameKinematics, rows: Sequence[Row]) -> list[Wrench]:
    """The wrench of all constraints on each link, about its origin, in its frame.

    Args:
        kinematics: Kinematics of the tree.
        frames: Kinematics of the frames that constraints join.
        rows: Rows of all constraints, in order.
    """
    tree, g = kinematics.tree, kinematics.g
    total = [no_wrench(g) for _ in kinematics.links]
    acting = [item for item in tree.system.constraints if not isinstance(item, BY_FORMULA)]
    for constraint, *sides in zip(acting, *closure_wrenches(frames, rows), strict=True):
        # The first side of what binds a single body is the ground.
        if isinstance(constraint, BETWEEN_FRAMES):
            anchors = [constraint.second, constraint.first]
        else:
            anchors = [constraint.anchor]
        for anchor, (fx, fy, fz, nx, ny, nz) in zip(anchors, sides, strict=False):
            frame = frame_of(tree, *anchor)
            if frame.link != BASE:
                wrench = at_frame(kinematics, frames, frame, Vec3(g, fx, fy, fz), Vec3(g, nx, ny, nz))
                total[frame.link] = total[frame.link] + wrench
    return total


def _sum(g: Graph, own: Sequence[tuple[Edge, Row]], frame: str) -> FrameWrench:
    """The levers on one frame, by their multipliers."""
    force, moment = Vec3(g), Vec3(g)
    for lam, row in own:
        for lever in row.levers:
            if lever.frame == frame:
                by = lam if lever.sign > 0 else -lam
                force = force if lever.force is None else force + lever.force.scaled(by)
                moment = moment if lever.moment is None else moment + lever.moment.scaled(by)
    return (*force, *moment)


def _on_ground(g: Graph, wrench: FrameWrench, p: Vec3) -> FrameWrench:
    """The reaction of a wrench at p, about the origin of the world."""
    force, moment = Vec3(g, *wrench[:3]), Vec3(g, *wrench[3:])
    return (*-force, *-(moment + p.cross(force)))
