"""Drake's steps, forces of a plant's own, reactions and sensors."""

from __future__ import annotations

import re
from collections.abc import Mapping

from ...interface import STEP, Actuator, Tree, Unsupported
from ...truth.sensed import WRENCH
from ..writing.source import Way, ways_of

SPEEDS = "p.SetVelocities(c, v)\n"
QV = f"p.SetPositions(c, q)\n{SPEEDS}"
Q = "p.SetPositions(c, q)\n"
FORCES = "forces = drake.MultibodyForces(p)\np.CalcForceElementsContribution(c, forces)\n"
# A simulator has a context of its own: it may keep one that it is given. It gets the parameters that were changed.
_SIMULATOR = """sim = drake.Simulator(p)
sim.get_mutable_context().SetTimeStateAndParametersFrom(c)
c = sim.get_mutable_context()
c.SetTime(0.0)
"""
_SIMULATION = f"""{_SIMULATOR}INTEGRATOR{QV}p.get_applied_generalized_force_input_port().FixValue(c, tau)
sim.AdvanceTo({STEP})
value = np.r_[p.GetPositions(c), p.GetVelocities(c)]"""
_FIXED = f"""drake.ResetIntegratorFromFlags(sim, 'NAME', {STEP})
sim.get_mutable_integrator().set_fixed_step_mode(True)
"""


# Of servos, where they are to hold their joint, and at what speed.
_PLACE, _SPEED = 0.25, -0.5
SAP = (
    "def sap(p):",
    "    if hasattr(drake, 'DiscreteContactApproximation'):",
    "        p.set_discrete_contact_approximation(drake.DiscreteContactApproximation.kSap)",
    "    else:",
    "        p.set_discrete_contact_solver(drake.DiscreteContactSolver.kSap)",
)


def driven(tree: Tree) -> dict[str, Actuator] | Unsupported:
    """Links whose joints are driven -> actuator, in the order of these: forces, or servos of gains, with one bound."""
    for one in tree.actuators:
        limits = one.force_limits or (0.0, 0.0)
        if not one.is_plain or limits[0] != -limits[1]:
            return Unsupported("actuators are forces or servos along joints, with one bound either way", offered=False)
    if any(joint.force_limits for link in tree.links for joint in link.joints):
        return Unsupported("joints have no bounds of forces of their own", offered=False)
    return {one.link: one for one in tree.actuators}


def actuators(tree: Tree) -> list[str]:
    """Statements of the actuators in their order, then of rotors alone, which have no input."""
    lines, rotors = [], {link.name: link.joints[-1].armature for link in tree.links if any(link.joints[-1].armature)}
    drives = {one.link: one for one in tree.actuators}
    places = [link.name for link in tree.links]
    for name in dict.fromkeys((*drives, *rotors)):
        k, one = places.index(name), drives.get(name, Actuator())
        limit = f", {one.force_limits[1]!r}" if one.force_limits else ""
        lines.append(f"motor = p.AddJointActuator('m{k}', j{k}{limit})")
        if name in rotors:
            lines.append(
                f"motor.set_default_rotor_inertia({rotors[name][0] / 4.0!r}); motor.set_default_gear_ratio(2.0)"
            )
        if any(one.bias):
            gains = f"drake.PdControllerGains(p={-one.bias[1]!r}, d={-one.bias[2]!r})"
            lines.append(f"motor.set_controller_gains({gains})")
    return [*lines, *(SAP if has_servos(tree) else ())]


# Plants with gains of controllers are discrete, as those of old releases must be; what is not asked of a step is asked
# of continuous ones.
DISCRETE = {"Plant(0.0)": f"Plant({STEP})", "p.Finalize()": "sap(p); p.Finalize()"}
_OF_CONTINUOUS = re.compile("forward_dynamics.*|step_(semi_implicit_straight|euler|rk.)|actuat(or|ed)_forces")


def continuous(ways: Mapping[str, Way]) -> dict[str, Way]:
    """Ways with the plants that they are for."""
    built = tuple((own, general) for general, own in DISCRETE.items())
    return {name: one._replace(built=built) if _OF_CONTINUOUS.fullmatch(name) else one for name, one in ways.items()}


def has_servos(tree: Tree) -> bool:
    """Whether an actuator has gains."""
    return any(any(one.bias) for one in tree.actuators)


def spelling(tree: Tree) -> dict[str, str]:
    """Where speeds are set, inputs are, too."""
    if not tree.actuators:
        return {}
    rotors = [link for link in tree.links if any(link.joints[-1].armature)]
    alone = len({link.name for link in rotors} - {one.link for one in tree.actuators})
    inputs = [one.fed(_PLACE, _SPEED) for one in tree.actuators] + [0.0] * alone
    ports = {"get_actuation_input_port()": inputs}
    if has_servos(tree):
        held = [_PLACE] * len(inputs) + [_SPEED] * len(inputs)
        ports["get_desired_state_input_port(drake.default_model_instance())"] = held
    fixed = "".join(f"p.{port}.FixValue(c, {values!r})\n" for port, values in ports.items())
    # Inputs are none of the state that a plant of other numbers takes over.
    many = "".join(
        f"\nx = InitializeAutoDiff(np.array({values!r}), np.zeros(({len(values)}, len(v))))"
        f"\nad.{port}.FixValue(d, x.flatten())"
        for port, values in ports.items()
    )
    return {SPEEDS: f"{SPEEDS}{fixed}", "ad.SetVelocities(d, v_)": f"ad.SetVelocities(d, v_){many}"}


def lacks(tree: Tree) -> tuple[str, ...]:
    """Discrete steps have servos, as dampers, at their end, springs not; controllers want all joints driven."""
    joints = [joint for link in tree.links for joint in link.joints]
    is_stiff = has_servos(tree) and not tree.tendons and not any(joint.stiffness for joint in joints)
    of_dampers, of_servos = "step_dampers_implicit_straight", "step_stiffness_implicit_straight"
    is_whole = len(tree.actuators) == sum(joint.kind != "fixed" for joint in joints)
    without = of_dampers if is_stiff else of_servos
    steps = (without, f"{without}_derivative", f"{without}_force_derivative")
    return (*steps, *(() if is_whole else ("controlled_forces",)))


def _integrated(name: str) -> Way:
    """A step of an integrator that the simulator of a continuous plant has."""
    return Way(name, _SIMULATION.replace("INTEGRATOR", _FIXED.replace("NAME", name)))


WAYS: dict[str, Way] = ways_of(f"""
== step_stiffness_implicit_straight | JointActuator.set_controller_gains | {_SIMULATION.replace("INTEGRATOR", "")}
== controlled_forces | InverseDynamicsController
{QV}gains, state = np.ones(len(v)), np.r_[q, v]
controller = drake.InverseDynamicsController(p, gains, 0 * gains, gains, True)
e = controller.CreateDefaultContext()
controller.get_input_port_estimated_state().FixValue(e, state)
controller.get_input_port_desired_state().FixValue(e, state)
controller.get_input_port_desired_acceleration().FixValue(e, a)
value = controller.get_output_port_control().Eval(e)
""") | {
    "step_dampers_implicit_straight": Way(
        "MultibodyPlant with a time step",
        _SIMULATION.replace("INTEGRATOR", ""),
        0.0,
        (("Plant(0.0)", f"Plant({STEP})"),),
    ),
    "step_semi_implicit_straight": _integrated("semi_explicit_euler"),
    "step_euler": _integrated("explicit_euler"),
    "step_rk2": _integrated("runge_kutta2"),
    "step_rk3": _integrated("runge_kutta3"),
    # Loops are closed but for roundings, which the solver's regularisation makes into speeds.
    "step_at_rest": Way(
        "AdvanceTo with a constraint",
        f"{_SIMULATOR}p.SetPositions(c, q)\np.SetVelocities(c, 0 * v)\n"
        f"sim.AdvanceTo({STEP})\nvalue = np.r_[p.GetPositions(c), p.GetVelocities(c)]",
        1e-9,
        (("p.Finalize()", "p.mutable_gravity_field().set_gravity_vector([0, 0, 0]); p.Finalize()"),),
    ),
    # SAP's solver, in the near-rigid regime for constraints that are stiff: what is left of J v is some 1e-4 of it.
    "step_bound": Way(
        "AdvanceTo: speeds",
        f"{_SIMULATOR}p.SetPositions(c, q)\np.SetVelocities(c, v2)\n"
        "p.get_applied_generalized_force_input_port().FixValue(c, tau)\n"
        f"sim.AdvanceTo({STEP})\nvalue = p.GetVelocities(c)",
        1e-3,
    ),
    "passive_forces": Way(
        "CalcForceElementsContribution",
        f"{QV}{FORCES}zero = 0 * v\nvalue = p.CalcInverseDynamics(c, zero, drake.MultibodyForces(p))"
        " - p.CalcInverseDynamics(c, zero, forces) - p.CalcGravityGeneralizedForces(c)",
    ),
}

_APPLIED = "p.get_applied_generalized_force_input_port().FixValue(c, tau)\n"
# With the forces that make the accelerations a.
DRIVEN = f"{QV}{FORCES}p.get_applied_generalized_force_input_port().FixValue(c, p.CalcInverseDynamics(c, a, forces))\n"
# The diagram, built once, owns the plant, which is of its own for each kind of sensor.
_SENSORS = """if not kept_KIND:
    builder = drake.DiagramBuilder()
    builder.AddSystem(p)
    sensors = [builder.AddSystem(drake.KIND(links[k], X(R, r)MORE)) for k, R, r in sensed]
    for sensor in sensors:
        for name in NAMES:
            builder.Connect(p.GetOutputPort(name), sensor.GetInputPort(name))
    whole = builder.Build()
    kept_KIND.update(whole=whole, sensors=sensors, root=whole.CreateDefaultContext())
sensors, root = kept_KIND["sensors"], kept_KIND["root"]
c = p.GetMyMutableContextFromRoot(root)
"""
_READ = "value = [sensor.get_output_port().Eval(sensor.GetMyContextFromRoot(root)) for sensor in sensors]"


def _sensors(kind: str, *names: str, more: str = "") -> Way:
    """Readings of sensors in a diagram with the plant, which it then owns."""
    text = _SENSORS.replace("KIND", kind).replace("MORE", more).replace("NAMES", repr(("body_poses", *names)))
    return Way(kind, f"{text}{DRIVEN}{_READ}", 0.0, (("p = drake", f"kept_{kind} = {{}}\np = drake"),))


_HELD = """held, value = p.get_reaction_forces_output_port().Eval(c), []
for j in js:
    x, wrench = j.frame_on_child().GetFixedPoseInBodyFrame(), held[j.index()]
    force, moment = (x.rotation().matrix() @ part for part in (wrench.translational(), wrench.rotational()))
    value.append([*force, *(moment + np.cross(x.translation(), force))])"""
WAYS |= (
    ways_of(f"""
== joint_speed_limits | GetVelocityUpperLimits | value = p.GetVelocityUpperLimits()
== joint_limits | GetPositionLowerLimits, GetPositionUpperLimits
value = np.c_[p.GetPositionLowerLimits(), p.GetPositionUpperLimits()]
== joint_limits_of_some | GetPositionLowerLimits, GetPositionUpperLimits
x, value = np.c_[p.GetPositionLowerLimits(), p.GetPositionUpperLimits()], np.zeros((p.num_velocities(), 2))
for j in (p.get_joint(k) for k in p.GetJointIndices()):
    if j.num_positions() == j.num_velocities():
        own = x[j.position_start() : j.position_start() + j.num_positions()]
        value[j.velocity_start() : j.velocity_start() + len(own)] = np.where(np.isfinite(own), own, 0.0)
== joint_wrenches | reaction_forces | {DRIVEN}{_HELD}
== joint_wrenches_driven | reaction_forces | {QV}{_APPLIED}{_HELD}
""")
    | {
        "accelerometers": _sensors(
            "Accelerometer", "body_spatial_velocities", "body_spatial_accelerations", more=", gravity"
        ),
    }
    | ways_of(f"""
== frame_jacobians | CalcJacobianSpatialVelocity of points
{Q}W, V = p.world_frame(), drake.JacobianWrtVariable.kV
links
value = [np.roll(p.CalcJacobianSpatialVelocity(c, V, links[k].body_frame(), r, W, W), 3, axis=0) for k, R, r in sensed]
== actuator_forces | get_net_actuation_output_port | {QV}value = p.get_net_actuation_output_port().Eval(c)
== actuated_forces | MakeActuationMatrix
{QV}value = p.MakeActuationMatrix() @ p.get_net_actuation_output_port().Eval(c)
== forward_dynamics:port | generalized_acceleration output port
{QV}p.get_applied_generalized_force_input_port().FixValue(c, tau)
value = p.get_generalized_acceleration_output_port().Eval(c)
== applied_wrenches | AddInForce, CalcInverseDynamics
{Q}p.SetVelocities(c, np.zeros(p.num_velocities()))
links
applied, zero = drake.MultibodyForces(p), np.zeros(p.num_velocities())
for k, R, r in sensed:
    X = p.EvalBodyPoseInWorld(c, links[k]).rotation().matrix()
    push, turn = X @ R @ {list(WRENCH[:3])}, X @ R @ {list(WRENCH[3:])}
    links[k].AddInForce(c, X @ r, drake.SpatialForce(turn, push), p.world_frame(), applied)
value = p.CalcInverseDynamics(c, zero, drake.MultibodyForces(p)) - p.CalcInverseDynamics(c, zero, applied)
""")
    | {
        "gyroscopes": _sensors("Gyroscope", "body_spatial_velocities"),
    }
)

# As the first link sees them, along its axes.
_SEEN = "A, W, V = links[0].body_frame(), p.world_frame(), drake.JacobianWrtVariable.kV\n"
_EACH = "for b in links"
WAYS |= ways_of(f"""
== relative_poses | CalcRelativeTransform
{Q}{_SEEN}poses = [p.CalcRelativeTransform(c, A, b.body_frame()) {_EACH}]
value = [[*x.translation(), *x.rotation().matrix().flat] for x in poses]
== relative_poses:CalcPointsPositions | CalcPointsPositions, CalcRelativeRotationMatrix
{Q}{_SEEN}value = [[*p.CalcPointsPositions(c, b.body_frame(), [[0], [0], [0]], A).ravel(), \
*p.CalcRelativeRotationMatrix(c, A, b.body_frame()).matrix().flat] {_EACH}]
== relative_velocities | Frame.CalcSpatialVelocity
{QV}{_SEEN}twists = [b.body_frame().CalcSpatialVelocity(c, A, A) {_EACH}]
value = [[*t.translational(), *t.rotational()] for t in twists]
== relative_jacobians | CalcJacobianSpatialVelocity in a frame
{Q}{_SEEN}value = [np.roll(p.CalcJacobianSpatialVelocity(c, V, b.body_frame(), [0, 0, 0], A, A), 3, axis=0) {_EACH}]
== relative_jacobians:translational and angular | CalcJacobianTranslationalVelocity, CalcJacobianAngularVelocity
{Q}{_SEEN}value = [np.r_[p.CalcJacobianTranslationalVelocity(c, V, b.body_frame(), [0, 0, 0], A, A), \
p.CalcJacobianAngularVelocity(c, V, b.body_frame(), A, A)] {_EACH}]
== link_velocity_products:CalcBiasTranslationalAcceleration | CalcBiasTranslationalAcceleration
{QV}{_SEEN}value = [[*p.CalcBiasTranslationalAcceleration(c, V, b.body_frame(), [0, 0, 0], W, W).ravel(), \
*p.CalcBiasSpatialAcceleration(c, V, b.body_frame(), [0, 0, 0], W, W).rotational()] {_EACH}]
== mass_centre_velocity | CalcCenterOfMassTranslationalVelocityInWorld
{QV}value = p.CalcCenterOfMassTranslationalVelocityInWorld(c)
== mechanical_energy | EvalKineticEnergy, EvalPotentialEnergy
{QV}value = p.EvalKineticEnergy(c) + p.EvalPotentialEnergy(c)
== coordinate_rates | MapVelocityToQDot | {QV}value = p.MapVelocityToQDot(c, v)
== coordinate_rates:MakeVelocityToQDotMap | MakeVelocityToQDotMap | {QV}value = p.MakeVelocityToQDotMap(c).toarray() @ v
== speeds_of_rates | MapQDotToVelocity | {QV}value = p.MapQDotToVelocity(c, p.MapVelocityToQDot(c, v))
== speeds_of_rates:MakeQDotToVelocityMap | MakeQDotToVelocityMap
{QV}value = p.MakeQDotToVelocityMap(c).toarray() @ p.MapVelocityToQDot(c, v)
== link_accelerations_driven | body_spatial_accelerations output port
{QV}p.get_applied_generalized_force_input_port().FixValue(c, tau)
every = p.get_body_spatial_accelerations_output_port().Eval(c)
value = [[*every[b.index()].translational(), *every[b.index()].rotational()] {_EACH}]
== carried_inertias | CalcSpatialInertia
{Q}value = []
def below(b): return [b.index()] + [k for x in links if parents[links.index(x)] == links.index(b) for k in below(x)]
for b in links:
    K = p.CalcSpatialInertia(c, b.body_frame(), below(b))
    value.append(np.roll(K.CopyToFullMatrix6(), (3, 3), (0, 1)))
""")
