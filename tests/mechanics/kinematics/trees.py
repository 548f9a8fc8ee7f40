"""Random trees with their kinematics in one graph, evaluated in NumPy at random states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np

import symofros as sf
from reference_models.rigid.random_tree import MORE_KINDS, random_tree
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import evaluate_edges, needed_nodes
from symofros.expr.program import Program
from symofros.mechanics.dynamics.applied.forces import coordinate_rates
from symofros.mechanics.kinematics.frames import FrameKinematics
from symofros.mechanics.kinematics.links import tree_kinematics
from symofros.mechanics.topology.coordinates import coordinate_names
from symofros.mechanics.topology.tree import NamedFrame, SpanningTree, build_tree

SEEDS = range(4)
N_STATES = 3


def every_third_prescribed(system: sf.System) -> sf.System:
    """The system with the motion of every third moving body stated by inputs."""
    moving = [body for body in system.bodies if body.joint is not None and body.joint.kind != "fixed"]
    driven = {body.name for body in moving[1::3]}
    bodies = [
        replace(body, joint=replace(body.joint, prescribed=True, actuated=False)) if body.name in driven else body
        for body in system.bodies
    ]
    return replace(system, bodies=tuple(bodies))


class Case:
    """Kinematics of one system, and random states on the manifold of q.

    Attributes:
        tree: Spanning tree.
        kinematics: Kinematics of the tree.
        frames: Kinematics of the frames.
        g: Graph of both.
        inputs: Values of the input groups, N_STATES of each.
    """

    def __init__(self, system: sf.System) -> None:
        self.tree = build_tree(system)
        self.kinematics = tree_kinematics(Graph(), self.tree)
        self.g = self.kinematics.g
        self.frames = FrameKinematics(self.kinematics)
        self.inputs = random_inputs(self.tree, np.random.default_rng(1))

    @property
    def tip(self) -> NamedFrame:
        """A frame with the most joints between it and the base."""
        return max(self.tree.frames, key=lambda frame: (len(self.tree.ancestors(frame.link)), len(frame.placement)))

    def values(self, edges: Sequence[Edge]) -> np.ndarray:
        """Values of some edges at the states (N_STATES, len(edges))."""
        columns = evaluate_edges(Program("p", self.g, {}, ()), edges, self.inputs, {})
        return np.stack([np.broadcast_to(column, (N_STATES,)) for column in columns], axis=-1)

    def groups(self, edges: Sequence[Edge]) -> set[str]:
        """Input groups that some edges depend on."""
        nodes = {abs(edge) for edge in edges}
        for node in needed_nodes(self.g, edges):
            nodes |= {abs(arg) for arg in self.g.args[node]}
        return {self.g.slot[node].group for node in nodes if node in self.g.slot}

    @property
    def q_rates(self) -> dict[Edge, Edge]:
        """Rate of each coordinate, q' = N v; of prescribed ones, their stated speeds."""
        return coordinate_rates(self.kinematics)

    @property
    def v_rate(self) -> list[Edge]:
        """The input a, as edges (nv)."""
        return [self.g.input("a", k) for k in range(self.kinematics.nv)]

    @property
    def rates(self) -> dict[Edge, Edge]:
        """Rate of each coordinate and of each speed."""
        rates = self.q_rates
        for link in self.kinematics.links:
            rates |= zip(link.speeds, link.speed_rates(self.v_rate), strict=True)
        return rates


def random_inputs(tree: SpanningTree, rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Random values of every group, with quaternions of unit length."""
    names = tree.coordinates
    sizes = {"q": len(names.q), "v": len(names.v), "a": len(names.v), "u": len(names.u), "t": 1}
    inputs = {group: rng.uniform(-1.0, 1.0, (N_STATES, size)) for group, size in sizes.items()}
    for joint in (link.joint for link in tree.links if link.joint.traits.quasi_velocities):
        slots = [names.symbols[name] for name in coordinate_names(joint)[-4:]]
        group, columns = slots[0].group, [slot.index for slot in slots]
        quaternion = inputs[group][:, columns]
        inputs[group][:, columns] = quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)
    return inputs


@cache
def case(seed: int, prescribed: bool = False) -> Case:
    system = random_tree(seed, kinds=MORE_KINDS)
    return Case(every_third_prescribed(system) if prescribed else system)
