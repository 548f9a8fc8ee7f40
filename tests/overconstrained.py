"""Closed mechanisms whose conditions repeat each other on the constraints only, with their motions in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import quad

import symofros as sf
from symofros.runtime.calls.kernel import Array


@dataclass(frozen=True)
class Bennett:
    """Bennett's linkage: four hinges, opposite links alike, sin(alpha) / a = sin(beta) / b.

    Bennett (1903), "A new mechanism", Engineering 76. G has 2 independent rows on the constraints and 3 beside them.

    Attributes:
        a: Length of the first and the third link [m].
        alpha: Their twist [rad].
        beta: Twist of the second and of the ground [rad].
        masses: Of the three moving links [kg].
    """

    a: float = 1.0
    alpha: float = 0.7
    beta: float = 1.3
    masses: tuple[float, float, float] = (1.0, 0.7, 1.3)

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Bennett:
        """A loop of random proportions and masses."""
        alpha, beta = float(rng.uniform(0.3, 1.0)), float(rng.uniform(1.2, 1.9))
        first, second, third = rng.uniform(0.3, 2.0, 3).tolist()
        return cls(float(rng.uniform(0.5, 2.0)), alpha, beta, (first, second, third))

    @property
    def b(self) -> float:
        """Length of the second link and of the ground."""
        return float(self.a * np.sin(self.beta) / np.sin(self.alpha))

    def system(self) -> sf.System:
        """Three moving links and a closure of five conditions; no gravity."""
        lengths, twists = (self.a, self.b, self.a), (self.alpha, self.beta, self.alpha)
        bodies: list[sf.Body] = [
            sf.RigidBody("ground", frames=(sf.Frame("last", (-self.b, 0, 0), sf.Rotation.rpy(-self.beta, 0, 0)),))
        ]
        for k, (length, twist, mass) in enumerate(zip(lengths, twists, self.masses, strict=True)):
            parent = ("world", None) if k == 0 else (f"link{k}", "end")
            joint = sf.Joint(f"q{k + 1}", "revolute", *parent, axis=(0, 0, 1))
            inertia = sf.Inertia(
                mass, (0.5 * length, 0.1 * length, 0.05 * length), tuple(mass * length**2 * np.array([0.02, 0.1, 0.11]))
            )
            bodies.append(
                sf.RigidBody(
                    f"link{k + 1}", joint, inertia, (sf.Frame("end", (length, 0, 0), sf.Rotation.rpy(twist, 0, 0)),)
                )
            )
        closure = sf.Closure("hinge4", ("ground", "last"), ("link3", "end"), ("x", "y", "z"), ("x", "y"))
        return sf.System("bennett", tuple(bodies), constraints=(closure,), gravity=(0, 0, 0))

    def posture(self, angle: float) -> Array:
        """The closed posture with the first hinge at an angle: tan(q1/2) tan(q2/2) is constant, q3 = -q1."""
        ratio = np.sin(0.5 * (self.beta + self.alpha)) / np.sin(0.5 * (self.beta - self.alpha))
        second = 2.0 * np.arctan2(ratio * np.cos(0.5 * angle), np.sin(0.5 * angle))
        return np.array([angle, second, -angle])

    def speeds(self, angle: float, rate: float) -> Array:
        """Speeds of the closed motion."""
        ratio = np.sin(0.5 * (self.beta + self.alpha)) / np.sin(0.5 * (self.beta - self.alpha))
        c, s = np.cos(0.5 * angle), np.sin(0.5 * angle)
        return np.array([1.0, -ratio / (s * s + (ratio * c) ** 2), -1.0]) * rate

    def late(self, model: sf.Model, start: float, rate: float, end: float, t: float) -> float:
        """Angle that the first hinge is off by at time t, if it is at `end`: the kinetic energy stays what it was.

        Args:
            model: The compiled system.
            start: Angle of the first hinge at time 0 [rad].
            rate: Its speed then [rad/s].
            end: Its angle at time t [rad].
            t: Time [s].
        """

        def inertia(angle: float) -> float:
            speeds = self.speeds(angle, 1.0)
            return float(speeds @ model.mass_matrix(self.posture(angle)) @ speeds)

        first = inertia(start)
        reached, _ = quad(lambda angle: np.sqrt(inertia(angle) / first) / rate, start, end, epsabs=1e-11, limit=500)
        return float((reached - t) * rate * np.sqrt(first / inertia(end)))


_BAR = sf.Inertia(0.8, (0.25, 0.0, 0.0), (0.002, 0.02, 0.02))
_TOP = sf.Inertia(1.5, (0.0, 0.0, 0.05), (0.03, 0.03, 0.05))


def sarrus(by_slide: bool) -> sf.System:
    """Sarrus' linkage: two chains of three hinges in planes at right angles hold a platform that moves up and down.

    Sarrus (1853). As it is, five conditions of rank four; by a slide instead, two conditions a chain and no more than
    it needs.

    Args:
        by_slide: Whether the platform is on a vertical slide, to which both chains are closed.
    """
    bodies: list[sf.Body] = []
    ends = {"a": (1.0, 0.0), "b": (0.0, 1.0)}
    for name, (x, y) in ends.items():
        turned = sf.Rotation("matrix", (x, -y, 0, y, x, 0, 0, 0, 1))
        foot = sf.Joint(f"{name}1", "revolute", position=(0.2 * x, 0.2 * y, 0), rotation=turned, axis=(0, -1, 0))
        bodies.append(sf.RigidBody(f"{name}1", foot, _BAR, (sf.Frame("end", (0.5, 0, 0)),)))
        knee = sf.Joint(f"{name}2", "revolute", parent=f"{name}1", frame="end", axis=(0, -1, 0))
        bodies.append(sf.RigidBody(f"{name}2", knee, _BAR, (sf.Frame("end", (0.5, 0, 0)),)))
    rims = tuple(
        sf.Frame(name, (0.2 * x, 0.2 * y, 0.0), sf.Rotation("matrix", (x, -y, 0, y, x, 0, 0, 0, 1)))
        for name, (x, y) in ends.items()
    )
    if by_slide:
        bodies.append(sf.RigidBody("top", sf.Joint("z", "prismatic", axis=(0, 0, 1)), _TOP, rims))
        closures = tuple(sf.Closure(f"hinge{n}", ("top", n), (f"{n}2", "end"), ("x", "z")) for n in ends)
        return sf.System("slide", tuple(bodies), constraints=closures)
    wrist = sf.Joint("a3", "revolute", parent="a2", frame="end", axis=(0, -1, 0))
    # The rim is where the hinge is, the platform's origin beside it.
    center = sf.Inertia(_TOP.mass, (-0.2, 0.0, 0.05), _TOP.moments)
    frames = (sf.Frame("b", (-0.2, 0.2, 0.0), sf.Rotation("matrix", (0, -1, 0, 1, 0, 0, 0, 0, 1))),)
    bodies.append(sf.RigidBody("top", wrist, center, frames))
    closure = sf.Closure("hingeb", ("top", "b"), ("b2", "end"), ("x", "y", "z"), ("x", "z"))
    return sf.System("sarrus", tuple(bodies), constraints=(closure,))
