"""Random mechanisms: every joint kind, arbitrary axes, placements, inertias, branches, fixed bodies."""

from __future__ import annotations

import numpy as np

import symofros as sf

KINDS = ("revolute", "prismatic", "ball", "continuous", "fixed", "free")
# Joints whose partial velocities depend on q, and those that slide along the axis they turn about.
MORE_KINDS = (*KINDS, "screw", "cylindrical", "universal", "planar", "general")


def general_joint(rng: np.random.Generator, i: int) -> dict[str, object]:
    """The user's own R_PD(q), p_PD(q) in one of several forms."""
    a, b, c = (f"x{i}", f"y{i}", f"z{i}")
    forms: list[dict[str, object]] = [
        # Euler angles and a translation: six coordinates.
        {"coordinates": (a, b, c, f"a{i}", f"b{i}", f"c{i}"), "moving_position": (a, b, c),
         "moving_rotation": sf.Rotation.rpy(f"a{i}", f"b{i}", f"c{i}")},
        # A point on a helix, turned by a matrix.
        {"coordinates": (a,), "moving_position": (f"0.3*cos({a})", f"0.3*sin({a})", f"0.1*{a}"),
         "moving_rotation": sf.Rotation.matrix([[f"cos(2*{a})", f"-sin(2*{a})", 0],
                                                [f"sin(2*{a})", f"cos(2*{a})", 0], [0, 0, 1]])},
        # A turn about an axis that is not a coordinate axis, coupled to a slide.
        {"coordinates": (a, b), "moving_position": (0, f"{a}*{b}", f"{b}^2"),
         "moving_rotation": sf.Rotation.axis_angle((1, 2, -1), f"{a} + sin({b})")},
        # No turn at all.
        {"coordinates": (a, b), "moving_position": (f"sin({a})", f"{b}", f"{a}*{b}")},
    ]  # fmt: skip
    return forms[int(rng.integers(len(forms)))]


def random_rotation(rng: np.random.Generator) -> sf.Rotation:
    choice = rng.integers(5)
    if choice == 0:
        return sf.Rotation()
    if choice == 1:
        return sf.Rotation.rpy(*rng.choice([0.0, np.pi / 2, -np.pi / 2, np.pi], 3))
    if choice == 2:
        return sf.Rotation.quaternion(*rng.standard_normal(4))
    if choice == 3:
        return sf.Rotation.axis_angle(rng.standard_normal(3), float(rng.uniform(-3, 3)))
    return sf.Rotation.rpy(0.0, 0.0, float(rng.uniform(-3, 3)))


def random_inertia(rng: np.random.Generator) -> sf.Inertia:
    """The inertia of a random cloud of points, so that it is physical."""
    points = rng.uniform(-0.3, 0.3, (6, 3))
    masses = rng.uniform(0.1, 1.0, 6)
    center = masses @ points / masses.sum()
    about_body = rng.random() < 0.3
    r = points if about_body else points - center
    J = sum(m * (p @ p * np.eye(3) - np.outer(p, p)) for m, p in zip(masses, r, strict=True))
    moments = (J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2])
    if about_body:
        return sf.Inertia(masses.sum(), center, moments, about="body")
    # Along turned axes, the same numbers are another, equally physical, inertia.
    return sf.Inertia(masses.sum(), center, moments, rotation=random_rotation(rng))


def random_axis(rng: np.random.Generator) -> tuple[float, ...]:
    if rng.random() < 0.6:
        axis = np.zeros(3)
        axis[rng.integers(3)] = rng.choice([-1.0, 1.0, 2.0])
        return tuple(axis)
    return tuple(rng.standard_normal(3))


def random_tree(seed: int, n: int = 6, kinds: tuple[str, ...] = KINDS) -> sf.System:
    """A mechanism of n bodies; equal seeds give equal mechanisms."""
    rng = np.random.default_rng(seed)
    bodies = [sf.RigidBody("base", frames=[sf.Frame("mount", rng.uniform(-1, 1, 3), random_rotation(rng))])]
    for i in range(n):
        parent = bodies[int(rng.integers(max(0, i - 1), i + 1))]
        kind = kinds[int(rng.integers(len(kinds)))] if i else next(k for k in kinds if k != "fixed")
        frame = parent.frames[int(rng.integers(len(parent.frames)))].name if rng.random() < 0.5 else None
        more = general_joint(rng, i) if kind == "general" else {}
        more |= {"axis2": tuple(rng.standard_normal(3))} if kind == "universal" else {}
        more |= {"pitch": 0.2} if kind == "screw" else {}
        joint = sf.Joint(
            f"q{i}", kind, parent.name, frame, rng.uniform(-0.5, 0.5, 3), random_rotation(rng), random_axis(rng),
            actuated=kind != "fixed" and bool(rng.random() < 0.5), **more,
        )  # fmt: skip
        frames = [sf.Frame("tip", rng.uniform(-0.5, 0.5, 3), random_rotation(rng))]
        bodies.append(sf.RigidBody(f"b{i}", joint, random_inertia(rng), frames))
    return sf.System(f"tree{seed}", bodies, gravity=rng.uniform(-10, 10, 3))


def parametrised(system: sf.System, seed: int = 0) -> sf.System:
    """The same mechanism with masses, positions and moments as run-time parameters."""
    parameters: list[sf.Parameter] = []

    def named(value: object) -> str:
        parameters.append(sf.Parameter(f"p{len(parameters)}", float(value)))  # type: ignore[arg-type]
        return parameters[-1].name

    bodies = []
    for body in system.bodies:
        inertia = body.inertia
        if inertia is not None:
            inertia = sf.Inertia(
                named(inertia.mass), tuple(map(named, inertia.center_of_mass)), tuple(map(named, inertia.moments)),
                inertia.about, inertia.rotation,
            )  # fmt: skip
        joint = body.joint
        if joint is not None:
            joint = sf.Joint(
                joint.name, joint.kind, joint.parent, joint.frame, tuple(map(named, joint.position)), joint.rotation,
                joint.axis, joint.actuated,
            )  # fmt: skip
        bodies.append(sf.RigidBody(body.name, joint, inertia, body.frames))
    return sf.System(system.name, bodies, parameters, gravity=system.gravity)
