"""MSS: the station's large arm (SSRMS) with the two-armed manipulator (SPDM) on its tip, 22 rigid degrees of freedom.

The paper's introduction gives the structure: seven joints in the large arm, a rotating joint, two arms of seven joints;
17 m and 3.4 m long. It prints no parameters. Lengths follow the arm's published layout in round figures; masses and
inertias are ours, of uniform tubes and boxes of plausible weight.
"""

from __future__ import annotations

import symofros as sf

# Axis of each joint in turn: shoulder roll, yaw, pitch; elbow pitch; wrist pitch, yaw, roll.
AXES = ("x", "z", "y", "y", "y", "z", "x")
UNIT = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
# Length along x [m] and mass [kg] of each link.
SSRMS = ((0.4, 105.0), (0.4, 105.0), (7.1, 315.0), (7.1, 280.0), (0.4, 105.0), (0.4, 105.0), (0.6, 243.0))
SPDM = ((0.2, 40.0), (0.2, 40.0), (1.3, 75.0), (1.3, 65.0), (0.15, 30.0), (0.15, 30.0), (0.3, 50.0))


def _tube(name: str, joint: sf.Joint, length: float, mass: float) -> sf.RigidBody:
    """A uniform tube along x, of radius an eighth of its length but 0.2 m at most, with its end as extremity frame."""
    radius = min(0.2, length / 8)
    axial, across = mass * radius**2, mass * (radius**2 / 2 + length**2 / 12)
    inertia = sf.Inertia(mass, (length / 2, 0.0, 0.0), (axial, across, across))
    return sf.RigidBody(name, joint, inertia, (sf.Frame("end", (length, 0.0, 0.0)),))


def _arm(prefix: str, parent: str, frame: str | None, links: tuple[tuple[float, float], ...]) -> list[sf.RigidBody]:
    """Seven links in series."""
    bodies: list[sf.RigidBody] = []
    for i, ((length, mass), axis) in enumerate(zip(links, AXES, strict=True)):
        joint = sf.Joint(f"{prefix}_q{i + 1}", "revolute", parent, frame, axis=UNIT[axis], actuated=True)
        bodies.append(_tube(f"{prefix}_link{i + 1}", joint, length, mass))
        parent, frame = bodies[-1].name, "end"
    return bodies


def two_arm_bodies(parent: str, frame: str | None) -> list[sf.RigidBody]:
    """The SPDM: a body that rolls on its mount, and an arm on each side."""
    joint = sf.Joint("spdm_roll", "revolute", parent, frame, axis=UNIT["x"], actuated=True)
    sides = (
        sf.Frame("left", (0.6, 0.5, 0.0), sf.Rotation.rpy(0.0, 0.0, "pi/2")),
        sf.Frame("right", (0.6, -0.5, 0.0), sf.Rotation.rpy(0.0, 0.0, "-pi/2")),
    )
    trunk = sf.RigidBody("spdm_body", joint, sf.Inertia(300.0, (0.4, 0.0, 0.0), (60.0, 90.0, 90.0)), sides)
    return [trunk, *(body for side in sides for body in _arm(f"spdm_{side.name}", "spdm_body", side.name, SPDM))]


def ssrms() -> sf.System:
    """The large arm alone, seven joints; weightless."""
    return sf.System("ssrms", tuple(_arm("ssrms", "world", None, SSRMS)), gravity=(0.0, 0.0, 0.0))


def spdm() -> sf.System:
    """The two-armed manipulator alone, fifteen joints; weightless."""
    return sf.System("spdm", tuple(two_arm_bodies("world", None)), gravity=(0.0, 0.0, 0.0))


def mss() -> sf.System:
    """SSRMS, SPDM body, two SPDM arms; weightless, as on orbit."""
    large = _arm("ssrms", "world", None, SSRMS)
    return sf.System("mss", (*large, *two_arm_bodies(large[-1].name, "end")), gravity=(0.0, 0.0, 0.0))
