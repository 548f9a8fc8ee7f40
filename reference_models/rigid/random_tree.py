"""Random mechanisms by seed: every joint kind, arbitrary axes, placements, inertias, branches, fixed bodies."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import symofros as sf

from ..rigid.point_masses import Triple, mass_and_center, moments_of_inertia

KINDS = ("revolute", "prismatic", "ball", "continuous", "fixed", "free")
# Joints whose partial velocities depend on q, and those that slide along the axis they turn about.
SERIES_KINDS = ("screw", "cylindrical", "universal", "planar")
MORE_KINDS = (*KINDS, *SERIES_KINDS, "general")


def random_tree(seed: int, n: int = 6, kinds: Sequence[str] = KINDS, noisy: bool = False) -> sf.System:
    """A mechanism of n bodies on a base; equal arguments give equal mechanisms.

    Args:
        seed: Of every choice.
        n: Number of bodies besides the base.
        kinds: Of joints, to be drawn from; repeat one to have it more often. The first body moves.
        noisy: Whether rotations and axes are stated with noise (`noisy_rotation`).
    """
    rng = np.random.default_rng(seed)
    rotation, axis = (noisy_rotation, _noisy_axis) if noisy else (random_rotation, _random_axis)
    bodies = [sf.RigidBody("base", frames=(sf.Frame("mount", _triple(rng.uniform(-1, 1, 3)), rotation(rng)),))]
    for i in range(n):
        parent = bodies[int(rng.integers(max(0, i - 1), i + 1))]
        kind = kinds[int(rng.integers(len(kinds)))] if i else next(k for k in kinds if k != "fixed")
        frame = parent.frames[int(rng.integers(len(parent.frames)))].name if rng.random() < 0.5 else None
        more: dict[str, Any] = _general_joint(rng, i) if kind == "general" else {}
        more |= {"axis2": _triple(rng.standard_normal(3))} if kind == "universal" else {}
        more |= {"pitch": 0.2} if kind == "screw" else {}
        more |= {"position": _triple(rng.uniform(-0.5, 0.5, 3)), "rotation": rotation(rng)}
        more |= {"axis": axis(rng), "actuated": kind != "fixed" and bool(rng.random() < 0.5)}
        joint = sf.Joint(f"q{i}", kind, parent.name, frame, **more)  # type: ignore[arg-type]
        tip = sf.Frame("tip", _triple(rng.uniform(-0.5, 0.5, 3)), rotation(rng))
        bodies.append(sf.RigidBody(f"b{i}", joint, random_inertia(rng, rotation), (tip,)))
    return sf.System(f"random_tree{seed}", tuple(bodies), gravity=_triple(rng.uniform(-10, 10, 3)))


def random_rotation(rng: np.random.Generator) -> sf.Rotation:
    """None, quarter turns, or anything, in every form a rotation may be stated in but a matrix."""
    choice = rng.integers(5)
    if choice == 0:
        return sf.Rotation()
    if choice == 1:
        return sf.Rotation.rpy(*map(float, rng.choice([0.0, np.pi / 2, -np.pi / 2, np.pi], 3)))
    if choice == 2:
        return sf.Rotation.quaternion(*map(float, rng.standard_normal(4)))
    if choice == 3:
        return sf.Rotation.axis_angle(_triple(rng.standard_normal(3)), float(rng.uniform(-3, 3)))
    return sf.Rotation.rpy(0.0, 0.0, float(rng.uniform(-3, 3)))


def noisy_rotation(rng: np.random.Generator) -> sf.Rotation:
    """A turn about a coordinate axis, or three, often by right angles, in every form, with noise of 1e-16 to 1e-6.

    As programs write rotations: products in single precision, few printed digits, right angles of long decimals.
    """
    right = rng.integers(-2, 3, 3) * (np.pi / 2)
    free = np.where(rng.permutation(3) == 0, rng.uniform(-3, 3), 0.0)
    angles = right + free if rng.random() < 0.7 else rng.uniform(-3, 3, 3)
    cosines, sines = np.cos(angles / 2), np.sin(angles / 2)
    # The quaternion of Rz(yaw) Ry(pitch) Rx(roll).
    a, b = cosines[1] * cosines[2], sines[1] * sines[2]
    c, d = sines[1] * cosines[2], cosines[1] * sines[2]
    q = np.array([sines[0] * a - cosines[0] * b, cosines[0] * c + sines[0] * d, cosines[0] * d - sines[0] * c])
    quaternion = np.append(q, cosines[0] * a + sines[0] * b)

    def stated(exact: np.ndarray) -> list[float]:
        noise = rng.uniform(-1, 1, exact.shape) * (rng.random(exact.shape) < 0.5)
        return list((exact + 10.0 ** rng.uniform(-16, -6.7) * noise).tolist())

    form = rng.integers(4)
    if form == 0:
        x, y, z, w = quaternion
        K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        rows = np.eye(3) + 2 * w * K + 2 * K @ K
        noisy = np.array(stated(rows)) if rng.random() < 0.5 else rows.astype(np.float32).astype(float)
        return sf.Rotation.matrix(noisy.tolist())
    if form == 1:
        return sf.Rotation.quaternion(*stated(quaternion * rng.choice([1.0, -3.0])))
    if form == 2:
        return sf.Rotation.rpy(*stated(angles))
    return sf.Rotation.axis_angle(stated(np.eye(3)[rng.integers(3)]), angles[0])


def random_inertia(
    rng: np.random.Generator, rotation: Callable[[np.random.Generator], sf.Rotation] = random_rotation
) -> sf.Inertia:
    """The inertia of a random cloud of points, so that it is physical."""
    points = rng.uniform(-0.3, 0.3, (6, 3))
    masses = rng.uniform(0.1, 1.0, 6)
    mass, center = mass_and_center(masses, points)
    if rng.random() < 0.3:
        return sf.Inertia(mass, center, moments_of_inertia(masses, points), about="body")
    # Along turned axes, the same numbers are another, equally physical, inertia.
    moments = moments_of_inertia(masses, points - np.array(center))
    return sf.Inertia(mass, center, moments, rotation=rotation(rng))


def _random_axis(rng: np.random.Generator) -> Triple:
    """A coordinate axis, of any length and sign, more often than not."""
    if rng.random() < 0.6:
        axis = np.zeros(3)
        axis[rng.integers(3)] = rng.choice([-1.0, 1.0, 2.0])
        return _triple(axis)
    return _triple(rng.standard_normal(3))


def _noisy_axis(rng: np.random.Generator) -> Triple:
    """An axis with noise of 1e-16 to 1e-6 in some of its entries."""
    noise = rng.standard_normal(3) * (rng.random(3) < 0.5)
    return _triple(np.array(_random_axis(rng)) + 10.0 ** rng.uniform(-16, -6) * noise)


def _general_joint(rng: np.random.Generator, i: int) -> dict[str, Any]:
    """The user's own R_PD(q), p_PD(q) in one of several forms."""
    a, b, c = (f"x{i}", f"y{i}", f"z{i}")
    forms: list[dict[str, Any]] = [
        # Euler angles and a translation: six coordinates.
        {
            "coordinates": (a, b, c, f"a{i}", f"b{i}", f"c{i}"),
            "moving_position": (a, b, c),
            "moving_rotation": sf.Rotation.rpy(f"a{i}", f"b{i}", f"c{i}"),
        },
        # A point on a helix, turned by a matrix.
        {
            "coordinates": (a,),
            "moving_position": (f"0.3*cos({a})", f"0.3*sin({a})", f"0.1*{a}"),
            "moving_rotation": sf.Rotation.matrix(
                [[f"cos(2*{a})", f"-sin(2*{a})", 0], [f"sin(2*{a})", f"cos(2*{a})", 0], [0, 0, 1]]
            ),
        },
        # A turn about an axis that is not a coordinate axis, coupled to a slide.
        {
            "coordinates": (a, b),
            "moving_position": (0, f"{a}*{b}", f"{b}^2"),
            "moving_rotation": sf.Rotation.axis_angle((1, 2, -1), f"{a} + sin({b})"),
        },
        # No turn at all.
        {"coordinates": (a, b), "moving_position": (f"sin({a})", f"{b}", f"{a}*{b}")},
    ]
    return forms[int(rng.integers(len(forms)))]


def _triple(values: np.ndarray) -> Triple:
    x, y, z = values.tolist()
    return x, y, z
