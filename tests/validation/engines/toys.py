"""A toy engine in NumPy, right but for one planted fault each; in a module that does not import the harness."""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]
FAULTS = ("", "stale", "at zero", "fast", "now and then", "forgets", "breaks", "internal", "refuses", "refuses shapes")


def turn(axis: Array, angle: float) -> Array:
    K = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K)


class Engine:
    """A body on a hinge through the origin: axis, mass, mass centre, inertia about it."""

    calls = 0

    def __init__(self, axis: Any, mass: float, com: Any, inertia: Any, gravity: Any, fault: str) -> None:
        self.axis, self.mass, self.com, self.gravity = np.array(axis), mass, np.array(com), np.array(gravity)
        self.moment = self.axis @ np.array(inertia) @ self.axis + mass * np.sum(np.cross(self.axis, self.com) ** 2)
        self.fault, self.angle = fault, 0.0

    def weight(self, q: float, v: float) -> Array:
        """Generalised force of gravity."""
        Engine.calls += 1
        angle, self.angle = (self.angle if self.fault == "stale" and self.angle else q), q
        arm = turn(self.axis, angle) @ self.com
        force = np.array([-self.mass * self.axis @ np.cross(arm, self.gravity)])
        if (self.fault == "at zero" and q == 0.0) or (self.fault == "fast" and abs(v) > 10.0):
            return force * 1.01
        if self.fault == "now and then" and Engine.calls % 50 == 49:
            return force * np.nan
        if self.fault == "forgets" and Engine.calls % 2:  # By less than rounding explains.
            return force * (1.0 + 2.0**-51)
        if self.fault == "breaks":
            return np.asarray([force, force][self._place()])
        if self.fault == "internal":
            raise ValueError("shapes (6, 1) and (12, 1) don't match")
        if self.fault == "refuses":
            raise ValueError("hinges with a mass are not supported")
        if self.fault == "refuses shapes":
            raise ValueError("a link with collision shapes is not supported")
        return force

    def _place(self) -> int:
        return 2
