"""A free body that touches the ground, as every engine is asked to move it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.spatial.transform import Rotation

from .geometry import Array

GRAVITY = 9.81
# Distance of the points by which poses are compared [m].
_ARM = 0.1


@dataclass(frozen=True)
class TouchingBody:
    """A body, what it touches, and how it is thrown.

    Attributes:
        mass: Mass [kg].
        moments: Moments of inertia about the mass centre, along its axes (3) [kg m^2].
        friction: Coefficient of Coulomb's friction.
        p: Its place at the start (3) [m].
        v: Its velocity at the start (3) [m/s].
        w: Its angular velocity at the start, in world axes (3) [rad/s].
        end: Duration [s].
        radius: Radius of its balls, of the capsule or of the cylinder [m].
        turn: Its rotation vector at the start (3) [rad].
        shape: What touches: balls or a cylinder on the plane z = 0, or a capsule on a capsule that lies along y.
        points: Centres of the balls [m].
        half: Half the length of the cylinder, or between the centres of the capsule's ends [m].
        log: Radius and length of the capsule that lies [m].
        stiffness: Of a compliant contact, linear in the depth [N/m]; 0: the contact is rigid.
        restitution: Of a rigid contact.
        strikes: Whether a rigid contact begins at a speed: then engines' contacts are damped beyond the critical rate.
        dissipation: Share of the force that a speed of approach adds [s/m].
    """

    mass: float
    moments: tuple[float, float, float]
    friction: float
    p: tuple[float, float, float]
    v: tuple[float, float, float]
    w: tuple[float, float, float]
    end: float
    radius: float
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0)
    shape: Literal["balls", "cylinder", "capsule"] = "balls"
    points: tuple[tuple[float, float, float], ...] = ((0.0, 0.0, 0.0),)
    half: float = 0.0
    log: tuple[float, float] = (0.0, 0.0)
    stiffness: float = 0.0
    restitution: float = 0.0
    strikes: bool = False
    dissipation: float = 0.0

    @property
    def R(self) -> Array:
        """Rotation at the start."""
        return np.asarray(Rotation.from_rotvec(self.turn).as_matrix())

    @property
    def xyzw(self) -> Array:
        """The same as a quaternion."""
        return np.asarray(Rotation.from_rotvec(self.turn).as_quat())


@dataclass(frozen=True)
class Pose:
    """Place (3) [m] and rotation (3, 3) of the body at the end."""

    p: Array
    R: Array

    def far(self, other: Pose) -> float:
        """Largest distance of the two bodies' origins, and of points 0.1 m along their axes [m]."""
        here, there = (np.vstack([one.p, one.p + _ARM * one.R.T]) for one in (self, other))
        return float(np.linalg.norm(here - there, axis=1).max())
