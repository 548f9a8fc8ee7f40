"""Axes of contact, two along the surface and its normal, and how they turn (docs/theory/constraints.md, section 15)."""

from __future__ import annotations

from typing import NamedTuple

from symofros.description.contacts import Contact
from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.ops import STOP_GRADIENT
from symofros.expr.vector import Mat3, Vec3
from symofros.mechanics.kinematics.lowering import Lowering
from symofros.mechanics.topology.rigid_contacts import RigidBall

# What is divided by is at least this, a number of single precision too: the squares of two centres' distance, and of
# a normal's distance from the point opposite to its pole.
TINY = 1e-30
# Newton's steps for the multiplier of a rim on a cylinder: from the start of (38k) they leave 1e-14 at most.
_SECULAR_STEPS = 5
# A rim that is as near to a cylinder at two points takes the one towards this direction, which no scene has.
_ASKEW, _SHIFT = (0.48, 0.36, 0.8), 1e-9


class ContactAxes(NamedTuple):
    """Axes of contact of a rigid ball, in world axes.

    Attributes:
        distance: Signed distance of the ball's centre from the surface [m].
        R_WC: Tangents t_x and t_y, then the normal n, from the surface to the ball: the axes of contact C.
        normal_rate: Rate of n [1/s].
        w_WC_W: Their angular velocity [rad/s].
    """

    distance: Edge
    R_WC: Mat3
    normal_rate: Vec3
    w_WC_W: Vec3


def surface_axes(lowering: Lowering, ball: RigidBall, R_WS: Mat3, w_WS_W: Vec3, d: Vec3, d_rate: Vec3) -> ContactAxes:
    """Axes of contact: of a plane those of its frame S, else these, turned to the normal: (38c) to (38f).

    Args:
        lowering: Edges of the contact's numbers.
        ball: The ball.
        R_WS: Axes of S.
        w_WS_W: Its angular velocity [rad/s].
        d: From the origin of S to the ball's centre [m].
        d_rate: Its rate [m/s].
    """
    if ball.contact.surface == "plane":
        n = R_WS.column(2)
        return ContactAxes(d.dot(n), R_WS, w_WS_W.cross(n), w_WS_W)
    g, inside = lowering.g, ball.contact.inside
    away, free = from_core(lowering, ball.contact, R_WS.T.times(d))
    size, normal = core_normal(g, away, inside)
    distance = g.sub(size, lowering.value(ball.contact.surface_radius or 0.0))
    n = R_WS.times(normal)
    moved = R_WS.T.times(d_rate - w_WS_W.cross(d))
    away_rate = R_WS.times(Vec3(g, *(g.mul(one, x) for one, x in zip(free, moved, strict=True))))
    turned = (away_rate - n.scaled(n.dot(away_rate))).scaled(g.div(-ONE if inside else ONE, size))
    k = n.cross(turned)
    Z, share = _pole(lowering, ball, R_WS, n)
    w_WC_W = w_WS_W + k - n.scaled(g.mul(k.dot(Z), share))
    R_WC = tangents(lowering, ball, R_WS, n)
    return ContactAxes(-distance if inside else distance, R_WC, w_WS_W.cross(n) + turned, w_WC_W)


class Line(NamedTuple):
    """A line of a body, in world axes.

    Attributes:
        p: Its middle [m].
        v: The velocity of that [m/s].
        a: Unit vector along it.
        a_rate: Its rate [1/s].
    """

    p: Vec3
    v: Vec3
    a: Vec3
    a_rate: Vec3

    def seen_from(self, S: Triad) -> Line:
        """The line in the axes and from the origin of a frame S."""
        d, inverse = self.p - S.p, S.R.T
        v, turned = self.v - S.v - S.w.cross(d), self.a_rate - S.w.cross(self.a)
        return Line(inverse.times(d), inverse.times(v), inverse.times(self.a), inverse.times(turned))


class Triad(NamedTuple):
    """A frame S of a body, in world axes.

    Attributes:
        p: Its origin [m].
        R: Its axes.
        v: The velocity of the origin [m/s].
        w: Its angular velocity [rad/s].
    """

    p: Vec3
    R: Mat3
    v: Vec3
    w: Vec3

    @property
    def axis(self) -> Line:
        """The frame's z axis."""
        b = self.R.column(2)
        return Line(self.p, self.v, b, self.w.cross(b))


def reach_of(lowering: Lowering, contact: Contact, on_ball: Line, S: Triad) -> Reach | None:
    """What leads from a point of a contact to that of its rim or segment next to the surface; None of a ball.

    Args:
        lowering: Edges of the contact's numbers.
        contact: The contact.
        on_ball: The line through the point along the z axis of its frame.
        S: The surface's frame.
    """
    if contact.rim is not None and contact.surface == "cylinder":
        return rim_on_cylinder(lowering.g, lowering.value(contact.rim), on_ball, S.axis)
    if contact.rim is not None:
        n, n_rate = (S.axis.a, S.axis.a_rate) if contact.surface == "plane" else _from_centre(on_ball, S)
        return rim_reach(lowering.g, lowering.value(contact.rim), on_ball.a, on_ball.a_rate, n, n_rate)
    if contact.segment is None:
        return None
    if contact.surface == "box":
        return box_reach(lowering, contact, on_ball, S)
    return segment_reach(lowering, contact, on_ball, S.axis)


class Reach(NamedTuple):
    """Vector from a point to that of its rim or segment which is next to the surface, in world axes.

    Attributes:
        reach: The vector [m].
        rate: Its rate [m/s].
        sine: Of the angle between the planes of rim and contact, of a segment (38m), (38n);
            of a rim on a cylinder sigma/lambda of (38j): near zero no single point is next to the surface.
    """

    reach: Vec3
    rate: Vec3
    sine: Edge


def _from_centre(on_ball: Line, S: Triad) -> tuple[Vec3, Vec3]:
    """Unit vector from the centre of a sphere to that of a rim, in place of the normal of a plane, and its rate."""
    g, c, c_rate = on_ball.p.g, on_ball.p - S.p, on_ball.v - S.v
    away = g.div(ONE, norm(g, c))
    n = c.scaled(away)
    return n, (c_rate - n.scaled(n.dot(c_rate))).scaled(away)


def rim_reach(g: Graph, radius: Edge, a: Vec3, a_rate: Vec3, n: Vec3, n_rate: Vec3) -> Reach:
    """Where a rim with the axis a is next to a plane with the normal n, or to a sphere in the direction -n: (38g).

    Args:
        g: Graph of the result.
        radius: Radius of the rim [m].
        a: Unit vector along its axis.
        a_rate: Its rate [1/s].
        n: Normal of the plane.
        n_rate: Its rate [1/s].
    """
    cosine = n.dot(a)
    s = n - a.scaled(cosine)
    s_rate = n_rate - a.scaled(g.add(n_rate.dot(a), n.dot(a_rate))) - a_rate.scaled(cosine)
    sine = norm(g, s)
    e = s.scaled(g.div(ONE, sine))
    e_rate = (s_rate - e.scaled(s_rate.dot(e))).scaled(g.div(ONE, sine))
    return Reach(-e.scaled(radius), -e_rate.scaled(radius), sine)


def rim_on_cylinder(g: Graph, radius: Edge, A: Line, B: Line) -> Reach:
    """Where a rim about the line A is next to the line B, of all points of the rim, and how that moves: (38j), (38l).

    Args:
        g: Graph of the result.
        radius: Radius of the rim [m].
        A: The rim's axis, through its centre.
        B: The cylinder's axis.
    """
    (a, a_rate), (b, b_rate) = A[2:], B[2:]
    c, c_rate, x = A.p - B.p, A.v - B.v, a.dot(b)
    d, m = c - b.scaled(b.dot(c)), b - a.scaled(x)

    def derived(e: Vec3) -> tuple[Vec3, Vec3, Edge]:
        """The tangent of the rim, the vector from the axis B, and the second derivative of (38j)."""
        t = a.cross(e)
        y = d + (e - b.scaled(b.dot(e))).scaled(radius)
        bent = g.sub(g.mul(radius, g.sub(ONE, g.mul(b.dot(t), b.dot(t)))), y.dot(e))
        return t, y, g.call("max", bent, g.mul(g.constant(_SHIFT), radius))

    e = _nearest_direction(g, radius, a, m, d)
    for _ in range(2):  # Newton's steps, which make derivatives of e exact up to the second, as does e . a = 0.
        e = _unit(g, e - a.scaled(a.dot(e)))
        t, y, bent = derived(e)
        e = _unit(g, e - t.scaled(g.div(y.dot(t), bent)))
    t, y, bent = derived(e)
    q, tilt = c + e.scaled(radius), g.mul(radius, e.dot(a_rate))
    along = g.sub(g.add(b_rate.dot(q), b.dot(c_rate)), g.mul(tilt, x))
    parts = g.mul(along, b.dot(t)), g.mul(b.dot(q), b_rate.dot(t)), g.mul(t.dot(a_rate), y.dot(a))
    turn = g.div(g.sub(g.sum(parts), c_rate.dot(t)), bent)
    e_rate = t.scaled(turn) - a.scaled(e.dot(a_rate))
    multiplier = g.call("max", g.sub(radius, y.dot(e)), g.constant(TINY))
    left = g.call("max", g.sub(multiplier, g.mul(radius, m.dot(m))), ZERO)
    return Reach(e.scaled(radius), e_rate.scaled(radius), g.div(left, multiplier))


def _nearest_direction(g: Graph, radius: Edge, a: Vec3, m: Vec3, d: Vec3) -> Vec3:
    """The unit vector e normal to a with the least d . e - radius (m . e)^2/2, without derivatives: (38j), (38k)."""

    def still(*edges: Edge) -> list[Edge]:
        return [g.call(STOP_GRADIENT, edge) for edge in edges]

    a, m, d, (radius,) = Vec3(g, *still(*a)), Vec3(g, *still(*m)), Vec3(g, *still(*d)), still(radius)
    tiny, two = g.constant(TINY), g.constant(2.0)
    d = d + Vec3(g, *(g.mul(radius, g.constant(_SHIFT * share)) for share in _ASKEW))
    d = d - a.scaled(a.dot(d))
    k, slant = g.mul(radius, m.dot(m)), m.dot(d)
    alpha2 = g.div(g.mul(slant, slant), g.call("max", m.dot(m), tiny))
    beta2 = g.call("max", g.sub(d.dot(d), alpha2), ZERO)
    alpha, beta = g.sqrt(alpha2), g.sqrt(beta2)
    denominator = g.call("max", g.mul(two, g.sub(g.mul(k, k), beta2)), tiny)
    cube = g.div(g.mul(alpha2, g.mul(k, g.mul(k, k))), g.call("max", g.mul(g.constant(4.0), beta2), tiny))
    least = g.call("min", g.div(g.mul(alpha, k), g.sqrt(denominator)), g.call("pow", cube, g.constant(1.0 / 3.0)))
    sigma = g.call("max", g.call("max", alpha, g.sub(beta, k)), g.call("max", least, tiny))
    for _ in range(_SECULAR_STEPS):
        multiplier = g.add(sigma, k)
        x2, y2 = g.div(alpha2, g.mul(sigma, sigma)), g.div(beta2, g.mul(multiplier, multiplier))
        square, slope = g.add(x2, y2), g.add(g.div(x2, sigma), g.div(y2, multiplier))
        sigma = g.add(sigma, g.div(g.mul(g.sub(g.sqrt(square), ONE), square), g.call("max", slope, tiny)))
    return _unit(g, -(d + m.scaled(g.div(g.mul(radius, slant), sigma))))


def _unit(g: Graph, x: Vec3) -> Vec3:
    return x.scaled(g.div(ONE, norm(g, x)))


def segment_reach(lowering: Lowering, contact: Contact, A: Line, B: Line) -> Reach:
    """Where a segment on the line A is next to the core of a solid along B, and how that point moves: (38h), (38m)."""
    g = lowering.g
    half = g.mul(g.constant(0.5), lowering.value(contact.segment or 0.0))
    c, c_rate = A.p - B.p, A.v - B.v
    y, y_rate = A.a.dot(c), g.add(A.a_rate.dot(c), A.a.dot(c_rate))
    x = x_rate = t = t_rate = ZERO
    sine = ONE
    if contact.surface != "sphere":
        x, x_rate = A.a.dot(B.a), g.add(A.a_rate.dot(B.a), A.a.dot(B.a_rate))
        z, z_rate = B.a.dot(c), g.add(B.a_rate.dot(c), B.a.dot(c_rate))
        square = g.call("max", g.sub(ONE, g.mul(x, x)), g.constant(TINY))
        s = g.div(g.sub(g.mul(x, z), y), square)
        s_rate = g.sub(g.add(g.mul(x_rate, z), g.mul(x, z_rate)), y_rate)
        s_rate = g.div(g.add(s_rate, g.mul(g.mul(g.constant(2.0), s), g.mul(x, x_rate))), square)
        s, s_rate = _clamped(g, s, s_rate, half)
        t, t_rate = g.add(g.mul(s, x), z), g.add(g.add(g.mul(s_rate, x), g.mul(s, x_rate)), z_rate)
        if contact.surface == "capsule":
            t, t_rate = _clamped(g, t, t_rate, g.mul(g.constant(0.5), lowering.value(contact.length or 0.0)))
    s_rate = g.sub(g.add(g.mul(t_rate, x), g.mul(t, x_rate)), y_rate)
    s, s_rate = _clamped(g, g.sub(g.mul(t, x), y), s_rate, half)
    if contact.surface != "sphere":
        away = c + A.a.scaled(s) - B.a.scaled(t)
        end = g.div(A.a.dot(away), norm(g, away))  # Zero but where an end is next to the core.
        sine = g.sqrt(g.add(square, g.mul(end, end)))
    return Reach(A.a.scaled(s), A.a.scaled(s_rate) + A.a_rate.scaled(s), sine)


def box_reach(lowering: Lowering, contact: Contact, on_ball: Line, S: Triad) -> Reach:
    """Where a segment is next to a box, and how that point moves: (38i), (38n), in the axes of the box."""
    g, line = lowering.g, on_ball.seen_from(S)
    half = g.mul(g.constant(0.5), lowering.value(contact.segment or 0.0))
    halves = [g.mul(g.constant(0.5), lowering.value(size)) for size in contact.size or ()]
    edges = list(zip(line.p, line.a, halves, strict=True))

    def beyond(s: Edge) -> list[Edge]:
        """What the point s is beyond the faces of the box along each axis; zero between them."""
        x = [g.add(c, g.mul(s, a)) for c, a, _ in edges]
        return [g.sub(one, _within(g, one, h)) for one, h in zip(x, halves, strict=True)]

    def slope(s: Edge) -> Edge:
        """Half the rate, along the segment, of the square of the distance from the box: it does not fall."""
        return g.sum(g.mul(a, y) for a, y in zip(line.a, beyond(s), strict=True))

    knots = [-half, half]
    for c, a, h in edges:
        slant = g.div(a, g.call("max", g.mul(a, a), g.constant(TINY)))
        knots += [_within(g, g.mul(g.sub(face, c), slant), half) for face in (h, -h)]
    low, high = -half, half
    for knot in knots:
        falls, rises = g.call("step", -slope(knot)), g.call("step", slope(knot))
        low = g.call("max", low, g.sub(g.mul(falls, g.add(knot, half)), half))
        high = g.call("min", high, g.add(g.mul(rises, g.sub(knot, half)), half))
    middle = g.mul(g.constant(0.5), g.add(low, high))
    outside = [g.sub(ONE, g.call("step", -g.call("abs", y))) for y in beyond(middle)]
    steep = g.sum(g.mul(w, g.mul(a, a)) for w, a in zip(outside, line.a, strict=True))
    steep = g.call("max", steep, g.constant(TINY))
    s = g.sub(middle, g.div(slope(middle), steep))
    moved = line.v + line.a_rate.scaled(s)
    parts = zip(outside, line.a, line.a_rate, moved, beyond(s), strict=True)
    change = g.sum(g.mul(w, g.add(g.mul(a_rate, y), g.mul(a, x_rate))) for w, a, a_rate, x_rate, y in parts)
    s, s_rate = _clamped(g, s, -g.div(change, steep), half)
    y = Vec3(g, *beyond(s))
    n = y.scaled(g.div(ONE, norm(g, y)))
    flat = Vec3(g, *(g.mul(a, across) for a, across in zip(line.a, n, strict=True)))
    return Reach(on_ball.a.scaled(s), on_ball.a.scaled(s_rate) + on_ball.a_rate.scaled(s), norm(g, flat))


def _within(g: Graph, x: Edge, half: Edge) -> Edge:
    """The number between -half and half that is next to x."""
    return g.call("min", g.call("max", x, -half), half)


def _clamped(g: Graph, x: Edge, x_rate: Edge, half: Edge) -> tuple[Edge, Edge]:
    """A number between -half and half, and its rate."""
    within = g.call("step", g.sub(half, g.call("abs", x)))
    return _within(g, x, half), g.mul(within, x_rate)


def from_core(lowering: Lowering, contact: Contact, x: Vec3) -> tuple[Vec3, Vec3]:
    """Vector from the nearest point of a solid's core to x, in the frame's axes, and its change with x: (38c).

    The core is the centre of a sphere, the axis of a cylinder, the segment between the ends of a capsule, a box itself.

    Returns:
        The vector; 1 for each of its components that changes as that of x does, 0 for one that stays zero.
    """
    g = lowering.g
    if contact.surface == "cylinder":
        return Vec3(g, x.x, x.y, ZERO), Vec3(g, ONE, ONE, ZERO)
    lengths = contact.size or (0.0, 0.0, contact.length or 0.0)
    away, free = list(x), [ONE, ONE, ONE]
    for k, (coordinate, length) in enumerate(zip(x, lengths, strict=True)):
        half = g.mul(g.constant(0.5), lowering.value(length))
        if half != ZERO:
            away[k] = g.sub(coordinate, _within(g, coordinate, half))
            free[k] = g.call("step", g.sub(g.call("abs", coordinate), half))
    return Vec3(g, *away), Vec3(g, *free)


def core_normal(g: Graph, away: Vec3, inside: bool) -> tuple[Edge, Vec3]:
    """Distance from the core, and the normal: along the vector from it or, inside of a hollow, against it."""
    size = norm(g, away)
    normal = away.scaled(g.div(ONE, size))
    return size, -normal if inside else normal


def tangents(lowering: Lowering, ball: RigidBall, R_WS: Mat3, n: Vec3) -> Mat3:
    """Axes x and y of S turned the shortest way from the pole of the ball to n, and n: (38e)."""
    g = lowering.g
    Z, share = _pole(lowering, ball, R_WS, n)
    lean = (n + Z).scaled(share)
    return Mat3.from_columns(g, [*(e - lean.scaled(n.dot(e)) for e in (R_WS.column(0), R_WS.column(1))), n])


def _pole(lowering: Lowering, ball: RigidBall, R_WS: Mat3, n: Vec3) -> tuple[Vec3, Edge]:
    """The pole Z, one end of the z axis of S, and 1/(1 + n . Z)."""
    g = lowering.g
    Z = R_WS.column(2).scaled(lowering.symbol(ball.pole))
    return Z, g.div(ONE, g.call("max", g.add(ONE, n.dot(Z)), g.constant(TINY)))


def norm(g: Graph, x: Vec3) -> Edge:
    """Length of a vector, whose derivative exists at zero, too."""
    return g.sqrt(g.call("max", x.dot(x), g.constant(TINY)))
