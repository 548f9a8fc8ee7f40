"""Kinematics of the spanning tree: each link's frame in its parent's, and its partial velocities.

A link's own frame L shares its origin with the body frame B, but is turned so that the joint axis lies along a
coordinate axis: a joint about any constant axis then costs what a joint about z costs (docs/theory/rigid.md, 2.3).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Vec3
from symofros.mechanics.beams.theories import theory_of
from symofros.mechanics.beams.theory import BeamEquations
from symofros.mechanics.kinematics.joint import Axis, across_joint
from symofros.mechanics.kinematics.lowering import Lowering
from symofros.mechanics.spatial.across import PartialVelocity
from symofros.mechanics.spatial.rotations import (
    RotationProduct,
    constant_rotation,
    frame_with_axis,
    snapped,
    unit_vector,
)
from symofros.mechanics.topology.tree import BASE, Link, SpanningTree


@dataclass(frozen=True)
class MovingLink:
    """One link's motion on its parent A (a link, or the base).

    Attributes:
        name: Name of the link's body.
        parent: Index of the parent, or BASE.
        R_AL: Rotation from link to parent.
        p_AL: Position of Lo from Ao, in A [m].
        partial_velocities: Partial velocities of L in A, in L, one a speed.
        speeds: Edges of those speeds.
        rates: Edge of each speed's rate where the motion is prescribed; None where it is free.
        first_speed: Index of the first speed in v, where the motion is free.
        R_LB: The body frame in the link frame.
        fixed_origin: Whether Lo is fixed in A, so that mass at Lo may be booked on A.
        axis: The coordinate axis of L that the joint turns about; None if it is not a turn about one.
        tip: Index of the link at the tip of a beam of which this is a section before the tip: the speeds are that
            link's; None of any other link.
    """

    name: str
    parent: int
    R_AL: RotationProduct
    p_AL: Vec3
    partial_velocities: tuple[PartialVelocity, ...]
    speeds: tuple[Edge, ...]
    rates: tuple[Edge, ...] | None
    first_speed: int
    R_LB: Mat3
    fixed_origin: bool
    axis: int | None
    tip: int | None = None

    @property
    def own_speeds(self) -> range:
        """Indices in v of the speeds that are this link's own; none where the motion is prescribed."""
        count = len(self.free_partial_velocities) if self.tip is None else 0
        return range(self.first_speed, self.first_speed + count)

    @property
    def free_partial_velocities(self) -> tuple[PartialVelocity, ...]:
        """Partial velocities of the speeds that are among v; none where the motion is prescribed."""
        return self.partial_velocities if self.rates is None else ()

    def speed_rates(self, v_rate: Sequence[Edge]) -> Sequence[Edge]:
        """Rates of the speeds: prescribed, or this link's part of v'."""
        return (
            v_rate[self.first_speed : self.first_speed + len(self.partial_velocities)]
            if self.rates is None
            else self.rates
        )


@dataclass(frozen=True)
class MovingBeam:
    """A beam in the tree.

    Attributes:
        root: Index of the link at its root.
        tip: Index of the link at its tip, which its elastic coordinates move; None for a rigid beam.
        stations: Indices of the links at its stations before the tip, which the same coordinates move.
        equations: What the equations of motion need of it, by its theory.
    """

    root: int
    tip: int | None
    stations: tuple[int, ...]
    equations: BeamEquations


@dataclass(frozen=True)
class TreeKinematics:
    """Kinematics of the whole tree, in one graph.

    Attributes:
        g: The graph.
        lowering: Values -> edges.
        tree: The spanning tree.
        links: Motion of each link on its parent, parents before children.
        nv: Number of speeds.
        beams: The beams.
    """

    g: Graph
    lowering: Lowering
    tree: SpanningTree
    links: tuple[MovingLink, ...]
    nv: int
    beams: tuple[MovingBeam, ...]

    @property
    def states(self) -> range:
        """Indices of the speeds that are states of forces: the last ones, which move no link and have unit inertia."""
        return range(self.nv - len(self.tree.coordinates.states), self.nv)

    def in_link(self, index: int) -> Mat3:
        """R_LB of a link; the identity for the base."""
        return Mat3.identity(self.g) if index == BASE else self.links[index].R_LB


def speeds_by_path(kinematics: TreeKinematics) -> list[list[int]]:
    """Indices of all speeds by paths to the base: the momenta of one path cross the same joints.

    The longest path has every speed on its way, each branch those that no path before it has.

    Returns:
        One list a path, outermost speed first.
    """
    depth: list[int] = []
    for link in kinematics.links:
        depth.append(len(link.own_speeds) + (depth[link.parent] if link.parent != BASE else 0))
    visited: set[int] = set()
    paths: list[list[int]] = []
    for i in sorted(range(len(kinematics.links)), key=lambda i: -depth[i]):
        path: list[int] = []
        while i != BASE and i not in visited:
            visited.add(i)
            link = kinematics.links[i]
            path += reversed(link.own_speeds)
            i = link.parent
        if path:
            paths.append(path)
    return paths


def tree_kinematics(g: Graph, tree: SpanningTree, deflected_tips: bool = False) -> TreeKinematics:
    """Lower a tree's joints, beams and offsets into a graph.

    Args:
        g: Graph that receives the operations.
        tree: Checked and numbered.
        deflected_tips: Whether every tip is where its deflection puts it; otherwise the tips of beams of zeroth order
            stay at their undeformed places, as their equations of motion take it.
    """
    lowering = Lowering(g, tree.coordinates)
    links: list[MovingLink] = []
    beams: list[MovingBeam] = []
    for i, link in enumerate(tree.links):
        R_AB = Mat3.identity(g) if link.parent == BASE else links[link.parent].R_LB
        R_AP, p_AP = lowering.placement(link.placement, R_AB)
        # P and D are both turned by R_BL, so that the axis lies along a coordinate axis of both.
        R_BL, axis = _aligned(lowering, link)
        q, speeds = lowering.coordinates_of(link.joint), lowering.speeds_of(link.joint)
        rates = lowering.rates_of(link.joint) if link.joint.prescribed else None
        if link.beam is not None:
            elastic = tuple(map(lowering.symbol, link.beam.coordinates))
            tip = i + 1 if elastic else None
            stations = tuple(k for k, x in enumerate(tree.links) if x.station is not None and x.station.tip == tip)
            equations = theory_of(link.beam).equations(g, lowering.value, elastic, R_BL.T)
            beams.append(MovingBeam(i, tip, stations, equations))
        first_speed = link.v[0]
        if not link.is_section:
            across = across_joint(lowering, link.joint, q, speeds, axis)
        else:
            if link.station is not None:
                joint, first_speed = tree.links[link.station.tip].joint, links[link.station.tip].first_speed
                speeds = lowering.speeds_of(joint)
            xi = 1.0 if link.station is None else link.station.xi
            across = beams[-1].equations.across(xi, speeds, deflected_tips)
        constant = constant_rotation(snapped(R_AP @ R_BL))
        links.append(
            MovingLink(
                name=link.name,
                parent=link.parent,
                R_AL=constant @ across.R_PD,
                p_AL=p_AP + constant.apply(across.p_PD),
                partial_velocities=across.partial_velocities,
                speeds=speeds,
                rates=rates,
                first_speed=first_speed,
                R_LB=R_BL.T,
                fixed_origin=across.p_PD.is_zero,
                axis=axis.k if link.joint.traits.turns_about else None,
                tip=None if link.station is None else link.station.tip,
            )
        )
    return TreeKinematics(g, lowering, tree, tuple(links), len(tree.coordinates.v), tuple(beams))


def _aligned(lowering: Lowering, link: Link) -> tuple[Mat3, Axis]:
    """R_BL of a link's frame, and the joint's axis seen in the turned frames."""
    g, joint = lowering.g, link.joint
    if "axis" not in joint.traits.entries:
        return Mat3.identity(g), Axis(Vec3.unit(g, 2), 2, False)
    direction = unit_vector(lowering.vector(joint.axis))
    aligned = frame_with_axis(direction) if joint.traits.aligned else None
    if aligned is None:
        return Mat3.identity(g), Axis(direction, None, False)
    R_BL, k, negative = aligned
    return R_BL, Axis(-Vec3.unit(g, k) if negative else Vec3.unit(g, k), k, negative)
