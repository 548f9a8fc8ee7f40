"""What engines are asked for: one row a function, with its truth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal

import numpy as np

from .interface import Tree
from .truth import constraints, derived, steps, turns
from .truth.arithmetic import Exact
from .truth.derived import FRAMES, Frame, TruthOf
from .truth.dynamics import Point, Truth


@dataclass(frozen=True)
class Function:
    """One function of a tree and a state.

    Attributes:
        text: What it is, with shape and conventions.
        truth: Its value in many digits.
        needs: Of `Tree.demands`, those in any of which it shows; () for trees that state none.
    """

    text: str
    truth: TruthOf
    needs: tuple[str, ...] = ()


def _momentum(t: Truth, s: Point) -> Exact:
    return derived.centroidal_matrix(t, s.q) @ s.v


FUNCTIONS: dict[str, Function] = {
    "sizes": Function("lengths of q and v (2)", lambda t, s: np.array([Decimal(len(s.q)), Decimal(len(s.v))])),
    "mass_matrix": Function("M (nv, nv)", lambda t, s: t.M(s.q)),
    "mass_matrix_inverse": Function("M^-1 (nv, nv)", lambda t, s: t.inverse(s.q)),
    "bias": Function("h (nv): Coriolis, centrifugal and gravity forces", lambda t, s: t.h(s.q, s.v)),
    "gravity": Function("g (nv): gravity forces", lambda t, s: t.g(s.q)),
    "coriolis_forces": Function("C v = h - g (nv), C the Coriolis matrix", lambda t, s: t.h(s.q, s.v) - t.g(s.q)),
    "coriolis_symmetry": Function("C + C^T = dM/dt (nv, nv)", derived.mass_matrix_rate),
    "inverse_dynamics": Function("M a + h (nv)", lambda t, s: t.ID(s.q, s.v, s.a)),
    "joint_wrenches": Function(
        "what holds each link with all it carries, at its origin along its axes (L, 6)", derived.joint_wrenches
    ),
    "subtree_momenta": Function(
        "momentum of each link with all it carries, about their mass centre (L, 6)", derived.subtree_momenta
    ),
    "forward_dynamics": Function("M^-1 (tau - h) (nv)", lambda t, s: t.FD(s.q, s.v, s.tau)),
    "kinetic_energy": Function("T = v^T M v / 2", lambda t, s: t.T(s.q, s.v)),
    "potential_energy": Function("V = -sum m g^T p", lambda t, s: t.V(s.q)),
    "link_poses": Function("positions and rows of R (L, 12)", lambda t, s: t.kinematics.flat_poses(s.q)),
    "mass_centre": Function("mass centre (3)", lambda t, s: derived.com(t, s.q)),
    "mass_centre_jacobian": Function("its Jacobian (3, nv)", lambda t, s: derived.com_jacobian(t, s.q)),
    "mass_centre_velocity_dq": Function(
        "derivative of its velocity by q (3, nv)",
        lambda t, s: t.kinematics.tangent(lambda q: derived.com_jacobian(t, q) @ s.v, s.q),
    ),
    "link_accelerations": Function(
        "acceleration of the links' origins and angular accelerations, along world axes (L, 6)",
        lambda t, s: derived.classical(t, s.q, s.v, s.a),
    ),
    "link_velocity_products": Function(
        "link_accelerations at a = 0 (L, 6)", lambda t, s: derived.classical(t, s.q, s.v, 0 * s.a)
    ),
    "mass_centre_velocity_products": Function(
        "acceleration of the mass centre at a = 0 (3)",
        lambda t, s: t.kinematics.along(lambda q: derived.com_jacobian(t, q), s.q, s.v) @ s.v,
    ),
    "centroidal_matrix": Function(
        "A (6, nv): momentum about the mass centre is A v", lambda t, s: derived.centroidal_matrix(t, s.q)
    ),
    "centroidal_matrix_rate": Function("dA/dt (6, nv)", lambda t, s: derived.centroidal_rate(t, s.q, s.v)),
    "centroidal_momentum": Function("A v (6)", _momentum),
    "centroidal_momentum_rate": Function("d(A v)/dt (6)", lambda t, s: derived.momentum_rate(t, s.q, s.v, s.a)),
    "centroidal_momentum_dq": Function(
        "derivative of A v by q (6, nv)",
        lambda t, s: t.kinematics.tangent(lambda q: derived.centroidal_matrix(t, q) @ s.v, s.q),
    ),
    "centroidal_momentum_rate_dq": Function(
        "derivative of d(A v)/dt by q (6, nv)",
        lambda t, s: t.kinematics.tangent(lambda q: derived.momentum_rate(t, q, s.v, s.a), s.q),
    ),
    "centroidal_momentum_rate_dv": Function(
        "derivative of d(A v)/dt by v (6, nv)",
        lambda t, s: t.along_speeds(lambda v: derived.momentum_rate(t, s.q, v, s.a), s.v),
    ),
    "inverse_dynamics_dq": Function(
        "derivative of M a + h by q (nv, nv)", lambda t, s: t.kinematics.tangent(lambda q: t.ID(q, s.v, s.a), s.q)
    ),
    "inverse_dynamics_dv": Function(
        "derivative of M a + h by v (nv, nv)", lambda t, s: t.along_speeds(lambda v: t.h(s.q, v), s.v)
    ),
    "gravity_dq": Function("derivative of g by q (nv, nv)", lambda t, s: t.kinematics.tangent(t.g, s.q)),
    "forward_dynamics_dq": Function(
        "derivative of forward dynamics by q (nv, nv)",
        lambda t, s: t.kinematics.tangent(lambda q: t.FD(q, s.v, s.tau), s.q),
    ),
    "forward_dynamics_dv": Function(
        "derivative of forward dynamics by v (nv, nv)",
        lambda t, s: t.along_speeds(lambda v: t.FD(s.q, v, s.tau), s.v),
    ),
    "torque_regressor": Function(
        "Y (nv, 10 L): M a + h = Y (m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the origin)", derived.torque_regressor
    ),
    "kinetic_energy_regressor": Function("Y (10 L): T = Y parameters", derived.kinetic_regressor),
    "potential_energy_regressor": Function("Y (10 L): V = Y parameters", derived.potential_regressor),
    "integrate": Function("where q' = N(q) v2 leads in unit time (nq)", lambda t, s: derived.integrated(t, s.q, s.v2)),
    "difference": Function("v2, of q and where v2 leads from it (nv)", lambda t, s: np.array(s.v2)),
    "interpolate": Function(
        "a quarter of the way from q to where v2 leads (nq)", lambda t, s: derived.integrated(t, s.q, s.v2 / 4)
    ),
    "difference_dq": Function("derivative of difference by its first configuration (nv, nv)", derived.difference_dq),
    "difference_dq2": Function("derivative of difference by its second (nv, nv)", derived.difference_dq2),
    "integrate_dq": Function("derivative of integrate by q (nv, nv)", derived.integrated_dq),
    "integrate_dv": Function("derivative of integrate by v2 (nv, nv)", derived.integrated_dv),
}


ALIGNED = ("link_jacobians", "link_jacobian_rates", "link_velocities")


def _in_frame(frame: Frame) -> dict[str, Function]:
    """Functions of links in one of three frames."""
    names = ALIGNED if frame == "aligned" else (f"jacobian_{frame}", f"jacobian_rate_{frame}", f"velocity_{frame}")
    return {
        names[0]: Function("Jacobians of the links (L, 6, nv)", lambda t, s: derived.jacobians(t, s.q, frame)),
        names[1]: Function(
            "their time derivatives (L, 6, nv)", lambda t, s: derived.jacobian_rates(t, s.q, s.v, frame)
        ),
        names[2]: Function(
            "spatial velocities of the links (L, 6)", lambda t, s: derived.velocities(t, s.q, s.v, frame)
        ),
        f"jacobian_dq_{frame}": Function("their derivatives by q (L, 6, nv, nv)", derived.jacobian_dq(frame)),
        f"acceleration_{frame}": Function(
            "spatial accelerations (L, 6)", lambda t, s: derived.accelerations(t, s.q, s.v, s.a, frame)
        ),
        f"velocity_dq_{frame}": Function("derivative of the velocities by q (L, 6, nv)", derived.velocity_dq(frame)),
        f"acceleration_dq_{frame}": Function(
            "derivative of the accelerations by q (L, 6, nv)", derived.acceleration_dq(frame)
        ),
        f"acceleration_dv_{frame}": Function(
            "derivative of the accelerations by v (L, 6, nv)", derived.acceleration_dv(frame)
        ),
    }


for _frame in FRAMES:
    FUNCTIONS |= _in_frame(_frame)


def _at_rest(t: Truth, s: Point) -> Exact:
    return np.concatenate([s.q, 0 * s.v])


def _constrained() -> dict[str, Function]:
    """Functions of trees with constraints."""
    half = Decimal(1) / 2
    rows: dict[str, Function] = {
        "constraint_jacobian": Function(
            "J (m, nv): velocity of a constraint's first frame against the second, along the first's axes",
            lambda t, s: constraints.jacobian(t, s.q),
        ),
        "constraint_velocity_products": Function("J' v (m)", lambda t, s: constraints.products(t, s.q, s.v)),
        "constraint_residuals": Function(
            "what constraints are off by, at q2 (m): points' distance along world axes; vector part of the quaternion "
            "that turns the second frame into the first, in the second; lengths less those at zero",
            lambda t, s: constraints.residuals(t, s.q2),
        ),
        "step_at_rest": Function("q, v (nq + nv) after a step at rest, without gravity and forces", _at_rest),
        "delassus": Function("J M^-1 J^T (m, m)", lambda t, s: constraints.delassus(t, s.q)),
        "delassus_inverse": Function(
            "(J M^-1 J^T)^-1 (m, m)",
            lambda t, s: constraints.delassus_inverse(t, s.q),
        ),
        "delassus_inverse_damped": Function(
            "(J M^-1 J^T + 1e-4)^-1 (m, m)", lambda t, s: constraints.delassus_inverse(t, s.q, 1e-4)
        ),
        "kkt_inverse": Function("inverse of [[M, J^T], [J, 0]] (nv + m, nv + m)", constraints.kkt_inverse),
        "constrained_acceleration": Function(
            "a (nv): M a + h = tau + J^T f, J a + J' v = 0", lambda t, s: constraints.acceleration(t, s.q, s.v, s.tau)
        ),
        "constraint_forces": Function(
            "f (m): M a + h = tau + J^T f, J a + J' v = 0", lambda t, s: constraints.forces(t, s.q, s.v, s.tau)
        ),
        "impact_velocity": Function(
            "speeds after impact (nv): M (v+ - v2) = J^T impulse, J v+ = 0",
            lambda t, s: constraints.after_impact(t, s.q, s.v2, 0 * half),
        ),
        "impact_velocity_rebound": Function(
            "speeds after impact (nv): M (v+ - v2) = J^T impulse, J v+ = -J v2 / 2",
            lambda t, s: constraints.after_impact(t, s.q, s.v2, half),
        ),
        "impulses": Function(
            "impulse (m): M (v+ - v2) = J^T impulse, J v+ = 0", lambda t, s: constraints.impulses(t, s.q, s.v2)
        ),
        "impact_velocity_dq": Function(
            "derivative of the speeds after impact by q (nv, nv)",
            lambda t, s: t.kinematics.tangent(lambda q: constraints.after_impact(t, q, s.v2, 0 * half), s.q),
        ),
        "impulses_dq": Function(
            "derivative of the impulses by q (m, nv)",
            lambda t, s: t.kinematics.tangent(lambda q: constraints.impulses(t, q, s.v2), s.q),
        ),
    }
    for name, of in (("constrained_acceleration", constraints.acceleration), ("constraint_forces", constraints.forces)):
        rows |= _derivatives(name, of)
    return rows


def _derivatives(name: str, of: Callable[[Truth, Exact, Exact, Exact], Exact]) -> dict[str, Function]:
    """Derivatives of a function of coordinates, speeds and forces."""
    what = f"derivative of {name.replace('_', ' ')} by"
    return {
        f"{name}_dq": Function(f"{what} q", lambda t, s: t.kinematics.tangent(lambda q: of(t, q, s.v, s.tau), s.q)),
        f"{name}_dv": Function(f"{what} v", lambda t, s: t.along_speeds(lambda v: of(t, s.q, v, s.tau), s.v)),
        f"{name}_dtau": Function(f"{what} tau", lambda t, s: t.along_speeds(lambda tau: of(t, s.q, s.v, tau), s.tau)),
    }


CONSTRAINED = _constrained()
FUNCTIONS |= CONSTRAINED


def _steps() -> dict[str, Function]:
    """One step of `interface.STEP` from q and v under tau: coordinates, then speeds, after it."""
    after = "q+, v+ (nq + nv) after a step:"
    single, runge_kutta = steps.single, steps.runge_kutta
    rows = {
        "semi_implicit": ("v+ = v + h M^-1 f, f = tau + Q - (bias); q+ where v+ leads in h", single("nothing")),
        "dampers_implicit": ("M + h D in place of M, D of the joints' dampers", single("dampers")),
        "semi_implicit_straight": ("the same with q+ = q + h N(q) v+", single("nothing", steps.straight)),
        "dampers_implicit_straight": ("the same with q+ = q + h N(q) v+", single("dampers", steps.straight)),
        "semi_implicit_normalized": (
            "v+ = v + h M^-1 f, q+ = q + h N(q) v+ with quaternions brought to unit length",
            single("nothing", steps.normalized),
        ),
        "forces_implicit": ("M + h D in place of M, D = -dQ/dv, for lone free bodies -df/dv", single("forces")),
        "velocities_implicit": ("M + h D in place of M, D = -df/dv", single("velocities")),
        "stiffness_implicit": ("v+ = v + h (M + h D + h^2 K)^-1 (f - h K v)", single("stiffness")),
        "stiffness_implicit_lone": ("the same, for lone free bodies D = -df/dv", single("discrete")),
        "euler": ("q+ = q + h N v, v+ = v + h M^-1 f", runge_kutta(steps.EULER)),
        "midpoint": ("the midpoint rule, in coordinates", runge_kutta(steps.MIDPOINT)),
        "rk2": ("Heun's method of order 2, in coordinates", runge_kutta(steps.HEUN)),
        "rk3": ("Kutta's method of order 3, in coordinates", runge_kutta(steps.THIRD)),
        "rk4": ("the classical method of order 4, in coordinates", runge_kutta(steps.CLASSICAL)),
        "trapezoidal": ("the trapezoidal rule for q (flat charts) and v", steps.trapezoidal),
        "rk4_manifold": ("the same, of displacements (Munthe-Kaas)", runge_kutta(steps.CLASSICAL, on_manifold=True)),
    }
    return {f"step_{name}": Function(f"{after} {text}", truth) for name, (text, truth) in rows.items()}


STEPS = _steps()
STEPS["step_dampers_implicit_derivative"] = Function(
    "derivative of q+, v+ of that step by q, v along speeds (2 nv, 2 nv)",
    steps.derivative(STEPS["step_dampers_implicit"].truth),
    ("dampers", "springs", "tendons", "actuators"),
)


def _acting() -> dict[str, Function]:
    """What a tree's own forces show in."""
    passive = ("dampers", "springs", "compensation", "tendons")
    tendons, actuators = ("tendons",), ("actuators",)
    return {
        "passive_forces": Function(
            "forces of springs, dampers, compensated weights (nv)", lambda t, s: t.own.passive(s.q, s.v), passive
        ),
        "tendon_lengths": Function("lengths of tendons (n)", lambda t, s: _column(t.own.lines(s.q), 0), tendons),
        "tendon_arms": Function("their derivatives (n, nv)", lambda t, s: _column(t.own.lines(s.q), 1), tendons),
        "actuator_lengths": Function(
            "lengths that actuators act on, times gear (nu)",
            lambda t, s: _column(t.own.transmissions(s.q), 0),
            actuators,
        ),
        "actuator_arms": Function(
            "their derivatives (nu, nv)", lambda t, s: _column(t.own.transmissions(s.q), 1), actuators
        ),
        "actuator_forces": Function("forces of actuators (nu)", lambda t, s: t.own.efforts(s.q, s.v), actuators),
        "actuated_forces": Function(
            "what they do along the speeds (nv)", lambda t, s: t.own.actuated(s.q, s.v), actuators
        ),
    }


def _column(rows: list[tuple[Exact, Exact]], place: int) -> Exact:
    return np.array([row[place] for row in rows])


ACTING = _acting()


def _measured() -> dict[str, Function]:
    """What sensors read at q, v, a, at their frames and along their axes unless said otherwise."""
    rows = {
        "accelerometers": ("acceleration less that of gravity (n, 3)", derived.accelerometers),
        "gyroscopes": ("angular velocities (n, 3)", lambda t, s: derived.twists(t, s)[:, 3:]),
        "velocimeters": ("velocities (n, 3)", lambda t, s: derived.twists(t, s)[:, :3]),
        "angular_accelerations": ("angular accelerations along the world's axes (n, 3)", derived.angular_accelerations),
        "frame_poses": ("positions and rows of R (n, 12)", derived.frame_poses),
        "frame_jacobians": ("Jacobians of the frames along the world's axes (n, 6, nv)", derived.frame_jacobians),
        "accelerometers_driven": (
            "accelerometers at the accelerations that tau makes (n, 3)",
            derived.driven(derived.accelerometers),
        ),
        "angular_accelerations_driven": (
            "angular_accelerations at the accelerations that tau makes (n, 3)",
            derived.driven(derived.angular_accelerations),
        ),
        "wrench_sensors_driven": (
            "wrench_sensors at the accelerations that tau makes (n, 6)",
            derived.driven(derived.wrench_sensors),
        ),
        "applied_wrenches": (
            "forces (nv) that do what the wrench (1, -2, 3; 0.5, -0.25, 0.75) does at each frame, along its axes",
            derived.applied_wrenches,
        ),
        "wrench_sensors": (
            "force on the link and all it carries of what holds it, and its moment about the sensor (n, 6)",
            derived.wrench_sensors,
        ),
    }
    return {name: Function(text, truth, ("sensors",)) for name, (text, truth) in rows.items()}


MEASURED = _measured()


def _stated_in_files() -> dict[str, Function]:
    """What readers make of losses of joints: no function of q and v need depend on them."""
    rows = {
        "joint_dampings": ("force of dampers for a unit of speed (nv)", lambda t, s: t.own.damping),
        "joint_frictions": ("greatest force of dry friction (nv)", lambda t, s: t.own.friction),
        "joint_stiffnesses": ("force of springs for a unit of a coordinate (nv)", lambda t, s: t.own.stiffness),
    }
    return {name: Function(text, truth, ("files",)) for name, (text, truth) in rows.items()}


def _of_turns() -> dict[str, Function]:
    """What packages offer of rotations: R of the coordinates q, Q of q2, vectors of rotation (`turns`)."""
    rows = {
        "rotation_matrix": ("rows of R (9)", turns.matrix),
        "rotation_composed": ("rows of R Q (9)", turns.composed),
        "rotation_angle": ("angle of R^T Q (1)", turns.angle),
        "rotation_logarithm": ("rotation vector of R (3)", turns.logarithm),
        "rotation_exponential": ("rows of the rotation by the vector v (9)", turns.exponential),
        "rotation_exponential_of_turns": ("rows of the rotation by the vector 16 v (9)", turns.exponential_of_turns),
        "rotation_half_turn": (
            "rows of the half turn about u = v + (4, -8, 8), once its matrix is a quaternion (9)",
            turns.half_turn,
        ),
        "rotation_vector_rates": ("A^-1 at r = tau, in the turned axes (3, 3)", turns.vector_rates),
        "rotation_vector_speeds": ("A at r = tau, in the turned axes (3, 3)", turns.vector_speeds),
        "rotation_vector_rates_fixed": ("A^-1 at r = v, along the axes before (3, 3)", turns.vector_rates_fixed),
        "rotation_vector_rates_rate": (
            "time derivative of the latter at r = tau, r' = a (3, 3)",
            turns.vector_rates_rate,
        ),
        "rpy_rates": ("roll, pitch, yaw rates = B w, w along the axes before, at angles v (3, 3)", turns.rpy_rates),
        "rpy_rates_rate": ("time derivative of B at angles v and rates a (3, 3)", turns.rpy_rates_rate),
        "rotation_halfway": (
            "rows of the rotation a quarter of the way from R to Q, the shorter way (9)",
            turns.between,
        ),
        "twist_transform": (
            "(6, 6): twists (linear; angular) of a frame at (R, a) in the frame it is in",
            turns.adjoint,
        ),
    }
    return {name: Function(text, truth, ("turns",)) for name, (text, truth) in rows.items()}


FUNCTIONS["solid_inertia"] = Function(
    "mass, mass centre, moments about it xx, yy, zz, xy, xz, yz of the only link (10)",
    derived.solid_inertia,
    ("solids",),
)
FUNCTIONS["solid_mass"] = Function(
    "mass of the only link (1)", lambda t, s: derived.solid_inertia(t, s)[:1], ("solids",)
)
FUNCTIONS["flexible_relation"] = Function(
    "1 + what forces or steps of a flexible body change with the frame it stands in, as part of them (n)",
    lambda t, s: np.array([Decimal(1)]),
    ("flexible bodies",),
)
FUNCTIONS["constraint_diagonal"] = Function(
    "diagonal of J M^-1 J^T (m)", lambda t, s: np.diag(constraints.delassus(t, s.q)), ("a lone body",)
)
FUNCTIONS["step_bound"] = Function(
    "v+ (nv) after a step from q, v2: M (v+ - v2) = h (tau - (bias)) + J^T impulse, J v+ = 0",
    constraints.after_step,
    ("a bound pair",),
)
_ACTED_ON = ("mass_matrix", "forward_dynamics", "forward_dynamics_dq", "forward_dynamics_dv")
_SENSED = ("joint_wrenches", "link_accelerations", "subtree_momenta")
FUNCTIONS |= STEPS | ACTING | MEASURED | _stated_in_files() | _of_turns()
# What is asked of a tree with constraints besides, for identities.
_BESIDES = ("mass_matrix", "bias")


def suits(way: str, tree: Tree) -> bool:
    """Whether a way to a function is for a tree: of constraints and of forces only where it has some."""
    name = way.partition(":")[0]
    needs = FUNCTIONS[name].needs
    if tree.asked:
        return tree.asked in needs
    if tree.constraints:
        return name in CONSTRAINED or way in _BESIDES
    if needs:
        return bool(tree.demands & set(needs))
    if tree.sensors:
        return name in _SENSED
    return name in STEPS or name in _ACTED_ON if tree.forces else name not in CONSTRAINED
