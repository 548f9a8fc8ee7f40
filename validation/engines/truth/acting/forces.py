"""Forces that a tree states of itself, in many digits: dampers, springs, gravity compensation, tendons, actuators.

With l(q) the length of a tendon and J its derivative along the speeds, e the force of an actuator at the control u or,
where it has one, the state w,

    Q = -d v - k (q - rest) + J_c^T (-gamma m g) + sum J^T (-k (l - rest) - d J v) + sum gear J^T e
    e = clip((gain + g1 gear l + g2 gear J v) (clip(u) or w) + b0 + b1 gear l + b2 gear J v)

where J_c is the Jacobian of a link's mass centre; of an actuator of a joint, l is its coordinate and J v its speed.
What actuators make together along a joint stays within the joint's limits.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ...interface import Actuator, End, Muscle, Tendon, Tree
from ..arithmetic import Exact, exact, rate, root, zeros
from ..kinematics import Kinematics
from .activations import clipped, driving
from .drag import drag


class Forces:
    """The forces of a tree.

    Args:
        tree: The tree.
        kinematics: Its kinematics.
    """

    def __init__(self, tree: Tree, kinematics: Kinematics) -> None:
        self.tree, self._kinematics, self._nv = tree, kinematics, kinematics.nv
        self.damping, self.stiffness, self.friction = zeros(self._nv), zeros(self._nv), zeros(self._nv)
        self.ranges, self.bounds, self.drives = zeros(self._nv, 2), zeros(self._nv, 2), zeros(self._nv, 3)
        self._limits: dict[int, tuple[float, ...]] = {}
        self._springs: list[tuple[int, int, Exact]] = []
        for k in range(len(tree.links)):
            for joint, slot in kinematics.joints(k):
                if slot is None:
                    continue
                if joint.force_limits:
                    self._limits[slot.v[0]] = joint.force_limits
                if joint.limits:
                    self.ranges[slot.v[0]] = exact(joint.limits)
                if joint.drive:
                    self.drives[slot.v[0]] = exact(joint.drive)
                if joint.bounds:
                    self.bounds[slot.v[0]] = exact(joint.bounds)
                self.friction[list(slot.v)] = exact(joint.friction)[()]
                self.damping[list(slot.v)] = exact(joint.damping)[()]
                if joint.stiffness:
                    self.stiffness[slot.v[0]] = exact(joint.stiffness)[()]
                    self._springs.append((slot.q[0], slot.v[0], exact(joint.rest)[()]))

    def offsets(self, q: Exact) -> Exact:
        """Coordinates of springs less those at rest (nv), zero where there is none."""
        offset = zeros(self._nv)
        for coordinate, speed, rest in self._springs:
            offset[speed] = q[coordinate] - rest
        return offset

    def heavy(self, q: Exact) -> list[tuple[Exact, Exact]]:
        """Armature and derivative of each tendon that has some."""
        heavy = (tendon for tendon in self.tree.tendons if tendon.armature)
        return [(exact(one.armature)[()], self._kinematics.line(q, one)[1]) for one in heavy]

    def lines(self, q: Exact) -> list[tuple[Exact, Exact]]:
        """Lengths and derivatives of all tendons."""
        return [self._kinematics.line(q, tendon) for tendon in self.tree.tendons]

    def transmissions(self, q: Exact) -> list[tuple[Exact, Exact]]:
        """Length and moment arms (nv) of each actuator, both with its gear."""
        made = []
        for actuator in self.tree.actuators:
            length, J = self._line(q, actuator)
            gear = exact(actuator.gear)[()]
            made.append((gear * length, gear * J))
        return made

    def _line(self, q: Exact, actuator: Actuator) -> tuple[Exact, Exact]:
        """Length and moment arms (nv) of an actuator, without its gear."""
        if not actuator.ends:
            return self._kinematics.line(q, self._line_of(actuator))
        if len(actuator.ends) == 1:
            frame, wrench = self._kinematics.held(q, actuator.ends[0]), exact(actuator.wrench)
            along = np.concatenate([frame.R @ wrench[:3], frame.R @ wrench[3:]])
            return exact(0.0)[()], along @ frame.J

        frame = self._kinematics.held(q, actuator.ends[1])
        apart, J = self._kinematics.seen(q, actuator.ends[0], frame)
        if not actuator.crank:
            along = exact(actuator.wrench[:3])
            return along @ apart, along @ J
        rod = exact(actuator.crank)[()]
        rest = root(apart[2] * apart[2] + rod * rod - apart @ apart)
        return apart[2] - rest, J[2] - (apart[2] * J[2] - apart @ J) / rest

    def _line_of(self, actuator: Actuator) -> Tendon:
        """The tendon that an actuator pulls; that of a joint is its coordinate."""
        if actuator.tendon is not None:
            return self.tree.tendons[actuator.tendon]
        return Tendon("coupling", (End(actuator.link),), (1.0,))

    def passive(self, q: Exact, v: Exact) -> Exact:
        """What springs, dampers, tendons and gravity compensation do (nv)."""
        Q = -self.damping * v - self.stiffness * self.offsets(q)
        for tendon, (length, J) in zip(self.tree.tendons, self.lines(q), strict=True):
            stiffness, damping, rest = exact((tendon.stiffness, tendon.damping, tendon.rest))
            Q = Q - J * (stiffness * (length - rest) + damping * (J @ v))
        for link in self.tree.links:
            if link.compensation:
                J = self._kinematics.held(q, End(link.name, p=link.com)).J
                weight = exact(link.mass)[()] * exact(self.tree.gravity)
                Q = Q - exact(link.compensation)[()] * (J[:3].T @ weight)
        return Q + drag(self._kinematics, self.tree.medium, q, v) if self.tree.medium else Q

    def pulls(self, q: Exact, v: Exact, a: Exact) -> list[tuple[str, Exact, Exact]]:
        """What straight tendons do to links, or to the world "": the link, the point (3), the force there (3).

        Of points x_k of a path with l = sum |x_k+1 - x_k|, the virtual work -T dl leaves x_k with the force
        T (u_k - u_k-1), where T is the tension, k (l - rest) + c l' + (armature) l'' less what actuators do, and u_k
        the direction from x_k to x_k+1, zero beyond the ends.

        Raises:
            ValueError: A tendon wraps around a surface, which pushes on its link besides.
        """
        if any(tendon.wraps for tendon in self.tree.tendons):
            raise ValueError("what a tendon does to a surface that it wraps around is not worked out")
        forces: list[tuple[str, Exact, Exact]] = []
        if not self.tree.tendons:
            return forces
        turning = self._kinematics.along(lambda at: np.array([J for _, J in self.lines(at)], dtype=object), q, v)
        driven = list(zip(self.tree.actuators, self.efforts(q, v), strict=True))
        for number, (tendon, (length, J)) in enumerate(zip(self.tree.tendons, self.lines(q), strict=True)):
            if tendon.kind != "path":  # A coupling acts along its joints.
                continue
            stiffness, damping, rest = exact((tendon.stiffness, tendon.damping, tendon.rest))
            tension = stiffness * (length - rest) + damping * (J @ v)
            tension = tension + exact(tendon.armature)[()] * (J @ a + turning[number] @ v)
            tension = tension - sum(exact(one.gear)[()] * force for one, force in driven if one.tendon == number)
            points = [self._kinematics.held(q, end).p for end in tendon.ends]
            steps = [after - before for before, after in pairwise(points)]
            along = [zeros(3), *(step / root(step @ step) for step in steps), zeros(3)]
            for end, point, before, after in zip(tendon.ends, points, along, along[1:], strict=False):
                forces.append((end.link, point, tension * (after - before)))
        return forces

    def stored(self, q: Exact) -> Exact:
        """Energy of springs along coordinates and tendons, zero where they have no force."""
        offsets = self.offsets(q)
        energy = self.stiffness @ (offsets * offsets) / 2
        for tendon, (length, _) in zip(self.tree.tendons, self.lines(q), strict=True):
            stiffness, rest = exact((tendon.stiffness, tendon.rest))
            energy = energy + stiffness * (length - rest) ** 2 / 2
        return energy

    def efforts(self, q: Exact, v: Exact) -> Exact:
        """The actuators' forces (nu)."""
        made = []
        for actuator, (length, J) in zip(self.tree.actuators, self.transmissions(q), strict=True):
            made.append(_effort(actuator, length, J @ v))
        return np.array(made, dtype=object)

    def actuated(self, q: Exact, v: Exact) -> Exact:
        """What the actuators do (nv)."""
        total = self._together(q, v)
        for place, limits in self._limits.items():
            total[place] = clipped(total[place], limits)
        return total

    def _together(self, q: Exact, v: Exact) -> Exact:
        """What the actuators do before joints bound it (nv)."""
        return sum(
            (e * J for e, (_, J) in zip(self.efforts(q, v), self.transmissions(q), strict=True)), zeros(self._nv)
        )

    def applied(self, q: Exact, v: Exact) -> Exact:
        """All of them (nv)."""
        return self.passive(q, v) + self.actuated(q, v) if self.tree.forces else zeros(self._nv)

    def is_saturated(self, number: int, q: Exact, v: Exact) -> bool:
        """Whether an actuator's force is at one of its limits."""
        limits = exact(self.tree.actuators[number].force_limits)
        return len(limits) > 0 and self.efforts(q, v)[number] in limits

    def metrics(self, q: Exact, v: Exact) -> tuple[Exact, Exact]:
        """-dQ/dv and the part of -dQ/dq that lengths alone make (nv, nv): dampers and springs, actuators among them."""
        D, K = np.array(np.diag(self.damping)), np.array(np.diag(self.stiffness))
        for tendon, (_, J) in zip(self.tree.tendons, self.lines(q), strict=True):
            square = np.outer(J, J)
            D, K = D + exact(tendon.damping)[()] * square, K + exact(tendon.stiffness)[()] * square
        made: list[tuple[Exact, Exact]] = []
        for number, (actuator, (_, J)) in enumerate(zip(self.tree.actuators, self.transmissions(q), strict=True)):
            if not self.is_saturated(number, q, v) and not actuator.is_disabled:
                b1, b2 = self._slopes(actuator, q, v, number)
                made.append((b1 * np.outer(J, J), b2 * np.outer(J, J)))
        bound = self._bound(q, v)
        for by_length, by_speed in made:
            by_length[bound], by_speed[bound] = zeros(self._nv), zeros(self._nv)
            D, K = D - by_speed, K - by_length
        return D, K

    def _bound(self, q: Exact, v: Exact) -> list[int]:
        """Speeds along which actuators together are at a limit of their joint."""
        total = self._together(q, v)
        sides = {place: exact(limits) for place, limits in self._limits.items()}
        return [place for place, (low, high) in sides.items() if not low < total[place] < high]

    def by_controls(self, q: Exact, v: Exact) -> Exact:
        """dQ/du of actuators without states (nv, nu); none of what is disabled or at a limit."""
        made = zeros(self._nv, len(self.tree.actuators))
        for number, (one, (length, J)) in enumerate(zip(self.tree.actuators, self.transmissions(q), strict=True)):
            control = exact(one.control)[()]
            if one.is_disabled or self.is_saturated(number, q, v) or control != clipped(control, one.control_limits):
                continue
            g1, g2 = exact(one.slopes)
            gain = exact(one.gain)[()] + g1 * length + g2 * (J @ v)
            if one.muscle is not None:
                pulls = [_pull(one.muscle, exact(driven)[()], length, J @ v) for driven in (0.0, 1.0)]
                gain = pulls[1] - pulls[0]
            made[:, number] = gain * J
        made[self._bound(q, v)] = zeros(len(self.tree.actuators))
        return made

    def _slopes(self, actuator: Actuator, q: Exact, v: Exact, number: int) -> tuple[Exact, Exact]:
        """The derivatives of an actuator's force by its length and by its speed."""
        if actuator.muscle is None:
            return tuple(exact(actuator.bias)[1:] + exact(actuator.slopes) * driving(actuator))
        length, J = self.transmissions(q)[number]
        at = np.array([length, J @ v], dtype=object)
        unit = exact(np.eye(2))
        by_length, by_speed = (
            rate(lambda one: np.array([_effort(actuator, *one)], dtype=object), at, unit[k])[0] for k in range(2)
        )
        return by_length, by_speed


def _effort(actuator: Actuator, length: Exact, speed: Exact) -> Exact:
    """The force of an actuator."""
    if actuator.is_disabled:
        return exact(0.0)[()]
    b0, b1, b2 = exact(actuator.bias)
    g1, g2 = exact(actuator.slopes)
    gain = exact(actuator.gain)[()] + g1 * length + g2 * speed
    effort = gain * driving(actuator) + b0 + b1 * length + b2 * speed
    if actuator.muscle is not None:
        driven = driving(actuator) if actuator.activation else exact(actuator.muscle.activation)[()]
        effort = _pull(actuator.muscle, driven, length, speed)
    return clipped(effort, actuator.force_limits)


def _pull(muscle: Muscle, driven: Exact, length: Exact, speed: Exact) -> Exact:
    """The force of a muscle: polynomials of degree two, piece by piece."""
    one, half = exact(1.0)[()], exact(0.5)[()]
    low, high = exact(muscle.operating)
    least, greatest = exact(muscle.lengths)
    unit = (greatest - least) / (high - low)
    L, V = low + (length - least) / unit, speed / (unit * exact(muscle.fastest)[()])
    below, above = exact(muscle.zeros)
    a, b = (below + one) / 2, (one + above) / 2
    if not below <= L <= above:
        active = 0 * one
    elif L <= a:
        active = half * ((L - below) / (a - below)) ** 2
    elif L <= one:
        active = one - half * ((one - L) / (one - a)) ** 2
    elif L <= b:
        active = one - half * ((L - one) / (b - one)) ** 2
    else:
        active = half * ((above - L) / (above - b)) ** 2
    top = exact(muscle.lengthening)[()]
    y = top - one
    if V <= -one:
        faster = 0 * one
    elif V <= 0:
        faster = (V + one) ** 2
    elif V <= y:
        faster = top - (y - V) ** 2 / y
    else:
        faster = top
    passive = 0 * one
    if L > one:
        x = (L - one) / (b - one)
        passive = exact(muscle.passive)[()] * (half * x * x if L <= b else x - half)
    return -exact(muscle.peak)[()] * (driven * active * faster + passive)
