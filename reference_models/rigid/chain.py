"""A generic 3-D chain: the worst case of a serial mechanism, for operation counts and growth with n."""

from __future__ import annotations

import numpy as np

import symofros as sf

from ..rigid.point_masses import mass_and_center, moments_of_inertia

AXES = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
INERTIAL = ("m", "cx", "cy", "cz", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
OFFSETS = ("lx", "ly", "lz")


def chain(n: int, symbolic: bool = True) -> sf.System:
    """Link n bodies by revolute joints about z, y, x in turn, each with ten inertial parameters and a full offset.

    Args:
        n: Number of links.
        symbolic: Inertias and offsets are run-time parameters; otherwise numbers in the code.

    Returns:
        A system with plausible values, seeded by the number of the link, so that longer chains extend shorter ones.
    """
    parameters: list[sf.Parameter] = []
    bodies: list[sf.RigidBody] = []
    for i in range(n):
        numbers = _link_numbers(i)
        parameters += [sf.Parameter(f"{name}{i + 1}", value, constant=not symbolic) for name, value in numbers.items()]
        names = {name: sf.formula(f"{name}{i + 1}") for name in numbers}
        inertia = sf.Inertia(
            names["m"],
            (names["cx"], names["cy"], names["cz"]),
            (names["Ixx"], names["Iyy"], names["Izz"], names["Ixy"], names["Ixz"], names["Iyz"]),
            about="body",
        )
        offset = (names["lx"], names["ly"], names["lz"])
        joint = sf.Joint(
            f"q{i + 1}", "revolute", f"link{i}" if i else "world", position=offset, axis=AXES[i % 3], actuated=True
        )
        bodies.append(sf.RigidBody(f"link{i + 1}", joint, inertia))
    return sf.System(f"chain{n}", tuple(bodies), tuple(parameters))


def _link_numbers(i: int) -> dict[str, float]:
    """Inertia of a cloud of points about the joint, so that it is physical, and the offset of the next joint."""
    rng = np.random.default_rng(1000 + i)
    points, masses = rng.uniform(-0.2, 0.2, (8, 3)), rng.uniform(0.05, 0.4, 8)
    mass, center = mass_and_center(masses, points)
    values = [mass, *center, *moments_of_inertia(masses, points), *rng.uniform(0.1, 0.3, 3)]
    return {name: float(value) for name, value in zip(INERTIAL + OFFSETS, values, strict=True)}
