"""Files whose meaning their formats state, and the trees that they mean: for engines' own parsers."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from ...interface import Array, Joint, Link, Rows, Tree, Vector, rows

# What a file's reading shows in: the functions that every number of it enters. PASSIVE: with springs or dampers, which
# some engines count among their forces.
READ = ("sizes", "mass_matrix", "bias", "link_poses", "link_bodies")
# What joints state beside their motion, sites, actuators.
LOSSES = ("joint_dampings", "joint_frictions", "joint_stiffnesses")
LIMITED, LIMITED_OF_SOME = ("joint_limits",), ("joint_limits_of_some",)
BOUNDED = (*LIMITED, "joint_speed_limits", "joint_force_limits")
PLACED = ("frame_poses",)
DRIVEN = ("actuator_forces", "actuated_forces")
TENDONS = ("tendon_arms", "tendon_stiffnesses", "tendon_dampings", "tendon_rests", "tendon_armatures")
ACTUATORS = (
    *("actuator_arms", "actuator_gears", "actuator_gains", "actuator_biases"),
    *("actuator_control_limits", "actuator_force_limits"),
)
PASSIVE = ("sizes", "mass_matrix", "gravity", "link_poses")


@dataclass(frozen=True)
class Reading:
    """A file and the tree that it states.

    Attributes:
        form: Format: "urdf", "mjcf", "sdf", "usd" or "skel"; "urdf from shapes" for readers that work out inertias,
            "urdf of drake" and "sdf of drake" for elements of Drake's own.
        text: The file; its links are named as the tree's.
        tree: The tree.
        asked: Functions that are asked of it.
    """

    form: str
    text: str
    tree: Tree
    asked: tuple[str, ...] = READ

    def functions(self, offered: Collection[str]) -> tuple[str, ...]:
        """Functions that are asked of an engine; in place of the bias that it does not offer, gravity's part of it."""
        asked = (*self.asked, "gravity") if "bias" in self.asked and "bias" not in offered else self.asked
        return tuple(name for name in offered if name in asked)


def shown(tree: Tree) -> tuple[str, ...]:
    """What a file's reading shows in: functions that every number of its tree enters."""
    joints = [joint for link in tree.links for joint in link.joints if joint.kind != "fixed"]
    if any(one.mimics for one in joints):
        return READ
    lost = any(one.damping or one.stiffness or one.friction for one in joints) or bool(tree.forces)
    asked = [*(PASSIVE if lost else READ), "link_bodies", *LOSSES]
    asked += ["passive_forces"] if any(one.stiffness for one in joints) or "compensation" in tree.forces else []
    asked += LIMITED if all(one.limits for one in joints) else LIMITED_OF_SOME
    asked += BOUNDED[1:] if all(one.bounds for one in joints) else ()
    asked += PLACED if tree.sensors else ()
    if tree.tendons:  # Not all readers know of tendons, whose armature is part of the mass matrix.
        asked = [one for one in asked if one != "mass_matrix"] + list(TENDONS)
    asked += (*ACTUATORS, *DRIVEN) if tree.actuators else ()
    return tuple(dict.fromkeys(asked))


def about(axis: Vector, angle: float) -> Rows:
    """Rotation about an axis of any length."""
    x, y, z = np.array(axis) / math.hypot(*axis)
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return rows(np.eye(3) + math.sin(angle) * K + (1.0 - math.cos(angle)) * K @ K)


def in_series(*turns: tuple[str, float]) -> Rows:
    """Rotations about axes of the frame that turns, one after the other: letter and angle of each."""
    R: Array = np.eye(3)
    for letter, angle in turns:
        R = R @ np.array(about(_UNIT[letter], angle))
    return rows(R)


def rpy_rotation(roll: float, pitch: float, yaw: float) -> Rows:
    """Rz(yaw) Ry(pitch) Rx(roll)."""
    return in_series(("z", yaw), ("y", pitch), ("x", roll))


def along(R: Rows, inertia: Rows) -> Rows:
    """An inertia (3, 3) along axes whose directions are the columns of R."""
    turned = np.array(R) @ np.array(inertia) @ np.array(R).T
    return rows((turned + turned.T) / 2.0)


def diagonal(x: float, y: float, z: float) -> Rows:
    """A diagonal matrix."""
    return ((x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z))


def hung(link: Link, **changes: object) -> Link:
    """A link on another joint."""
    return replace(link, joints=(replace(link.joints[0], **changes),))  # type: ignore[arg-type]


_UNIT: dict[str, Vector] = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
IDENTITY = in_series()
PRINCIPAL = diagonal(0.2, 0.3, 0.4)
# Inertia with products: ixx, iyy, izz, ixy, ixz, iyz of OBLONG.
PRODUCTS = (0.21, 0.32, 0.43, 0.01, -0.02, 0.03)
OBLONG: Rows = ((0.21, 0.01, -0.02), (0.01, 0.32, 0.03), (-0.02, 0.03, 0.43))
TURNED = rpy_rotation(0.3, -0.4, 0.5)
# Turn of the frames of inertias.
ASKEW = rpy_rotation(0.5, 0.6, 0.7)
_HINGE = Joint("revolute", R=TURNED, p=(0.1, 0.2, 0.3), axis=(0.0, 0.0, 1.0))
# The links that files state where they state nothing else: `a` in the world, `b` on it.
BODY = Link("a", -1, (_HINGE,), 2.0, (0.1, -0.2, 0.3), PRINCIPAL)
NEXT = Link("b", 0, (Joint("revolute", p=(0.0, 0.0, 0.5), axis=(0.0, 1.0, 0.0)),), 1.0, (0.0, 0.1, 0.2), PRINCIPAL)


def reading(form: str, name: str, text: str, *links: Link, asked: tuple[str, ...] = READ) -> tuple[str, Reading]:
    """A file by its name; its tree is of the links."""
    title = f"{form}: {name}"
    return title, Reading(form, text, Tree(title, links), asked)
