"""What acts on trees by their own statement, what sensors read of them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..interface import Activation, Actuator
from ..truth import derived, sensed
from ..truth.acting import activations
from ..truth.arithmetic import Exact, solve
from ..truth.derived import TruthOf
from ..truth.dynamics import Point, Truth
from .function import Function, functions_of


def _acting() -> dict[str, Function]:
    """What a tree's own forces show in."""
    passive = ("dampers", "springs", "compensation", "tendons", "a medium")
    tendons, actuators, states = ("tendons",), ("actuators",), ("activations",)
    return {
        "passive_forces": Function(
            "forces of springs, dampers, gravity compensation (nv)", lambda t, s: t.own.passive(s.q, s.v), passive
        ),
        "tendon_lengths": Function("lengths of tendons (n)", lambda t, s: _column(t.own.lines(s.q), 0), tendons),
        "tendon_arms": Function("their derivatives (n, nv)", lambda t, s: _column(t.own.lines(s.q), 1), tendons),
        "tendon_speeds": Function(
            "rates of lengths of tendons (n)", lambda t, s: _column(t.own.lines(s.q), 1) @ s.v, tendons
        ),
        "inverse_dynamics_acted": Function(
            "M a + h less the passive forces (nv)", lambda t, s: t.ID(s.q, s.v, s.a) - t.own.passive(s.q, s.v), passive
        ),
        "actuator_speeds": Function(
            "rates of actuator_lengths (nu)", lambda t, s: _column(t.own.transmissions(s.q), 1) @ s.v, actuators
        ),
        "actuator_lengths": Function(
            "lengths that actuators act on, times gear (nu)",
            lambda t, s: _column(t.own.transmissions(s.q), 0),
            actuators,
        ),
        "actuator_arms": Function(
            "their derivatives (nu, nv)", lambda t, s: _column(t.own.transmissions(s.q), 1), actuators
        ),
        "actuator_forces": Function("forces of actuators (nu)", lambda t, s: t.own.efforts(s.q, s.v), actuators),
        "controlled_forces": Function(
            "forces of actuators (nu) that make the accelerations a against all else", _controlled, actuators
        ),
        "activation_rates": Function("rates of actuators' states (na)", _of_states(activations.rate), states),
        "activations_after_step": Function(
            "actuators' states after a step (na)", _of_states(activations.after_step), states
        ),
        "actuated_forces": Function(
            "generalized forces of actuators (nv)", lambda t, s: t.own.actuated(s.q, s.v), actuators
        ),
    }


def _controlled(t: Truth, s: Point) -> Exact:
    """Functions of as many actuators as speeds.

    Raises:
        ZeroDivisionError: They don't make all forces, or in more than one way.
    """
    arms = _column(t.own.transmissions(s.q), 1)
    if len(arms) != t.nv:
        raise ZeroDivisionError("not as many actuators as speeds")
    return solve(arms.T, t.ID(s.q, s.v, s.a) - t.own.passive(s.q, s.v))


def _of_states(of: Callable[[Actuator, Activation], Exact]) -> TruthOf:
    """A function of each actuator that has a state (na)."""

    def function(t: Truth, s: Point) -> Exact:
        return np.array([of(one, one.activation) for one in t.tree.actuators if one.activation], dtype=object)

    return function


def _column(rows: list[tuple[Exact, Exact]], place: int) -> Exact:
    return np.array([row[place] for row in rows])


ACTING = _acting()


def _measured() -> dict[str, Function]:
    """What sensors read at q, v, a, at their frames and along their axes unless said otherwise."""
    rows = {
        "accelerometers": ("acceleration less that of gravity (n, 3)", sensed.accelerometers),
        "gyroscopes": ("angular velocities (n, 3)", lambda t, s: sensed.twists(t, s)[:, 3:]),
        "velocimeters": ("velocities (n, 3)", lambda t, s: sensed.twists(t, s)[:, :3]),
        "angular_accelerations": ("angular accelerations along the world's axes (n, 3)", sensed.angular_accelerations),
        "frame_poses": ("positions and rows of R (n, 12)", sensed.frame_poses),
        "frame_poses_seen": ("the same in the first sensor's frame (n, 12)", sensed.frame_poses_seen),
        "frame_velocities": ("velocities of the frames along the world's axes (n, 6)", sensed.frame_velocities),
        "frame_velocities_seen": (
            "rates of positions in the first sensor's frame, angular velocities against it, along it (n, 6)",
            sensed.frame_velocities_seen,
        ),
        "frame_accelerations": (
            "accelerations of the frames' origins, and angular ones, along the world's axes (n, 6)",
            sensed.frame_accelerations,
        ),
        "frame_velocity_products": ("frame_accelerations at a = 0 (n, 6)", sensed.frame_velocity_products),
        "magnetic_fields": (
            f"the field {list(sensed.MAGNETIC)} of the world along the sensors' axes (n, 3)",
            sensed.magnetic_fields,
        ),
        "frame_jacobians": ("Jacobians of the frames along the world's axes (n, 6, nv)", sensed.frame_jacobians),
        "accelerometers_driven": (
            "accelerometers at the accelerations that tau makes (n, 3)",
            derived.driven(sensed.accelerometers),
        ),
        "angular_accelerations_driven": (
            "angular_accelerations at the accelerations that tau makes (n, 3)",
            derived.driven(sensed.angular_accelerations),
        ),
        "wrench_sensors_driven": (
            "wrench_sensors at the accelerations that tau makes (n, 6)",
            derived.driven(sensed.wrench_sensors),
        ),
        "applied_wrenches": (
            "forces (nv) that do what the wrench (1, -2, 3; 0.5, -0.25, 0.75) does at each frame, along its axes",
            sensed.applied_wrenches,
        ),
        "applied_wrenches_dq": ("derivative of applied_wrenches by q (nv, nv)", sensed.applied_wrenches_dq),
        "pushed_forces": ("M a + h less applied_wrenches (nv)", sensed.pushed_forces),
        "pushed_accelerations": ("accelerations by tau and applied_wrenches (nv)", sensed.pushed),
        "pushed_accelerations_dq": ("their derivative by q (nv, nv)", sensed.pushed_dq),
        "pushed_accelerations_dv": ("their derivative by v (nv, nv)", sensed.pushed_dv),
        "wrench_sensors": (
            "force that holds the link and its subtree, and its moment about the sensor (n, 6)",
            sensed.wrench_sensors,
        ),
    }
    return functions_of(rows, "sensors")


MEASURED = _measured()
