"""Drake's force elements and what pulls at a body: bushings, hinges of doors, propellers, wings."""

from __future__ import annotations

from collections.abc import Sequence

from ...frames import ORIGIN
from ...truth.features.elements import FORCES, HINGE, PROPELLERS, TORQUES, WING
from ...truth.geometry.poses import CENTRE
from ..writing.source import Way, ways_of

_X = "R = drake.RotationMatrix(drake.Quaternion(q))\n"
_Q = "Q = drake.RotationMatrix(drake.Quaternion(q2))\n"
# A body that is free, without gravity, and of moments that are equal: no speeds bring forces.
_BODY = """p = drake.MultibodyPlant(0.0)
p.mutable_gravity_field().set_gravity_vector([0.0, 0.0, 0.0])
b = p.AddRigidBody('b', drake.SpatialInertia(2.0, np.zeros(3), drake.UnitInertia(0.5, 0.5, 0.5)))
"""
_AT = "p.Finalize()\nc = p.CreateDefaultContext()\np.SetPositions(c, np.r_[q, a])\np.SetVelocities(c, np.r_[v, v2])\n"
_SUM = "forces = drake.MultibodyForces(p)\np.CalcForceElementsContribution(c, forces)\n"
_WORLD = "p.world_frame()"


def _bushing(torques: object, forces: object) -> str:
    """A free body with a bushing."""
    constants = ", ".join(str([*row]) for row in (*torques, *forces))  # type: ignore[misc]
    return (
        f"{_BODY}C = p.AddFrame(drake.FixedOffsetFrame('C', b.body_frame(), drake.RigidTransform({list(CENTRE)})))\n"
        f"k = p.AddForceElement(drake.LinearBushingRollPitchYaw({_WORLD}, C, {constants}))\n{_AT}"
    )


_OTHERS = tuple(tuple(2.0 * x for x in row) for row in TORQUES), tuple(tuple(3.0 * x for x in row) for row in FORCES)
_GENERAL = f"{_SUM}F = -p.CalcInverseDynamics(c, np.zeros(6), forces)\nvalue = [*F[3:], *F[:3]]"
_HINGE = f"k = drake.DoorHingeConfig()\nfor name, x in {HINGE!r}.items(): setattr(k, name, x)\n"
_DOOR = """p = drake.MultibodyPlant(0.0)
b = p.AddRigidBody('b', drake.SpatialInertia(2.0, np.zeros(3), drake.UnitInertia(0.5, 0.5, 0.5)))
j = p.AddJoint(drake.RevoluteJoint('j', p.world_frame(), b.body_frame(), [0, 0, 1]))
"""
_TORQUES = "value = [h.CalcHingeTorque(v[0], v[1]), h.CalcHingeSpringTorque(v[0]), h.CalcHingeFrictionalTorque(v[1])]"
_POSES = "[drake.RigidTransform(), drake.RigidTransform(R, a)]"
_TWISTS = "[drake.SpatialVelocity.Zero(), drake.SpatialVelocity(w=v, v=v2)]"
_INFO = ", ".join(
    "drake.PropellerInfo(drake.BodyIndex(1), drake.RigidTransform(Q, "
    f"{[sign * x for x in CENTRE]}), {ratios[0]}, {ratios[1]})"
    for sign, ratios in zip((1.0, -1.0), PROPELLERS, strict=True)
)


def _wing(place: Sequence[float]) -> Way:
    """A wing at a place of the body."""
    placed = f"drake.BodyIndex(1), {WING[0]}, drake.RigidTransform(Q, {list(place)}), {WING[1]}"
    return Way(
        "Wing",
        f"{_X}{_Q}s = drake.Wing({placed})\nc = s.CreateDefaultContext()\n"
        f"s.get_body_poses_input_port().FixValue(c, {_POSES})\n"
        f"s.get_body_spatial_velocities_input_port().FixValue(c, {_TWISTS})\n"
        "s.get_wind_velocity_input_port().FixValue(c, tau)\n"
        "F = s.get_spatial_force_output_port().Eval(c)[0]\n"
        "value = [*F.F_Bq_W.translational(), *s.get_aerodynamic_center_output_port().Eval(c)]",
    )


_MODELS = """p = drake.MultibodyPlant(0.0)
for k, name in enumerate(('one', 'other')):
    m = p.AddModelInstance(name)
    b = p.AddRigidBody(name, m, drake.SpatialInertia(1.0 + k, np.zeros(3), drake.UnitInertia(0.5, 0.5, 0.5)))
    p.AddJoint(drake.PrismaticJoint(name, p.world_frame(), b.body_frame(), [0, 0, 1]))
p.set_gravity_enabled(m, False)
p.Finalize()
c = p.CreateDefaultContext()
"""
WAYS = ways_of(f"""
== bushing_wrench | LinearBushingRollPitchYaw | {_bushing(TORQUES, FORCES)}{_GENERAL}
== bushing_wrench:CalcBushingSpatialForceOnFrameC | LinearBushingRollPitchYaw.CalcBushingSpatialForceOnFrameC
{_bushing(TORQUES, FORCES)}{_X}F = k.CalcBushingSpatialForceOnFrameC(c)
F = F.Shift({[-x for x in CENTRE]}).Rotate(R)
value = [*F.translational(), *F.rotational()]
== bushing_wrench:CalcBushingSpatialForceOnFrameA | LinearBushingRollPitchYaw.CalcBushingSpatialForceOnFrameA
{_bushing(TORQUES, FORCES)}F = k.CalcBushingSpatialForceOnFrameA(c).Shift(a)
value = [*-F.translational(), *-F.rotational()]
""") | {
    "bushing_wrench:parameters": Way(
        "LinearBushingRollPitchYaw.SetForceStiffnessConstants, SetTorqueDampingConstants",
        _bushing(*_OTHERS)
        + "".join(
            f"k.Set{what}{how}Constants(c, {[*row]})\n"
            for what, rows in (("Torque", TORQUES), ("Force", FORCES))
            for how, row in zip(("Stiffness", "Damping"), rows, strict=True)
        )
        + f"{_SUM}F = b.GetForceInWorld(c, forces)\nvalue = [*F.translational(), *F.rotational()]",
    ),
    "hinge_torques": Way("DoorHinge.CalcHingeTorque", f"{_HINGE}{_DOOR}h = drake.DoorHinge(j, k)\n{_TORQUES}"),
    "hinge_torques:plant": Way(
        "DoorHinge",
        f"{_HINGE}{_DOOR}p.AddForceElement(drake.DoorHinge(j, k))\np.Finalize()\nc = p.CreateDefaultContext()\n"
        "def torque(angle, speed):\n    j.set_angle(c, angle)\n    j.set_angular_rate(c, speed)\n"
        "    forces = drake.MultibodyForces(p)\n    p.CalcForceElementsContribution(c, forces)\n"
        "    return forces.generalized_forces()[0]\n"
        "value = [torque(v[0], v[1]), torque(v[0], 0.0), torque(v[0], v[1]) - torque(v[0], 0.0)]",
    ),
    "propeller_wrenches": Way(
        "Propeller",
        f"{_X}{_Q}s = drake.Propeller([{_INFO}])\nc = s.CreateDefaultContext()\n"
        f"s.get_command_input_port().FixValue(c, v[:2])\ns.get_body_poses_input_port().FixValue(c, {_POSES})\n"
        "value = np.ravel([[*F.F_Bq_W.translational(), *F.F_Bq_W.rotational()]"
        " for F in s.get_spatial_forces_output_port().Eval(c)])",
    ),
    "wing_force": _wing(CENTRE),
    "wing_force_at_origin": _wing(ORIGIN),
    "weights_of_models": Way("set_gravity_enabled", f"{_MODELS}value = p.CalcGravityGeneralizedForces(c)"),
    "weights_of_models:CalcForceElementsContribution": Way(
        "set_gravity_enabled, CalcForceElementsContribution",
        f"{_MODELS}{_SUM}value = -p.CalcInverseDynamics(c, np.zeros(2), forces)",
    ),
}
