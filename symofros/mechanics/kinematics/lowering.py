"""Values of the description -> edges: run-time parameters become inputs of the graph, constants become numbers."""

from __future__ import annotations

from symofros.description.joints.joint import Joint
from symofros.description.values import Rotation, Value, Vector
from symofros.expr.edges import Edge
from symofros.expr.expression import Expression, lower
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Vec3
from symofros.mechanics.spatial.rotations import snapped, stated_rotation
from symofros.mechanics.topology.coordinates import CoordinateMap, coordinate_symbols, rate_keys, speed_keys
from symofros.mechanics.topology.tree import Placement


class Lowering:
    """Puts values of one system into one graph.

    Attributes:
        g: The graph.
        coordinates: Index map, by which a symbol is an input of the graph.
    """

    def __init__(self, g: Graph, coordinates: CoordinateMap) -> None:
        self.g = g
        self.coordinates = coordinates
        self._bindings: dict[str, Edge] = {name: g.constant(x) for name, x in coordinates.constants.items()}

    def value(self, value: Value) -> Edge:
        """The edge of one value."""
        if not isinstance(value, Expression):
            return self.g.constant(value)
        for name in sorted(value.symbols()):  # In one order, so that one description gives one text.
            self.symbol(name)
        return lower(value, self.g, self._bindings)

    def symbol(self, name: str) -> Edge:
        """The edge of a coordinate, speed, input, parameter or of t."""
        if name not in self._bindings:
            slot = self.coordinates.symbols.get(name) or self.coordinates.keys[name]
            self._bindings[name] = self.g.input(slot.group, slot.index)
        return self._bindings[name]

    def bind(self, name: str, edge: Edge) -> None:
        """Give a symbol an edge that is formed elsewhere."""
        self._bindings[name] = edge

    def coordinates_of(self, joint: Joint) -> tuple[Edge, ...]:
        """The edges of a joint's coordinates."""
        return tuple(map(self.symbol, coordinate_symbols(joint)))

    def speeds_of(self, joint: Joint) -> tuple[Edge, ...]:
        """The edges of a joint's speeds."""
        return tuple(map(self._rate, speed_keys(joint)))

    def rates_of(self, joint: Joint) -> tuple[Edge, ...]:
        """The edges of the rates of a prescribed joint's speeds."""
        return tuple(map(self._rate, rate_keys(joint)))

    def _rate(self, key: str) -> Edge:
        slot = self.coordinates.keys[key]
        return self.g.input(slot.group, slot.index)

    def vector(self, vector: Vector) -> Vec3:
        """The edges of a vector."""
        return Vec3(self.g, *map(self.value, vector))

    def rotation(self, rotation: Rotation) -> Mat3:
        """The edges of a rotation matrix."""
        for value in rotation.values:
            self.value(value)  # Binds its symbols.
        return stated_rotation(rotation, self.g, self._bindings)

    def placement(self, placement: Placement, R_LB: Mat3) -> tuple[Mat3, Vec3]:
        """A chain of constant displacements, seen from the link frame L.

        Args:
            placement: Steps from the link's body frame B outwards to a frame F.
            R_LB: The body frame in the link frame (same origin).

        Returns:
            R_LF and p_LF.
        """
        R_LF, p_LF = R_LB, Vec3(self.g)
        for step in placement:
            p_LF = p_LF + R_LF.times(self.vector(step.position))
            R_LF = snapped(R_LF @ self.rotation(step.rotation))
        return R_LF, p_LF
