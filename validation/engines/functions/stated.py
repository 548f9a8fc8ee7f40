"""What files state of joints, tendons and actuators: no function of q and v need depend on it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..interface import Actuator, Tendon
from ..truth import carried, sensed
from ..truth.arithmetic import Exact, exact
from ..truth.derived import TruthOf
from ..truth.dynamics import Point, Truth
from .function import Function, functions_of


def _ranges(t: Truth, s: Point) -> Exact:
    return t.own.ranges


def _none(t: Truth, s: Point) -> Exact:
    return exact(np.zeros(1))


def _of_joints() -> dict[str, Function]:
    """What readers make of losses, limits and drives of joints."""
    rows = {
        "joint_dampings": ("force of dampers for a unit of speed (nv)", lambda t, s: t.own.damping),
        "joint_frictions": ("greatest force of dry friction (nv)", lambda t, s: t.own.friction),
        "joint_limits": ("least and greatest coordinates (nv, 2)", _ranges),
        "joint_limits_of_some": ("the same where not all joints have limits: zeros for none (nv, 2)", _ranges),
        "joint_speed_limits": ("greatest speeds (nv)", lambda t, s: t.own.bounds[:, 0]),
        "joint_force_limits": ("greatest forces (nv)", lambda t, s: t.own.bounds[:, 1]),
        "link_bodies": (
            "mass, mass times mass centre, moments about it xx, yy, zz, xy, xz, yz along the link's axes (L, 10)",
            carried.bodies,
        ),
        "shape_poses": ("positions and rows of R of what links collide by, in the world (n, 12)", sensed.frame_poses),
        "frames_beside_links": ("number of frames that are none of links, where sensors are to be none (1)", _none),
        "joint_stiffnesses": ("force of springs for a unit of a coordinate (nv)", lambda t, s: t.own.stiffness),
        "joint_drives": ("stiffness, damping, coordinate of drives (nv, 3)", lambda t, s: t.own.drives),
    }
    return functions_of(rows, "files")


def _each(of: Callable[[Tendon], object]) -> TruthOf:
    """A number of each tendon."""
    return lambda t, s: exact(np.array([of(one) for one in t.tree.tendons], dtype=float))


def _every(of: Callable[[Actuator], object]) -> TruthOf:
    """A number, or some, of each actuator."""
    return lambda t, s: exact(np.array([of(one) for one in t.tree.actuators], dtype=float))


def _shares(t: Truth, s: Point) -> Exact:
    return exact(np.array([link.compensation for link in t.tree.links]))


def _of_lines() -> dict[str, Function]:
    """What readers make of tendons, actuators and gravity compensation."""
    rows: dict[str, tuple[str, TruthOf]] = {
        "tendon_stiffnesses": ("force of tendons for a unit of length (n)", _each(lambda one: one.stiffness)),
        "tendon_dampings": ("force of tendons for a unit of their speed (n)", _each(lambda one: one.damping)),
        "tendon_rests": ("lengths of tendons without force (n)", _each(lambda one: one.rest)),
        "tendon_armatures": ("masses that move with lengths of tendons (n)", _each(lambda one: one.armature)),
        "actuator_gears": ("factors of lengths and forces (nu)", _every(lambda one: one.gear)),
        "actuator_gains": ("forces for a unit of control (nu)", _every(lambda one: one.gain)),
        "actuator_biases": ("b0, b1, b2 of forces (nu, 3)", _every(lambda one: one.bias)),
        "actuator_control_limits": (
            "least and greatest controls, zeros for none (nu, 2)",
            _every(lambda one: one.control_limits or (0.0, 0.0)),
        ),
        "actuator_force_limits": (
            "least and greatest forces, zeros for none (nu, 2)",
            _every(lambda one: one.force_limits or (0.0, 0.0)),
        ),
        "actuator_sites": (
            "points of both sites of actuators between sites, in their links (nu, 6)",
            _every(lambda one: [x for end in one.ends for x in end.p]),
        ),
        "weight_shares": ("gravity compensation of links, as part of their weights (L)", _shares),
    }
    return functions_of(rows, "files")


def _coupled(t: Truth, s: Point) -> Exact:
    return exact(np.array([one.coefficients for one in t.tree.constraints]))


_COUPLED = functions_of(
    {"coupled_coefficients": ("constant and slope by which joints follow others (n, 2)", _coupled)}, "files"
)
STATED = _of_joints() | _of_lines() | _COUPLED
