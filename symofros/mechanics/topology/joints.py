"""Checks of joints: efforts, limits, general joints, rotors, prescribed motion."""

from __future__ import annotations

from collections.abc import Collection, Iterator

import numpy as np

from symofros.description.joints.joint import WORLD, Joint
from symofros.errors import Problem, did_you_mean
from symofros.mechanics.topology.coordinates import coordinate_symbols, joint_sizes
from symofros.mechanics.topology.formulas import element_problems
from symofros.mechanics.topology.numbers import ROTATION_TOLERANCE, Numbers

_MAX_GENERAL = 6
_SAMPLES = 20


def joint_problems(joint: Joint, bodies: Collection[str], where: str) -> Iterator[Problem]:
    """Faults that need no numbers.

    Args:
        joint: The joint as described.
        bodies: Names of all bodies.
        where: "file:line".
    """
    nv = joint_sizes(joint)[1]
    if joint.effort and len(joint.effort) != nv:
        yield Problem(
            f"joint '{joint.name}': wrong number of efforts",
            f"{len(joint.effort)} efforts",
            f"a {joint.kind} joint has {nv} speeds, and one effort for each",
            "list one formula a speed, 0 where there is none",
            where,
        )
    if joint.actuated and nv == 0:
        yield Problem(
            f"joint '{joint.name}': a fixed joint is actuated",
            "actuated: true",
            "only a joint that moves can be actuated",
            "drop the entry",
            where,
        )
    limits = joint.limits
    if limits and limits.lower is not None and limits.upper is not None and limits.lower > limits.upper:
        yield Problem(
            f"joint '{joint.name}': limits crossed",
            f"lower {limits.lower}, upper {limits.upper}",
            "lower <= upper",
            "swap them",
            where,
        )
    forces = [name for name in ("actuated", "effort", "elements") if getattr(joint, name)]
    if joint.prescribed and forces:
        yield Problem(
            f"joint '{joint.name}': forces on a prescribed motion",
            f"prescribed, and {', '.join(forces)}",
            "a motion that is given is not moved by forces",
            f"drop {', '.join(forces)}, or drop prescribed",
            where,
        )
    yield from element_problems(joint, where)
    yield from _rotor_problems(joint, bodies, where)
    if joint.traits.user_defined:
        yield from _general_problems(joint, where)


def _rotor_problems(joint: Joint, bodies: Collection[str], where: str) -> Iterator[Problem]:
    for rotor in joint.rotors:
        if rotor.carrier is not None and rotor.carrier not in bodies and rotor.carrier != WORLD:
            yield Problem(
                f"joint '{joint.name}': rotor on body '{rotor.carrier}', which does not exist",
                f"'{rotor.carrier}'",
                "a rotor's carrier is a body of the system",
                did_you_mean(rotor.carrier, bodies),
                where,
            )
        if rotor.axis is None and (rotor.carrier is not None or joint.traits.turns_about != "axis"):
            yield Problem(
                f"joint '{joint.name}': rotor without an axis",
                f"a {joint.kind} joint",
                "a rotor without an axis spins about its joint's own, on the joint's parent",
                "give the axis, in the carrier's body frame",
                where,
            )


def _general_problems(joint: Joint, where: str) -> Iterator[Problem]:
    names = joint.coordinates
    if not 1 <= len(names) <= _MAX_GENERAL:
        yield Problem(
            f"joint '{joint.name}': a general joint with {len(names)} coordinates",
            ", ".join(names) or "none",
            f"1 to {_MAX_GENERAL} coordinates",
            "name them under coordinates",
            where,
        )
    if len(set(names)) < len(names):
        yield Problem(
            f"joint '{joint.name}': coordinates of the same name",
            ", ".join(names)[:80],
            "coordinates of a joint have different names",
            "rename them",
            where,
        )


def joint_number_problems(joint: Joint, numbers: Numbers, where: str) -> Iterator[Problem]:
    """Faults of numbers: axes of no length, matrices that are no rotations, coinciding axes."""
    if "axis" in joint.traits.entries:
        yield from numbers.axis_problems(joint, where)
    if "axis2" in joint.traits.entries:
        one, two = numbers.values(joint.axis), numbers.values(joint.axis2)
        if np.linalg.norm(np.cross(one, two)) <= 1e-9 * max(1.0, float(np.linalg.norm(one) * np.linalg.norm(two))):
            yield Problem(
                f"joint '{joint.name}': the axes of a {joint.kind} joint coincide",
                f"{one} and {two}",
                "axis and axis2 are not parallel",
                "use a revolute joint, or another axis2",
                where,
            )
    if joint.traits.user_defined:
        yield from _sampled_rotation(joint, numbers, where)


def _sampled_rotation(joint: Joint, numbers: Numbers, where: str) -> Iterator[Problem]:
    """A general joint's matrix is checked to be a rotation at random coordinates, always the same ones."""
    rng = np.random.default_rng(0)
    for _ in range(_SAMPLES):
        q = dict(zip(coordinate_symbols(joint), rng.uniform(-1.0, 1.0, len(joint.coordinates)).tolist(), strict=True))
        at = numbers.extended(q)
        R = at.rotation(joint.moving_rotation)
        error = float(np.abs(R @ R.T - np.eye(3)).max())
        if not error <= ROTATION_TOLERANCE or np.linalg.det(R) < 0.0:
            shown = ", ".join(f"{name} = {x:.3g}" for name, x in q.items())
            yield Problem(
                f"joint '{joint.name}': R_PD is not a rotation",
                f"at {shown}: |R R^T - 1| = {error:.2g}",
                f"R R^T = 1 within {ROTATION_TOLERANCE:g} and determinant +1, at all coordinates",
                "state it by rpy or axis_angle, or mend the matrix",
                where,
            )
            return
        if not np.all(np.isfinite(at.values(joint.moving_position))):
            yield Problem(
                f"joint '{joint.name}': p_PD is not finite",
                f"at {q}",
                "p_PD is finite at all coordinates",
                "mind divisions and domains",
                where,
            )
            return
