"""The spanning tree of a stage's bodies: from the world, then from roots of articulations, then from what is left."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from symofros.description.usd.joints import UsdJoint

WORLD_PATH = ""


@dataclass(frozen=True)
class Edge:
    """A body with the joint that carries it.

    Attributes:
        parent: Path of the parent; "" for the world.
        child: Path of the body.
        joint: The joint; None of a root that none holds.
        is_reversed: Whether the joint's second body is the parent.
    """

    parent: str
    child: str
    joint: UsdJoint | None = None
    is_reversed: bool = False


def spanning_tree(
    bodies: Sequence[str], joints: Sequence[UsdJoint], fixed: Sequence[str], roots: Sequence[str]
) -> tuple[list[Edge], list[UsdJoint]]:
    """The edges of the tree, parents first, and the joints that close loops.

    Joints that are no part of an articulation, and those that keep distances, close loops wherever they stand.

    Args:
        bodies: Paths of the bodies, in the order of the stage.
        joints: The joints, in the order of the stage.
        fixed: Bodies that are part of the world.
        roots: Bodies from which articulations are counted.
    """
    at: dict[str, list[UsdJoint]] = {}
    for joint in joints:
        if joint.row["kind"] != "distance" and not joint.row["excluded"]:
            for end in joint.ends:
                at.setdefault(end, []).append(joint)
    edges: list[Edge] = []
    reached, used = {WORLD_PATH, *fixed}, set[str]()

    def grow(start: Sequence[str]) -> None:
        pending = list(reversed(start))
        while pending:
            body = pending.pop()
            reached_here = []
            for joint in at.get(body, ()):
                is_reversed = joint.ends[1] == body
                other = joint.ends[0] if is_reversed else joint.ends[1]
                if other not in reached:
                    reached.add(other)
                    used.add(joint.name)
                    edges.append(Edge(body, other, joint, is_reversed))
                    reached_here.append(other)
            pending += reversed(reached_here)

    edges += [Edge(WORLD_PATH, body) for body in bodies if body in set(fixed)]
    grow([WORLD_PATH, *fixed])
    for root in (*roots, *bodies):
        if root not in reached:
            reached.add(root)
            edges.append(Edge(WORLD_PATH, root))
            grow([root])
    return edges, [joint for joint in joints if joint.name not in used]
