"""Constraints: phi(q) = 0 and G v = b as rows of the equations of motion (docs/theory/constraints.md).

Each condition is written by the motion of the frames it joins; G and gamma follow from the frames' Jacobians and
accelerations, so prescribed joints and the tips of beams need nothing of their own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from symofros.base.names import TIME
from symofros.description.constraints import (
    AXES,
    AxisName,
    Closure,
    Constraint,
    Coupling,
    KnifeEdge,
    Nonholonomic,
    Rod,
    Rolling,
    Touching,
)
from symofros.description.forces import Anchor
from symofros.expr.derivative import along, directional
from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.quaternion import Quaternion
from symofros.expr.vector import Mat3, Vec3
from symofros.mechanics.dynamics.applied.contact_axes import Line, Triad, reach_of, surface_axes
from symofros.mechanics.dynamics.applied.forces import coordinate_rates, rates_per_speed
from symofros.mechanics.kinematics.frames import FrameKinematics
from symofros.mechanics.kinematics.links import TreeKinematics
from symofros.mechanics.topology.rigid_contacts import RigidBall
from symofros.mechanics.topology.switches import offset_names, rotation_names, switches_of
from symofros.mechanics.topology.tree import frame_of


class Lever(NamedTuple):
    """A part of a row: sign (force . J_v + moment . J_w) of a body's frame, in world axes."""

    frame: str
    force: Vec3 | None
    moment: Vec3 | None
    sign: int


@dataclass(frozen=True)
class Row:
    """One condition.

    Attributes:
        phi: Residual of the condition; zero for one that binds speeds only.
        G: Row of the constraint Jacobian (nv).
        rate: G v - b: the rate of phi, or the residual of the condition on speeds.
        gamma: Right-hand side of G v' = gamma.
        levers: Terms of G, through which the multiplier acts on bodies.
        facing: Cosines of the angles between axes that it keeps parallel; negative where they are the wrong way round.
    """

    phi: Edge
    G: tuple[Edge, ...]
    rate: Edge
    gamma: Edge
    levers: tuple[Lever, ...] = ()
    facing: tuple[Edge, ...] = ()

    def scaled(self, g: Graph, e: Edge) -> Row:
        """The row times e: as it is for 1, binding nothing for 0; its multiplier, given, acts either way (eq. 14)."""
        facing = tuple(g.add(g.mul(e, cosine), g.sub(ONE, e)) for cosine in self.facing)
        phi, rate, gamma = (g.mul(e, edge) for edge in (self.phi, self.rate, self.gamma))
        return Row(phi, tuple(g.mul(e, entry) for entry in self.G), rate, gamma, self.levers, facing)


@dataclass(frozen=True)
class FrameState:
    """Motion of a frame F in the world W, in world axes.

    Attributes:
        name: Qualified name of the frame.
        p: p_WF [m].
        R: R_WF.
        v: v_WFo_W [m/s].
        w: w_WF_W [rad/s].
        a: a_WFo_W at v' = 0 [m/s^2].
        alpha: alpha_WF_W at v' = 0 [rad/s^2].
        J: Jacobian, rows of v before those of w (6, nv).
    """

    name: str
    p: Vec3
    R: Mat3
    v: Vec3
    w: Vec3
    a: Vec3
    alpha: Vec3
    J: list[list[Edge]]


class Constraints:
    """The rows of every constraint of a tree, in the order of description."""

    def __init__(self, frames: FrameKinematics) -> None:
        self.frames, self.kinematics, self.g = frames, frames.kinematics, frames.g
        self.nv = self.kinematics.nv
        self.switches = switches_of(self.kinematics.tree.system)
        self._states: dict[str, FrameState] = {}

    def rows(self) -> list[Row]:
        """All rows."""
        make: dict[type, Callable[..., Iterator[Row]]] = {
            Closure: self._closure,
            Rod: self._rod,
            Coupling: self._coupling,
            KnifeEdge: self._edge,
            Rolling: self._rolling,
            Nonholonomic: self._stated,
            Touching: self._touching,
        }
        return [
            row
            for item in self.kinematics.tree.system.constraints
            for row in self._switched(item, list(make[type(item)](item)))
        ]

    def _switched(self, item: Constraint, rows: list[Row]) -> list[Row]:
        """The rows of a constraint less what it holds, by whether it holds: e (phi - phi_e), e G, ... (eqs. 29, 30)."""
        switch, symbol = self.switches.get(item.name), self.kinematics.lowering.symbol
        if switch is None:
            return rows
        if switch.pose == "moment":
            offsets = offset_names(item)
            rows = [
                replace(row, phi=self.g.sub(row.phi, symbol(offsets[name]))) if name in offsets else row
                for name, row in zip(item.conditions, rows, strict=True)
            ]
        return [row.scaled(self.g, self.kinematics.lowering.value(switch.engaged)) for row in rows]

    def _turned(self, closure: Closure, B: FrameState) -> FrameState:
        """The second frame of a closure, turned by the rotation that it holds, if it holds any (eq. 30)."""
        names = rotation_names(closure)
        if not names or closure.name not in self.switches or self.switches[closure.name].pose != "moment":
            return B
        held = Quaternion.of(self.g, *(self.kinematics.lowering.symbol(name) for name in names))
        return replace(B, R=B.R @ held.normalized.matrix)

    def _state(self, anchor: Anchor) -> FrameState:
        frame = frame_of(self.kinematics.tree, *anchor)
        if frame.qualified not in self._states:
            pose = self.frames.pose(frame)
            velocity = self.frames.velocity(frame)
            acceleration = self.frames.acceleration(frame, [ZERO] * self.nv)
            v, w = Vec3(self.g, *velocity[:3]), Vec3(self.g, *velocity[3:])
            a, alpha = Vec3(self.g, *acceleration[:3]), Vec3(self.g, *acceleration[3:])
            J = self.frames.jacobian(frame)
            self._states[frame.qualified] = FrameState(frame.qualified, pose.p_WF, pose.R_WF, v, w, a, alpha, J)
        return self._states[frame.qualified]

    # Closures.

    def _closure(self, closure: Closure) -> Iterator[Row]:
        A, B = self._state(closure.first), self._state(closure.second)
        for axis in closure.translations:
            yield self._offset(A, B, A.R.column(AXES.index(axis)))
        B = self._turned(closure, B)
        blocked = [AXES.index(axis) for axis in closure.rotations]
        parallel = {3: blocked, 2: [k for k in range(3) if k not in blocked]}.get(len(blocked), [])
        facing = tuple(A.R.column(k).dot(B.R.column(k)) for k in parallel)
        for which, pairs in enumerate(_conditions(closure.rotations)):
            yield replace(self._between(A, B, pairs), facing=facing if which == 0 else ())

    def _offset(self, A: FrameState, B: FrameState, n: Vec3) -> Row:
        """Condition d . n = 0 for d = p_B - p_A and n fixed in A (eq. 3)."""
        d, d_rate = B.p - A.p, B.v - A.v
        n_rate = A.w.cross(n)
        turned = n.cross(d)  # (w x n) . d = w . (n x d)
        g, parts = self.g, [(B, n, None, 1), (A, n, None, -1), (A, None, turned, 1)]
        rate = g.add(d_rate.dot(n), d.dot(n_rate))
        drift = g.add((B.a - A.a).dot(n), d.dot(A.alpha.cross(n) + A.w.cross(n_rate)))
        drift = g.add(drift, (d_rate + d_rate).dot(n_rate))
        return self._row(d.dot(n), rate, -drift, parts)

    def _between(self, A: FrameState, B: FrameState, pairs: Sequence[tuple[int, int, float]]) -> Row:
        """The sum of c a_i . b_j = 0, for axes a_i of A and b_j of B (eqs. 4, 5)."""
        g = self.g
        phi, rate, drift, lever = ZERO, ZERO, ZERO, Vec3(g)
        relative, relative_rate = B.w - A.w, B.alpha - A.alpha
        for i, j, factor in pairs:
            c = g.constant(factor)
            a, b = A.R.column(i).scaled(c), B.R.column(j)
            cross = b.cross(a)  # The rate of a . b is (w_B - w_A) . (b x a).
            cross_rate = B.w.cross(b).cross(a) + b.cross(A.w.cross(a))
            phi = g.add(phi, a.dot(b))
            rate = g.add(rate, relative.dot(cross))
            drift = g.add(drift, g.add(relative_rate.dot(cross), relative.dot(cross_rate)))
            lever = lever + cross
        return self._row(phi, rate, -drift, [(B, None, lever, 1), (A, None, lever, -1)])

    def _rod(self, rod: Rod) -> Iterator[Row]:
        """(d . d - L^2)/(2 L) = 0 (eq. 6): a polynomial, with the unit of a length."""
        g = self.g
        A, B = self._state(rod.first), self._state(rod.second)
        length = self.kinematics.lowering.value(rod.length)
        per_length = g.div(ONE, length)
        d, d_rate = B.p - A.p, B.v - A.v
        n = d.scaled(per_length)
        phi = g.mul(g.constant(0.5), g.sub(d.dot(n), length))
        drift = g.add((B.a - A.a).dot(n), g.mul(per_length, d_rate.dot(d_rate)))
        yield self._row(phi, d_rate.dot(n), -drift, [(B, n, None, 1), (A, n, None, -1)])

    def _coupling(self, coupling: Coupling) -> Iterator[Row]:
        """phi(q) = 0, differentiated twice along the motion (eq. 6a)."""
        g, lowering = self.g, self.kinematics.lowering
        phi = lowering.value(coupling.residual)
        (G,) = along(g, [phi], rates_per_speed(self.kinematics))
        rates = coordinate_rates(self.kinematics)
        rate = directional(g, [phi], rates)[0]
        for joint in (link.joint for link in self.kinematics.tree.links if link.joint.prescribed):
            rates |= zip(lowering.speeds_of(joint), lowering.rates_of(joint), strict=True)
        yield Row(phi, tuple(G), rate, -directional(g, [rate], rates)[0])

    # Rolling and sliding.

    def _edge(self, edge: KnifeEdge) -> Iterator[Row]:
        """Condition v . n = 0 for n fixed in the frame (eq. 7)."""
        B = self._state(edge.anchor)
        n = B.R.column(AXES.index(edge.axis))
        drift = self.g.add(B.a.dot(n), B.v.dot(B.w.cross(n)))
        yield self._row(ZERO, B.v.dot(n), -drift, [(B, n, None, 1)])

    def _rolling(self, rolling: Rolling) -> Iterator[Row]:
        """The contact point's velocity vanishes; so does its height (eqs. 8, 9)."""
        g = self.g
        B = self._state(rolling.anchor)
        radius, height = self.kinematics.lowering.value(rolling.radius), self.kinematics.lowering.value(rolling.height)
        up = Vec3.unit(g, 2)
        if rolling.shape == "sphere":
            r, r_rate, drop = -up.scaled(radius), Vec3(g), radius
        else:
            n = B.R.column(2)
            n_rate = B.w.cross(n)
            s = up - n.scaled(n.z)  # From the centre upwards in the plane of the disc.
            s_rate = -n.scaled(n_rate.z) - n_rate.scaled(n.z)
            size = g.sqrt(s.dot(s))
            unit = Vec3(g, *(g.div(x, size) for x in s))
            along = s_rate.dot(unit)
            unit_rate = Vec3(g, *(g.div(x, size) for x in s_rate - unit.scaled(along)))
            r, r_rate, drop = -unit.scaled(radius), -unit_rate.scaled(radius), g.mul(radius, size)
        contact = B.v + B.w.cross(r)
        drift = B.a + (B.alpha.cross(r) + B.w.cross(r_rate))
        for k, e in enumerate((Vec3.unit(g, 0), Vec3.unit(g, 1), up)):
            phi = g.sub(g.sub(B.p.z, height), drop) if k == 2 else ZERO
            yield self._row(phi, contact.dot(e), -drift.dot(e), [(B, e, r.cross(e), 1)])

    def _touching(self, touching: Touching) -> Iterator[Row]:
        """A ball or rim on a surface: its distance and the speed of its point of contact vanish (eqs. 38a to 38n)."""
        g, contact, lowering = self.g, touching.contact, self.kinematics.lowering
        S, B = self._state(touching.first), self._state(touching.second)
        radius, arm = lowering.value(contact.radius), B.R.times(lowering.vector(contact.points[touching.ball]))
        arm_rate, a = B.w.cross(arm), B.R.column(2)
        line = Line(B.p + arm, B.v + arm_rate, a, B.w.cross(a))
        reach = reach_of(lowering, contact, line, Triad(S.p, S.R, S.v, S.w))
        if reach is not None:
            arm, arm_rate = arm + reach.reach, arm_rate + reach.rate
        ball = RigidBall(contact, touching.ball, contact.ball_names[touching.ball])
        axes = surface_axes(lowering, ball, S.R, S.w, B.p + arm - S.p, B.v + arm_rate - S.v)
        n = axes.R_WC.column(2)
        rho = arm - n.scaled(radius)  # From the origins of the two frames to the point of contact.
        sigma = B.p + rho - S.p
        rho_rate = arm_rate - axes.normal_rate.scaled(radius)
        sigma_rate = B.v + rho_rate - S.v
        slip = B.v + B.w.cross(rho) - S.v - S.w.cross(sigma)
        drift = B.a + B.alpha.cross(rho) + B.w.cross(rho_rate) - S.a - S.alpha.cross(sigma) - S.w.cross(sigma_rate)
        for axis in touching.axes:
            t = axes.R_WC.column(axis)
            phi = g.sub(axes.distance, radius) if axis == 2 else ZERO
            turned = g.add(drift.dot(t), slip.dot(axes.w_WC_W.cross(t)))
            parts = [(B, t, rho.cross(t), 1), (S, t, sigma.cross(t), -1)]
            yield self._row(phi, slip.dot(t), -turned, parts)

    def _stated(self, constraint: Nonholonomic) -> Iterator[Row]:
        """A(q, t) v = b(q, t), differentiated along the motion (eq. 10)."""
        g, lowering = self.g, self.kinematics.lowering
        G = [ZERO] * self.nv
        for name, formula in constraint.coefficients:
            k = lowering.coordinates.speed_symbols.index(name)
            G[k] = g.add(G[k], lowering.value(formula))
        speeds = [g.input("v", k) for k in range(self.nv)]
        rate = g.sub(g.sum(g.mul(a, v) for a, v in zip(G, speeds, strict=True)), lowering.value(constraint.right))
        seeds = coordinate_rates(self.kinematics) | {lowering.symbol(TIME): ONE}
        yield Row(ZERO, tuple(G), rate, -directional(g, [rate], seeds)[0])

    def _row(self, phi: Edge, rate: Edge, gamma: Edge, parts: Sequence[_Part]) -> Row:
        """A row with its G: the sum of sign (f . J_v + n . J_w) over frames."""
        g: Graph = self.g
        row = [ZERO] * self.nv
        for frame, f, n, sign in parts:
            for k, column in enumerate(zip(*frame.J, strict=True)):
                if not any(column):  # A frame moves with its ancestors alone.
                    continue
                for vector, part in ((f, column[:3]), (n, column[3:])):
                    if vector is not None:
                        row[k] = g.add(row[k], sign * vector.dot(Vec3(g, *part)))
        return Row(phi, tuple(row), rate, gamma, tuple(Lever(frame.name, f, n, sign) for frame, f, n, sign in parts))


def retracted(kinematics: TreeKinematics) -> list[Edge]:
    """The coordinates after a small step along the manifold: q + N step, with quaternions normalised (nq).

    It leads where `Model.integrate` does but for terms of the second order, which Newton's method does not feel.
    """
    g, tree = kinematics.g, kinematics.tree
    q = [g.input("q", k) for k in range(len(tree.coordinates.q))]
    coordinates = dict(zip(q, q, strict=True))
    for k, rates in enumerate(rates_per_speed(kinematics)):
        for coordinate, rate in rates.items():
            coordinates[coordinate] = g.add(coordinates[coordinate], g.mul(rate, g.input("step", k)))
    for link in tree.links:
        if link.joint.traits.quasi_velocities and not link.joint.prescribed:
            components = q[link.q[0] + link.q[1] - 4 : link.q[0] + link.q[1]]
            quaternion = Quaternion.of(g, *(coordinates[edge] for edge in components))
            coordinates |= zip(components, quaternion.normalized, strict=True)
    return list(coordinates.values())


# A lever with its frame.
_Part = tuple[FrameState, Vec3 | None, Vec3 | None, int]
# Pairs (axis of A, axis of B, factor) of one condition.
_Pairs = tuple[tuple[int, int, float], ...]


def _conditions(blocked: Sequence[AxisName]) -> tuple[_Pairs, ...]:
    """Conditions whose rates at the closed configuration are the blocked components of the angular velocity."""
    which = [AXES.index(axis) for axis in blocked]
    conditions: list[_Pairs] = []
    for k in which:
        i, j = (k + 1) % 3, (k + 2) % 3
        if len(which) == 3:
            # 1/2 (R - R^T): regular up to a right angle.
            conditions.append(((j, i, 0.5), (i, j, -0.5)))
        elif len(which) == 2:
            # The free axis of B stays along that of A: it has no component along the other blocked axis.
            free = next(m for m in range(3) if m not in which)
            other = next(m for m in which if m != k)
            conditions.append(((other, free, 1.0 if (k, free, other) in _CYCLIC else -1.0),))
        else:
            conditions.append(((j, i, 1.0),))
    return tuple(conditions)


_CYCLIC = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
