"""Forces that a tree states of itself, in many digits: dampers, springs, compensated weights, tendons, actuators.

With l(q) the length of a tendon and J its derivative along the speeds, e the force of an actuator at the control u,

    Q = -d v - k (q - rest) + J_c^T (-gamma m g) + sum J^T (-k (l - rest) - d J v) + sum gear J^T e
    e = clip(gain clip(u) + b0 + b1 gear l + b2 gear J v)

where J_c is the Jacobian of a link's mass centre; of an actuator of a joint, l is its coordinate and J v its speed.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..interface import Actuator, End, Tendon, Tree
from .arithmetic import Exact, exact, zeros
from .kinematics import Kinematics


class Forces:
    """The forces of a tree.

    Args:
        tree: The tree.
        kinematics: Its kinematics.
    """

    def __init__(self, tree: Tree, kinematics: Kinematics) -> None:
        self.tree, self._kinematics, self._nv = tree, kinematics, kinematics.nv
        self.damping, self.stiffness = zeros(self._nv), zeros(self._nv)
        self._springs: list[tuple[int, int, Exact]] = []
        for k in range(len(tree.links)):
            for joint, slot in kinematics.joints(k):
                if slot is None or not (joint.damping or joint.stiffness):
                    continue
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

    def lines(self, q: Exact) -> list[tuple[Exact, Exact]]:
        """Lengths and derivatives of all tendons."""
        return [self._kinematics.line(q, tendon) for tendon in self.tree.tendons]

    def transmissions(self, q: Exact) -> list[tuple[Exact, Exact]]:
        """For each actuator, its length and moment arms (nv), both with its gear."""
        made = []
        for actuator in self.tree.actuators:
            length, J = self._kinematics.line(q, self._line_of(actuator))
            gear = exact(actuator.gear)[()]
            made.append((gear * length, gear * J))
        return made

    def _line_of(self, actuator: Actuator) -> Tendon:
        """The tendon that an actuator pulls; that of a joint is its coordinate."""
        if actuator.tendon is not None:
            return self.tree.tendons[actuator.tendon]
        return Tendon("coupling", (End(actuator.link),), (1.0,))

    def passive(self, q: Exact, v: Exact) -> Exact:
        """What springs, dampers, tendons and compensated weights do (nv)."""
        Q = -self.damping * v - self.stiffness * self.offsets(q)
        for tendon, (length, J) in zip(self.tree.tendons, self.lines(q), strict=True):
            stiffness, damping, rest = exact((tendon.stiffness, tendon.damping, tendon.rest))
            Q = Q - J * (stiffness * (length - rest) + damping * (J @ v))
        for link in self.tree.links:
            if link.compensation:
                J = self._kinematics.held(q, End(link.name, p=link.com)).J
                weight = exact(link.mass)[()] * exact(self.tree.gravity)
                Q = Q - exact(link.compensation)[()] * (J[:3].T @ weight)
        return Q

    def efforts(self, q: Exact, v: Exact) -> Exact:
        """The actuators' forces (nu)."""
        made = []
        for actuator, (length, J) in zip(self.tree.actuators, self.transmissions(q), strict=True):
            b0, b1, b2 = exact(actuator.bias)
            control = _clipped(exact(actuator.control)[()], exact(actuator.control_limits))
            effort = exact(actuator.gain)[()] * control + b0 + b1 * length + b2 * (J @ v)
            made.append(_clipped(effort, exact(actuator.force_limits)))
        return np.array(made, dtype=object)

    def actuated(self, q: Exact, v: Exact) -> Exact:
        """What the actuators do (nv)."""
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
        for number, (actuator, (_, J)) in enumerate(zip(self.tree.actuators, self.transmissions(q), strict=True)):
            if not self.is_saturated(number, q, v):
                _, b1, b2 = exact(actuator.bias)
                D, K = D - b2 * np.outer(J, J), K - b1 * np.outer(J, J)
        return D, K


def _clipped(value: Exact, limits: Iterable[Exact]) -> Exact:
    """A number within limits; without any, as it is."""
    low, high = tuple(limits) or (value, value)
    return min(max(value, low), high)
