"""What engines have beside trees: force elements, drives, tanks, parameters, trajectories, controllers."""

from __future__ import annotations

from ..frames import ORIGIN
from ..truth.derived import TruthOf
from ..truth.features import drives, elements, parameters, systems
from ..truth.geometry import bodies, curves
from ..truth.geometry.poses import CENTRE, MASS
from ..truth.spaceflight import tanks
from .function import Function, functions_of

_OF_TANKS = (
    ("centre", "z of the mass centre (1)", tanks.centre),
    ("centre_rate", "its time derivative (1)", tanks.centre_rate),
    ("moments", "moments about x, y, z (3)", tanks.moments),
    ("moment_rates", "their time derivatives (3)", tanks.moment_rates),
)
_TANKS = functions_of(
    {
        f"tank_{name}_{kind}": (f"{words} of a tank {kind}", of(kind))
        for kind in tanks.TANKS
        for name, words, of in _OF_TANKS
    },
    "turns",
)


def _elements() -> dict[str, Function]:
    """Functions of a body at (R, a) that turns with v and moves with v2, Q the rotation of q2."""
    rows = {
        "bushing_wrench": (
            "force, moment about its origin, of a bushing between the world and a point of the body (6)",
            elements.bushing,
        ),
        "hinge_torques": ("torque of a door's hinge, its parts of angle v[0] and of rate v[1] (3)", elements.hinge),
        "propeller_wrenches": ("forces and moments of two propellers at commands v (12)", elements.propellers),
        "wing_force": ("force of a flat plate in the wind tau, and where it acts (6)", elements.wing(CENTRE)),
        "wing_force_at_origin": ("the same of a plate at the body's origin (6)", elements.wing(ORIGIN)),
        "weights_of_models": ("forces of gravity on two bodies, for one of which it is off (2)", elements.weights),
    }
    return functions_of(rows, "force elements")


def _bodies() -> dict[str, Function]:
    """Mass, mass centre, moments (10) of solids of the sizes |v| + 1/2, along v2 + (8, 4, 4)."""
    rows: dict[str, tuple[str, TruthOf]] = {}
    for one in bodies.SOLIDS:
        rows[f"solid_{one}_of_density"] = f"of a {one} of {bodies.DENSITY} kg/m^3 (10)", bodies.solid(one, True)
        rows[f"solid_{one}_of_mass"] = f"of a {one} of {MASS} kg (10)", bodies.solid(one, False)
        rows[f"shape_{one}"] = f"of a {one} of {bodies.DENSITY} kg/m^3 along z (10)", bodies.solid(one, True, False)
        rows[f"volume_{one}"] = f"volume of a {one} (1)", bodies.volumes(one)
    apart = (2.0, 0.5, 4.0)
    rows |= {
        "cylinder_about_end_of_density": ("of a cylinder, about its end (10)", bodies.cylinder_about_end(True)),
        "cylinder_about_end_of_mass": (f"the same of {MASS} kg (10)", bodies.cylinder_about_end(False)),
        "rod": ("of a thin rod (10)", bodies.rod),
        "rod_about_end": ("of a thin rod about its end (10)", bodies.rod_about_end),
        "point_mass": ("of a point at v (10)", bodies.point),
        "mesh_dented": ("of a tetrahedron with a dent, within triangles (10)", bodies.mesh(bodies.DENTED)),
        "mesh_scaled": ("the same, twice as large (10)", bodies.mesh(bodies.DENTED, (2.0, 2.0, 2.0))),
        "mesh_scaled_apart": (f"the same, {apart} times as large (10)", bodies.mesh(bodies.DENTED, apart)),
        "convex_hull_of_mesh": ("of the convex hull of that body (10)", bodies.mesh(bodies.HULL)),
        "convex_hull_scaled_apart": (f"the same, {apart} times as large (10)", bodies.mesh(bodies.HULL, apart)),
        "moments_turned": ("moments and products about the mass centre, turned by R (6)", bodies.central),
        "moments_shifted": ("the same about a point at v (6)", bodies.about_point),
        "moments_shifted_on": ("the same about a point at v2, from those about v (6)", bodies.about_other_point),
        "moments_traced": ("sum of moments, and the largest possible one (2)", bodies.trace),
        "first_moment": ("mass times mass centre (3)", bodies.first_moment),
    }
    return functions_of(rows, "inertias of solids, meshes and convex hulls")


def _parameters() -> dict[str, Function]:
    """Sizes x are |v| + 1/2; of slides along x, y, z v are coordinates, a speeds, tau forces."""
    rows = {
        "mass_with_rotor": ("mass matrix with the rotor x[0] behind the gear x[1] (1)", parameters.geared),
        "acceleration_with_rotor": ("acceleration of that under tau[0] (1)", parameters.geared_acceleration),
        "rotor_and_gear": ("rotor inertia, ratio, and what these add to the mass matrix (3)", parameters.reflected),
        "coordinates_set": ("coordinates, once they are set (3)", lambda t, s: s.v),
        "speeds_set": ("speeds, once they are set (3)", lambda t, s: s.a),
        "states_of_models": ("coordinates and speeds of one model, then of the other (6)", parameters.parts),
        "sums_of_models": ("masses, mass centres and a velocity of models (15)", parameters.sums),
        "momenta_of_models": ("momentum of one model, and that about tau (6)", parameters.momenta),
        "accelerations_forced": ("accelerations under tau and gravity (3)", parameters.accelerations),
        "impulsive_speeds": ("speeds after the impulses tau (3)", parameters.after_impulse),
        "masses_set": ("mass matrix with the masses x (3, 3)", parameters.set_masses),
        "limits_set": ("limits of coordinates, speeds, accelerations (6, 3)", parameters.limits),
        "damping_set": ("forces of the dampers x (3)", parameters.damped),
        "power_of_damping": ("power of these (1)", parameters.lost_power),
        "coordinates_of_anchored": ("position of a free body at v, of a joint anchored at a (3)", parameters.anchored),
        "velocity_of_turned_copy": (
            "velocities v, a of a body in a model that is added turned by R (6)",
            parameters.turned_velocity,
        ),
        "areas_of_triangles": ("areas of two triangles that a flat one stands between (2)", parameters.areas),
        "spring_set": ("force and energy of a spring of stiffness x[0], rest x[1], at v[2] (2)", parameters.sprung),
    }
    steps = {
        "step_of_locked": ("coordinates, speeds after a step with the second slide locked (6)", parameters.locked),
        "step_of_unlocked": ("the same with none locked (6)", parameters.unlocked),
        "step_of_held_distance": ("two slides after a step with a spring between them (4)", parameters.held_distance),
        "step_of_freed_distance": ("the same without that spring (4)", parameters.free_distance),
        "goal_of_locked": (
            "coordinates of two slides at a goal of the first, the second locked (2)",
            parameters.goal_of_locked,
        ),
        "step_of_coupled": ("speeds after a step of coupled slides (2)", parameters.coupled),
    }
    of_defaults = functions_of(rows, "defaults and parameters: gears, rotors, dampers, model instances")
    return of_defaults | functions_of(steps, "joints that are locked, held and coupled in a step")


def _curves() -> dict[str, Function]:
    """Curves of samples v, a, tau, v2 (`curves`), at a time within them."""
    rows: dict[str, tuple[str, TruthOf]] = {}
    for one in curves.CURVES:
        rows[f"curve_{one}"] = f"the curve '{one}' of four samples (3)", curves.value(one)
        rows[f"curve_{one}_rate"] = "its first derivative (3)", curves.speed(one)
        rows[f"curve_{one}_second_rate"] = "its second derivative (3)", curves.bend(one)
    rows |= {
        "curve_backwards": ("the curve 'hermite' from its end, at half the pace (3)", curves.backwards),
        "curve_along_path": ("rate of the curve 'hermite' at a time that is a parabola (3)", curves.along_path),
        "curve_growing": ("straight pieces and an exponential of v (3)", curves.growing),
        "turns_between": ("rows of the rotation on the way from R by Q to R Q (9)", curves.orientation),
        "turning_between": ("its angular velocity along the axes before (3)", curves.turning),
        "pose_between": ("position on straight pieces and that rotation (12)", curves.pose),
        "twist_between": ("velocity and angular velocity of these (6)", curves.twist),
    }
    return functions_of(rows, "trajectories")


def _systems() -> dict[str, Function]:
    """Functions of x' = A x + b and what is made of it (`systems`); spatial vectors."""
    steps: dict[str, tuple[str, TruthOf]] = {
        f"linear_step_{one}": (f"x after a step of {one.replace('_', ' ')} (3)", systems.stepped(one))
        for one in systems.INTEGRATORS
    }
    controllers = {
        "linear_update": ("x after a period of a discrete system (3)", systems.after_update),
        "linear_output": ("C x + D u (3)", systems.output),
        "pendulum_linear": ("A and B of a pendulum that is held (2, 3)", systems.pendulum),
        "pendulum_torque": ("torque that accelerates it by a[0] (1)", systems.pendulum_torque),
        "pendulum_holding": ("torque that holds it (1)", systems.pendulum_holding),
        "pendulum_stiffness": ("the same, and gains of what lacks to v (1)", systems.pendulum_stiffness),
        "regulator": ("K and S of x'' = u with weights (6)", systems.regulator),
        "regulator_discrete": ("K and S of x+ = a x + b u (2)", systems.discrete_regulator),
        "lyapunov": ("X of the equation that X was put into (3, 3)", systems.solution),
        "controllability": ("(b, A b, A^2 b) (3, 3)", systems.controllability),
        "controlled_by_gains": ("gains of an error, its integral and its rate (3)", systems.controlled),
        "filtered_rate": ("rate of a filter of first order (3)", systems.filtered_rate),
        "waves": ("a sine, its first and second derivative (3)", systems.waves),
    }
    vectors = {
        "velocity_composed": ("twist of a frame that moves in a moving one (6)", systems.velocity_composed),
        "acceleration_composed": ("its acceleration (6)", systems.acceleration_composed),
        "acceleration_shifted": ("acceleration at another point of a frame (6)", systems.acceleration_shifted),
        "power_of_wrench": ("power of a wrench along a twist (1)", systems.power),
        "nearest_quaternion": ("q or -q: near to q2, with w not negative (8)", systems.nearest_quaternion),
        "turns_about_axes": ("rows of turns about x, y, z, and R (9)", systems.axes_of_turns),
    }
    return functions_of(steps | controllers, "linear systems and controllers") | functions_of(vectors, "turns")


def _drives() -> dict[str, Function]:
    """A slide of 2 kg at tau[0] that moves with a[0], commanded v[0], without gravity (`drives`)."""
    rows: dict[str, tuple[str, TruthOf]] = {
        f"slide_{name}": (f"coordinate and speed after a step {words} (2)", truth)
        for name, (words, truth) in drives.DRIVES.items()
    }
    return functions_of(rows, "servos, motors, dry friction and joints at limits")


FEATURES = _TANKS | _elements() | _bodies() | _parameters() | _curves() | _systems() | _drives()
