"""Contacts: distances of surfaces, and the forces of penetrations (docs/theory/rigid.md, section 10.2)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from symofros.base.names import symbol_of
from symofros.base.smoothed_sign import PEAK
from symofros.description.contacts import Contact
from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Vec3
from symofros.mechanics.dynamics.applied.contact_axes import (
    TINY,
    Line,
    Triad,
    core_normal,
    from_core,
    norm,
    reach_of,
    tangents,
)
from symofros.mechanics.dynamics.applied.elements import smoothed_sign
from symofros.mechanics.kinematics.frames import FrameKinematics
from symofros.mechanics.kinematics.links import TreeKinematics
from symofros.mechanics.kinematics.lowering import Lowering
from symofros.mechanics.topology.rigid_contacts import RigidBall
from symofros.mechanics.topology.tree import frame_of

# Share of the largest friction from which on bristles begin to slip as they are bent further.
_BREAKAWAY = 0.9


@dataclass(frozen=True)
class TouchingBall:
    """A ball and the surface that it may touch, in world axes.

    Attributes:
        gap: Distance of ball and surface; negative where the ball penetrates it [m].
        depth: Penetration, zero without contact [m].
        push: Normal force [N].
        force: Force on the ball: normal force and friction [N].
        point: Point of the surface next to the ball's centre, where the force acts [m].
        energy: Energy that the penetration and bristles store [J].
        share: Penetration over the radius of the ball, or else of the surface; zero where neither has any.
        slip: Velocity of the ball's material point there against the surface's, in the axes of the surface, of rigid
            contacts in the axes of contact [m/s].
        tilt: Component of the normal along z of the surface's frame.
        rates: Rates of the deflections of its bristles, in the axes of the surface; none without bristles [m/s].
        sine: Of the angle of a rim or segment with what it would touch along a line; 1 of balls.
    """

    gap: Edge
    depth: Edge
    push: Edge
    force: Vec3
    point: Vec3
    energy: Edge
    share: Edge
    slip: Vec3
    tilt: Edge
    rates: tuple[Edge, ...]
    sine: Edge = ONE


def touching_balls(kinematics: TreeKinematics, frames: FrameKinematics, contact: Contact) -> list[TouchingBall]:
    """The balls of a contact, in order."""
    lowering = kinematics.lowering
    return [
        _touching(kinematics, frames, contact, number, lowering.vector(point))
        for number, point in enumerate(contact.points)
    ]


def bristle_rates(kinematics: TreeKinematics, frames: FrameKinematics) -> Iterator[tuple[str, Edge]]:
    """Names of the states of all contacts, and their rates."""
    for contact in kinematics.tree.system.contacts:
        if contact.bristle_stiffness is not None:
            for names, ball in zip(contact.state_names, touching_balls(kinematics, frames, contact), strict=True):
                yield from zip(names, ball.rates, strict=True)


def _touching(
    kinematics: TreeKinematics, frames: FrameKinematics, contact: Contact, number: int, point: Vec3
) -> TouchingBall:
    g, lowering = kinematics.g, kinematics.lowering
    ends = [frame_of(kinematics.tree, *anchor) for anchor in (contact.first, contact.second)]
    first, second = (frames.pose(end) for end in ends)
    radius = lowering.value(contact.radius)
    p_WC, still = first.p_WF + first.R_WF.times(point), Vec3(g)
    line = Line(p_WC, still, first.R_WF.column(2), still)
    reach = reach_of(lowering, contact, line, Triad(second.p_WF, second.R_WF, still, still))
    if reach is not None:
        p_WC = p_WC + reach.reach
    distance, gradient = _surface(lowering, contact, second.R_WF.T.times(p_WC - second.p_WF))
    normal = second.R_WF.times(gradient)
    # Of rigid balls as in (38a), beside the surface too: what slides and what sticks have one point there.
    p_WP = p_WC - normal.scaled(radius if contact.rigid else distance)
    gap = g.sub(distance, radius)
    # Of points fixed to the two bodies at the point of contact.
    at_first, at_second = (_velocity_at(g, frames.velocity(end), p_WP - frames.pose(end).p_WF) for end in ends)
    slip = at_first - at_second
    if contact.rigid:
        ball = RigidBall(contact, number, contact.ball_names[number])
        axes = second.R_WF if contact.surface == "plane" else tangents(lowering, ball, second.R_WF, normal)
        pushes = Vec3(g, *(lowering.symbol(name) for name in ball.pushes))
        along = axes.T.times(slip)
        force, sine = axes.times(pushes), ONE if reach is None else reach.sine
        return TouchingBall(gap, ZERO, pushes.z, force, p_WP, ZERO, ZERO, along, gradient.z, (), sine)
    slip_S = second.R_WF.T.times(slip)
    depth = g.call("max", -gap, ZERO)
    approach = -slip.dot(normal)
    elastic = g.mul(lowering.value(contact.stiffness or 0.0), _power(g, depth, contact.exponent))
    damping = g.call("max", g.add(ONE, g.mul(lowering.value(contact.dissipation), approach)), ZERO)
    push = g.mul(elastic, damping)
    across = slip + normal.scaled(approach)
    energy = g.div(g.mul(elastic, depth), g.constant(contact.exponent + 1.0))
    rates: tuple[Edge, ...] = ()
    states = contact.state_names[number]
    if states:
        z = Vec3(g, *(lowering.symbol(symbol_of(name)) for name in states))
        bristles = _Bristles(lowering, contact, gradient, push, second.R_WF.T.times(across), z)
        drag = second.R_WF.times(bristles.drag())
        energy = g.add(energy, bristles.energy())
        rates = tuple(bristles.rate(g.sub(ONE, g.call("step", gap))))[: len(states)]
    else:
        drag = _friction(lowering, contact, push, across)
    size = _size(lowering, contact)
    share = ZERO if size is None else g.div(depth, size)
    return TouchingBall(gap, depth, push, normal.scaled(push) - drag, p_WP, energy, share, slip_S, gradient.z, rates)


def _velocity_at(g: Graph, velocity: list[Edge], offset: Vec3) -> Vec3:
    """Velocity of a point of a body, from that of a frame (linear; angular) and the point's place from its origin."""
    return Vec3(g, *velocity[:3]) + Vec3(g, *velocity[3:]).cross(offset)


def _friction(lowering: Lowering, contact: Contact, push: Edge, slip: Vec3) -> Vec3:
    """Friction against the slip, smooth through zero: (63)."""
    g = lowering.g
    coefficient = lowering.value(contact.friction)
    if coefficient == ZERO:
        return Vec3(g)
    peak = g.mul(g.constant(PEAK), lowering.value(contact.minimum_velocity))
    # Beyond the peak xi is a unit vector, before it the share of the peak.
    xi = slip.scaled(g.div(ONE, g.sqrt(g.call("max", slip.dot(slip), g.mul(peak, peak)))))
    return xi.scaled(g.mul(g.mul(coefficient, push), smoothed_sign(g, xi.dot(xi))))


class _Bristles:
    """Bristles of a ball in the axes S of the surface, a spring that slips (docs/theory/states.md, section 5).

    Args:
        lowering: Edges of the contact's numbers.
        contact: The contact.
        normal: Normal of the surface, in S.
        push: Normal force [N].
        slip: Velocity of the ball's point across the surface, in S [m/s].
        z: Deflection [m].
    """

    def __init__(self, lowering: Lowering, contact: Contact, normal: Vec3, push: Edge, slip: Vec3, z: Vec3) -> None:
        g = self.g = lowering.g
        self.stiffness = lowering.value(contact.bristle_stiffness or 0.0)
        self.damping = lowering.value(contact.bristle_damping or 0.0)
        tiny = g.constant(TINY)
        self.z = z
        self.along = normal.scaled(normal.dot(z))
        self.across = z - self.along
        square = self.across.dot(self.across)
        pull = g.mul(self.stiffness, g.sqrt(g.call("max", square, tiny)))
        limit = g.mul(lowering.value(contact.friction), push)
        self.left = g.call("max", g.sub(limit, pull), ZERO)
        self.held = g.div(limit, g.add(g.call("max", pull, limit), tiny))
        beyond = g.sub(pull, g.mul(g.constant(_BREAKAWAY), limit))
        ramp = g.div(beyond, g.add(g.mul(g.constant(1.0 - _BREAKAWAY), limit), tiny))
        slipping = g.call("min", g.call("max", ramp, ZERO), ONE)
        leads = g.div(g.call("max", slip.dot(self.across), ZERO), g.call("max", square, tiny))
        self.elastic_slip = slip - self.across.scaled(g.mul(slipping, leads))

    def drag(self) -> Vec3:
        """The force against the slip, in S: (19), (20)."""
        g = self.g
        lag = g.mul(self.damping, norm(g, self.elastic_slip))
        share = g.div(self.left, g.add(g.add(self.left, lag), g.constant(TINY)))
        spring = self.across.scaled(g.mul(self.stiffness, self.held))
        return spring + self.elastic_slip.scaled(g.mul(self.damping, share))

    def rate(self, touches: Edge) -> Vec3:
        """The rate of the deflection where the ball touches the surface (1) or not (0), in S: (18)."""
        g = self.g
        relaxation = g.div(self.stiffness, self.damping)
        bent = self.across.scaled(g.sub(ONE, self.held)) + self.along
        return self.elastic_slip.scaled(touches) - bent.scaled(relaxation)

    def energy(self) -> Edge:
        """What the deflection stores [J]."""
        return self.g.mul(self.g.mul(self.g.constant(0.5), self.stiffness), self.z.dot(self.z))


def _power(g: Graph, depth: Edge, exponent: float) -> Edge:
    """A power of the penetration whose derivatives exist at zero."""
    if exponent == 1.0:
        return depth
    return g.mul(depth, depth if exponent == 2.0 else g.sqrt(g.call("max", depth, g.constant(TINY))))


def _surface(lowering: Lowering, contact: Contact, x: Vec3) -> tuple[Edge, Vec3]:
    """Signed distance of a point from the surface, positive outside of the solid, and its gradient: (60)."""
    g = lowering.g
    if contact.surface == "plane":
        return x.z, Vec3.unit(g, 2)
    if contact.surface == "box":
        return _box(lowering, contact, x)
    length, normal = core_normal(g, from_core(lowering, contact, x)[0], contact.inside)
    distance = g.sub(length, lowering.value(contact.surface_radius or 0.0))
    return (-distance if contact.inside else distance), normal


def _box(lowering: Lowering, contact: Contact, x: Vec3) -> tuple[Edge, Vec3]:
    """The same of a box: outside by the nearest point of it, inside by the nearest of its faces: (61)."""
    g = lowering.g
    assert contact.size is not None
    half = [g.mul(g.constant(0.5), lowering.value(size)) for size in contact.size]
    beyond = [g.sub(g.call("abs", edge), h) for edge, h in zip(x, half, strict=True)]
    most = g.call("max", g.call("max", beyond[0], beyond[1]), beyond[2])
    outside = Vec3(g, *(g.call("max", d, ZERO) for d in beyond))
    distance = g.add(norm(g, outside), g.call("min", most, ZERO))
    within = g.call("step", -most)
    along = [g.add(out, g.mul(within, g.call("step", g.sub(d, most)))) for out, d in zip(outside, beyond, strict=True)]
    # The sign of a coordinate, 1 of zero.
    signs = [g.sub(g.mul(g.constant(2.0), g.call("step", edge)), ONE) for edge in x]
    normal = Vec3(g, *(g.mul(sign, edge) for sign, edge in zip(signs, along, strict=True)))
    return distance, normal.scaled(g.div(ONE, norm(g, normal)))


def _size(lowering: Lowering, contact: Contact) -> Edge | None:
    """Radius of the balls, or else half the least measure of the surface; None where there is none."""
    g = lowering.g
    if lowering.value(contact.radius) != ZERO:
        return lowering.value(contact.radius)
    if contact.surface_radius is not None:
        return lowering.value(contact.surface_radius)
    if contact.size is None:
        return None
    x, y, z = (lowering.value(size) for size in contact.size)
    return g.mul(g.constant(0.5), g.call("min", g.call("min", x, y), z))
