"""From the spanning tree to its motion: each link's frame in its parent's, and its partial velocities.

A link's own frame L shares its origin with the body frame B, but is turned so that the joint axis lies along a
coordinate axis: a joint about any constant axis then costs what a joint about z costs (docs/theory/rigid.md, 2.3).
"""

from __future__ import annotations

from dataclasses import dataclass

from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Vec3
from symofros.kinematics.joint import Column, across_joint
from symofros.kinematics.lowering import Lowering
from symofros.kinematics.rotations import Turn, constant_turn, frame_with_axis, snapped, unit_vector
from symofros.topology.tree import BASE, SpanningTree


@dataclass(frozen=True)
class MovingLink:
    """One link's motion on its parent A (a link, or the base).

    Attributes:
        name: Of the link's body.
        parent: Index of the parent, or BASE.
        R_AL: Rotation from link to parent.
        p_AL: From Ao to Lo, in A [m].
        columns: Partial velocities of L in A, in L.
        v: Index of the first speed.
        R_LB: The body frame in the link frame.
        fixed_origin: Whether Lo is fixed in A, so that mass at Lo may be booked on A.
        axis: The coordinate axis of L that the joint turns about; None if it is not a turn about one.
    """

    name: str
    parent: int
    R_AL: Turn
    p_AL: Vec3
    columns: tuple[Column, ...]
    v: int
    R_LB: Mat3
    fixed_origin: bool
    axis: int | None


@dataclass(frozen=True)
class Motion:
    """The whole tree in motion, in one graph.

    Attributes:
        g: The graph.
        lowering: Values -> edges.
        tree: What it was made from.
        links: Parents before children.
        nv: Number of speeds.
    """

    g: Graph
    lowering: Lowering
    tree: SpanningTree
    links: tuple[MovingLink, ...]
    nv: int

    def columns(self) -> list[tuple[int, Column]]:
        """Each speed's link and partial velocity, in the order of v."""
        return [(i, column) for i, link in enumerate(self.links) for column in link.columns]

    def in_link(self, index: int) -> Mat3:
        """R_LB of a link; the identity for the base."""
        return Mat3.identity(self.g) if index == BASE else self.links[index].R_LB


def set_in_motion(g: Graph, tree: SpanningTree) -> Motion:
    """Lower a tree's joints and offsets into a graph.

    Args:
        g: Where the operations go.
        tree: Checked and numbered.
    """
    lowering = Lowering(g, tree.coordinates)
    links: list[MovingLink] = []
    for link in tree.links:
        R_LB_parent = Mat3.identity(g) if link.parent == BASE else links[link.parent].R_LB
        R_AP, p_AP = lowering.placement(link.placement, R_LB_parent)
        # P and D are turned alike by A, so that the axis lies along a coordinate axis of both.
        A, axis, k, negative = Mat3.identity(g), Vec3.unit(g, 2), 2, False
        if link.joint.kind in ("revolute", "continuous", "prismatic"):
            axis = unit_vector(lowering.vector(link.joint.axis))
            aligned = frame_with_axis(axis)
            if aligned is not None:
                A, k, negative = aligned
                axis = -Vec3.unit(g, k) if negative else Vec3.unit(g, k)
        is_turn = link.joint.kind in ("revolute", "continuous")
        along = k if axis.is_constant else None
        start, size = link.q
        q = tuple(g.input("q", i) for i in range(start, start + size))
        across = across_joint(g, link.joint, q, axis, along, negative)
        constant = constant_turn(snapped(R_AP @ A))
        links.append(MovingLink(
            link.name, link.parent, constant @ across.R_PD, p_AP + constant.apply(across.p_PD), across.columns,
            link.v[0], A.T, across.p_PD.is_zero, along if is_turn else None,
        ))  # fmt: skip
    return Motion(g, lowering, tree, tuple(links), len(tree.coordinates.v))
