"""Loads on bodies, connections and contacts between frames, as wrenches on links (docs/theory/rigid.md, section 10)."""

from __future__ import annotations

from symofros.description.beams.beam import Beam
from symofros.description.contacts import Contact
from symofros.description.forces import Connection, Load
from symofros.description.system import RigidBody
from symofros.expr.edges import ZERO, Edge
from symofros.expr.vector import Mat3, Vec3
from symofros.mechanics.dynamics.applied.contacts import touching_balls
from symofros.mechanics.kinematics.frames import FrameKinematics
from symofros.mechanics.kinematics.links import TreeKinematics
from symofros.mechanics.spatial.wrench import Wrench, no_wrench
from symofros.mechanics.topology.tree import BASE, NamedFrame, Step, frame_of


def wrenches(kinematics: TreeKinematics, frames: FrameKinematics) -> list[Wrench] | None:
    """Wrench of loads, connections and contacts on each link; None if nothing acts."""
    total = [no_wrench(kinematics.g) for _ in kinematics.links]
    acting = False
    for body in kinematics.tree.system.bodies:
        if isinstance(body, Beam):
            continue  # Its loads also act on its elastic coordinates.
        for load in body.loads:
            frame = frame_of(kinematics.tree, body.name)
            if frame.link != BASE:
                total[frame.link] = total[frame.link] + _load(kinematics, frames, body, frame, load)
                acting = True
    for connection in kinematics.tree.system.connections:
        acting = True
        ends = [frame_of(kinematics.tree, *anchor) for anchor in (connection.first, connection.second)]
        for frame, wrenches_on in zip(ends, _between(kinematics, frames, connection, ends), strict=True):
            if frame.link != BASE:
                for force, torque in wrenches_on:
                    total[frame.link] = total[frame.link] + at_frame(kinematics, frames, frame, force, torque)
    return total if acting else None


def _between(
    kinematics: TreeKinematics, frames: FrameKinematics, connection: Connection | Contact, ends: list[NamedFrame]
) -> tuple[list[tuple[Vec3, Vec3]], list[tuple[Vec3, Vec3]]]:
    """Forces and torques at the origins of the two frames, in world axes."""
    if isinstance(connection, Connection):
        force, none = _Line(kinematics, frames, connection).force(), Vec3(kinematics.g)
        return [(force, none)], [(-force, none)]
    balls = touching_balls(kinematics, frames, connection)
    first, second = (frames.pose(end).p_WF for end in ends)
    on_first = [(ball.force, (ball.point - first).cross(ball.force)) for ball in balls]
    return on_first, [(-ball.force, (ball.point - second).cross(-ball.force)) for ball in balls]


def _load(
    kinematics: TreeKinematics, frames: FrameKinematics, body: RigidBody, frame: NamedFrame, load: Load
) -> Wrench:
    """A load's wrench about its link's origin."""
    force, torque = kinematics.lowering.vector(load.force), kinematics.lowering.vector(load.torque)
    if load.at == "center_of_mass":
        assert body.inertia is not None
        step = Step(body.inertia.center_of_mass, body.inertia.rotation)
        frame = NamedFrame("", "", frame.link, (*frame.placement, step))
        if load.axes == "body":
            # Components along the body's axes, also where the mass-centre frame is turned.
            R_LB, _ = kinematics.lowering.placement(frame.placement[:-1], kinematics.in_link(frame.link))
            return _in_link(kinematics, frame, R_LB.times(force), R_LB.times(torque))
    elif load.at != "body":
        frame = kinematics.tree.frame(f"{body.name}.{load.at}")
    if load.axes == "world":
        return at_frame(kinematics, frames, frame, force, torque)
    R_LF, _ = kinematics.lowering.placement(frame.placement, kinematics.in_link(frame.link))
    return _in_link(kinematics, frame, R_LF.times(force), R_LF.times(torque))


def at_frame(
    kinematics: TreeKinematics, frames: FrameKinematics, frame: NamedFrame, force: Vec3, torque: Vec3
) -> Wrench:
    """The wrench about Lo of a force at a frame's origin and a torque, both in world axes; in link axes."""
    R_WL: Mat3 = frames.link_pose(frame.link).R_WF
    return _in_link(kinematics, frame, R_WL.T.times(force), R_WL.T.times(torque))


def _in_link(kinematics: TreeKinematics, frame: NamedFrame, force: Vec3, torque: Vec3) -> Wrench:
    """The wrench about Lo of a force at a frame's origin and a torque, both in link axes."""
    _, p_LF = kinematics.lowering.placement(frame.placement, kinematics.in_link(frame.link))
    return Wrench(force, torque + p_LF.cross(force))


class _Line:
    """The line from the first frame of a connection to the second."""

    def __init__(self, kinematics: TreeKinematics, frames: FrameKinematics, connection: Connection) -> None:
        self.g = kinematics.g
        self.kinematics, self.frames, self.connection = kinematics, frames, connection
        self.ends = [frame_of(kinematics.tree, *anchor) for anchor in (connection.first, connection.second)]
        self.d = frames.pose(self.ends[1]).p_WF - frames.pose(self.ends[0]).p_WF
        self.stiffness = kinematics.lowering.value(connection.stiffness)
        self.rest = kinematics.lowering.value(connection.length)

    def force(self) -> Vec3:
        """The force on the first frame, in world axes: along the line, towards the second when stretched.

        Without a rest length the spring's force is k d, and the damper's c times the relative velocity: both regular
        where the ends meet.
        """
        g = self.g
        damping = self.kinematics.lowering.value(self.connection.damping)
        velocity = Vec3(g)
        if damping != ZERO:
            v = [Vec3(g, *self.frames.velocity(end)[:3]) for end in self.ends]
            velocity = v[1] - v[0]
        if self.rest == ZERO:
            return self.d.scaled(self.stiffness) + velocity.scaled(damping)
        length = g.sqrt(self.d.dot(self.d))
        unit = Vec3(g, *(g.div(edge, length) for edge in self.d))
        pull = g.add(g.mul(self.stiffness, g.sub(length, self.rest)), g.mul(damping, velocity.dot(unit)))
        return unit.scaled(pull)

    def energy(self) -> Edge:
        """1/2 k (length - rest)^2."""
        g = self.g
        square = self.d.dot(self.d)
        if self.rest != ZERO:
            stretch = g.sub(g.sqrt(square), self.rest)
            square = g.mul(stretch, stretch)
        return g.mul(g.mul(g.constant(0.5), self.stiffness), square)


def connection_energy(kinematics: TreeKinematics, frames: FrameKinematics) -> Edge:
    """The energy that connections and contacts store."""
    system = kinematics.tree.system
    parts = [_Line(kinematics, frames, spring).energy() for spring in system.springs]
    parts += [ball.energy for contact in system.contacts for ball in touching_balls(kinematics, frames, contact)]
    return kinematics.g.sum(parts)
