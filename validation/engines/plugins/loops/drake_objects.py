"""What Drake offers by its objects: joints, bodies and frames of a plant, ports, rates of coordinates, powers."""

from __future__ import annotations

from ...truth.points import POINT
from ...truth.sensed import WRENCH
from ..writing.source import Way, ways_of
from .drake_forces import DRIVEN, FORCES, QV, Q

# Type of a joint -> what it sets and reads of its coordinates and of its speeds, each with its size.
_JOINTS = {
    "revolute": (("angle", 1), ("angular_rate", 1)),
    "prismatic": (("translation", 1), ("translation_rate", 1)),
    "screw": (("rotation", 1), ("angular_velocity", 1)),
    "universal": (("angles", 2), ("angular_rates", 2)),
    "ball_rpy": (("angles", 3), ("angular_velocity", 3)),
    "planar": (("translation", 2), ("rotation", 1), ("translational_velocity", 2), ("angular_velocity", 1)),
    "quaternion_floating": (
        *(("quaternion", 4), ("translation", 3)),
        *(("angular_velocity", 3), ("translational_velocity", 3)),
    ),
    "rpy_floating": (("angles", 3), ("translation", 3), ("angular_velocity", 3), ("translational_velocity", 3)),
}
_PARTS = f"""parts, state = {_JOINTS!r}, {{}}
def each(j):
    at = {{False: j.position_start(), True: j.velocity_start()}}
    for name, size in parts.get(j.type_name(), ()):
        of_speeds = name.startswith('angular') or name.endswith(('velocity', 'rate'))
        yield name, of_speeds, slice(at[of_speeds], at[of_speeds] + size)
        at[of_speeds] += size
"""
_BY_JOINTS = f"""js
{_PARTS}for j in js:
    for name, of_speeds, own in each(j):
        x = (v if of_speeds else q)[own]
        if j.type_name() == 'screw' and name == 'rotation':  # Python has no setter of it.
            name, x = 'translation', x * j.screw_pitch() / (2 * np.pi)
        x = drake.Quaternion(x) if name == 'quaternion' else x if len(x) > 1 else x[0]
        floating = {{'quaternion': 'SetQuaternion', 'translation': 'SetTranslation'}}
        known = floating.get(name, '') if 'floating' in j.type_name() else ''
        getattr(j, known or f'set_{{name}}')(c, x)
"""
_READ = f"""js
{_PARTS}value = np.zeros(len(WHICH))
for j in js:
    for name, of_speeds, own in each(j):
        if of_speeds == SPEEDS:
            x = getattr(j, f'get_{{name}}')(c)
            value[own] = x.wxyz() if name == 'quaternion' else x
"""
_W = "W, kV, kQ = p.world_frame(), drake.JacobianWrtVariable.kV, drake.JacobianWrtVariable.kQDot\n"
_N = "N = p.MakeVelocityToQDotMap(c).toarray()\n"
_AT = f"np.array([{list(POINT)}]).T"
_OWN = f"{_W}own = [p.GetFrameByName(f'o{{k}}') for k in range(len(sensed))]\n"
_SEEN = "A = links[0].body_frame()\n"


def _each(of: str, over: str = "b in links") -> str:
    """Spatial vectors of things, of which the angular part comes first."""
    return f"each_one = [{of} for {over}]\nvalue = [[*x.translational(), *x.rotational()] for x in each_one]"


def _poses(of: str, over: str = "b in links") -> str:
    return f"at = [{of} for {over}]\nvalue = [[*x.translation(), *x.rotation().matrix().flat] for x in at]"


_SPATIAL = f"""applied = []
for k, R, r in sensed:
    one, X = drake.ExternallyAppliedSpatialForce(), p.EvalBodyPoseInWorld(c, links[k]).rotation().matrix()
    one.body_index, one.p_BoBq_B = links[k].index(), r
    one.F_Bq_W = drake.SpatialForce(X @ R @ {list(WRENCH[3:])}, X @ R @ {list(WRENCH[:3])})
    applied.append(one)
"""
_OF_JOINTS = "joints' own setters"
_GET_FIXED_POSE_IN_BODY_FRAME = f"{Q}{_OWN}" + _poses(
    "drake.RigidTransform(f.body().EvalPoseInWorld(c).rotation() @ f.GetFixedRotationMatrixInBodyFrame(),"
    " f.body().EvalPoseInWorld(c) @ f.GetFixedPoseInBodyFrame().translation())",
    "f in own",
)
WAYS = ways_of(f"""
== frame_poses | Frame.CalcPoseInWorld | {Q}{_OWN}{_poses("f.CalcPoseInWorld(c)", "f in own")}
== frame_poses_seen | Frame.CalcPose | {Q}{_OWN}{_poses("f.CalcPose(c, own[0])", "f in own")}
== frame_velocities | Frame.CalcSpatialVelocityInWorld
{QV}{_OWN}{_each("f.CalcSpatialVelocityInWorld(c)", "f in own")}
== frame_velocities_seen | Frame.CalcSpatialVelocity
{QV}{_OWN}{_each("f.CalcSpatialVelocity(c, own[0], own[0])", "f in own")}
== frame_accelerations | Frame.CalcSpatialAccelerationInWorld
{DRIVEN}{_OWN}{_each("f.CalcSpatialAccelerationInWorld(c)", "f in own")}
== frame_velocity_products | CalcBiasSpatialAcceleration of a frame
{QV}{_OWN}{_each("p.CalcBiasSpatialAcceleration(c, kV, f, [0, 0, 0], W, W)", "f in own")}
== frame_jacobians:frame | CalcJacobianSpatialVelocity of a frame
{Q}{_OWN}value = [np.roll(p.CalcJacobianSpatialVelocity(c, kV, f, [0, 0, 0], W, W), 3, axis=0) for f in own]
== frame_poses:CalcRotationMatrixInWorld | Frame.CalcRotationMatrixInWorld, CalcPointsPositions
{Q}{_OWN}value = [[*p.CalcPointsPositions(c, f, [[0], [0], [0]], W).ravel(), \
*f.CalcRotationMatrixInWorld(c).matrix().flat] for f in own]
== frame_poses:CalcPoseInBodyFrame | Frame.CalcPoseInBodyFrame
{Q}{_OWN}{_poses("f.body().EvalPoseInWorld(c) @ f.CalcPoseInBodyFrame(c)", "f in own")}
== frame_poses:GetFixedPoseInBodyFrame | Frame.GetFixedPoseInBodyFrame, GetFixedRotationMatrixInBodyFrame
{_GET_FIXED_POSE_IN_BODY_FRAME}
== frame_poses_seen:CalcRotationMatrix | Frame.CalcRotationMatrix, CalcPointsPositions in a frame
{Q}{_OWN}value = [[*p.CalcPointsPositions(c, f, [[0], [0], [0]], own[0]).ravel(), *f.CalcRotationMatrix(c, \
own[0]).matrix().flat] for f in own]
== frame_velocities:CalcRelativeSpatialVelocity | Frame.CalcRelativeSpatialVelocity
{QV}{_OWN}{_each("f.CalcRelativeSpatialVelocity(c, W, W, W)", "f in own")}
== gyroscopes:CalcAngularVelocity | Frame.CalcAngularVelocity
{QV}{_OWN}value = [f.CalcAngularVelocity(c, W, f) for f in own]
== velocimeters | Frame.CalcSpatialVelocity
{QV}{_OWN}value = [f.CalcSpatialVelocity(c, W, f).translational() for f in own]
""")
WAYS |= {
    f"{name}:joints": Way(_OF_JOINTS, _BY_JOINTS + code)
    for name, code in {
        "link_poses": _poses("b.EvalPoseInWorld(c)"),
        "link_velocities": _each("b.EvalSpatialVelocityInWorld(c)"),
        "coriolis_forces": "value = p.CalcBiasTerm(c)",
    }.items()
}
WAYS |= ways_of(f"""
== coordinates_of_links | {_OF_JOINTS} | {_BY_JOINTS}value = p.GetPositions(c)
== coordinates_of_links:getters | joints' own getters | {QV}{_READ.replace("WHICH", "q").replace("SPEEDS", "False")}
== # By poses: a default quaternion may be kept as the opposite one, which is the same orientation.
== link_poses:SetDefaultPositions | SetDefaultPositions
p.SetDefaultPositions(q)
c = p.CreateDefaultContext()
{_poses("b.EvalPoseInWorld(c)")}
== speeds_of_links | {_OF_JOINTS} | {_BY_JOINTS}value = p.GetVelocities(c)
== speeds_of_links:getters | joints' own getters | {QV}{_READ.replace("WHICH", "v").replace("SPEEDS", "True")}
== link_poses:body_poses | body_poses output port
{Q}every = p.get_body_poses_output_port().Eval(c)
{_poses("every[b.index()]")}
== link_velocities:body_spatial_velocities | body_spatial_velocities output port
{QV}every = p.get_body_spatial_velocities_output_port().Eval(c)
{_each("every[b.index()]")}
== link_turning | RigidBody.EvalSpatialVelocityInWorld
{QV}value = [b.EvalSpatialVelocityInWorld(c).rotational() for b in links]
== link_turning:port | body_spatial_velocities output port
{QV}every = p.get_body_spatial_velocities_output_port().Eval(c)
value = [every[b.index()].rotational() for b in links]
== link_turning:EvalAngularVelocityInWorld | Frame.EvalAngularVelocityInWorld
{QV}value = [b.body_frame().EvalAngularVelocityInWorld(c) for b in links]
== link_accelerations:RigidBody | RigidBody.EvalSpatialAccelerationInWorld
{DRIVEN}{_each("b.EvalSpatialAccelerationInWorld(c)")}
== relative_accelerations | Frame.CalcSpatialAcceleration
{DRIVEN}{_SEEN}{_each("b.body_frame().CalcSpatialAcceleration(c, A, A)")}
== link_jacobians:kQDot | CalcJacobianSpatialVelocity, kQDot
{Q}{_W}{_N}value = [np.roll(p.CalcJacobianSpatialVelocity(c, kQ, b.body_frame(), [0, 0, 0], W, W), 3, axis=0) @ N for \
b in links]
== relative_jacobians:kQDot | CalcJacobianSpatialVelocity in a frame, kQDot
{Q}{_W}{_N}{_SEEN}value = [np.roll(p.CalcJacobianSpatialVelocity(c, kQ, b.body_frame(), [0, 0, 0], A, A), 3, axis=0) @ \
N for b in links]
== mass_centre_jacobian:kQDot | CalcJacobianCenterOfMassTranslationalVelocity, kQDot
{Q}{_W}{_N}value = p.CalcJacobianCenterOfMassTranslationalVelocity(c, kQ, W, W) @ N
== point_jacobians:CalcJacobianPositionVector | CalcJacobianPositionVector
{Q}{_W}{_N}value = [p.CalcJacobianPositionVector(c, b.body_frame(), {_AT}, W, W) @ N for b in links]
== point_velocities | CalcPointsVelocities
{QV}{_W}value = [p.CalcPointsVelocities(c, b.body_frame(), {_AT}, W, W).ravel() for b in links]
== inverse_dynamics:CalcImplicitTimeDerivativesResidual | CalcImplicitTimeDerivativesResidual
{QV}rates = p.AllocateTimeDerivatives()
rates.SetFromVector(np.r_[p.MapVelocityToQDot(c, v), a])
value = p.CalcImplicitTimeDerivativesResidual(c, rates)[-len(v) :]
== gravity:CalcGeneralizedForces | CalcForceElementsContribution, CalcGeneralizedForces
p.SetPositions(c, q)
{FORCES}value = -p.CalcGeneralizedForces(c, forces)
== stored_energy_rate | CalcConservativePower | {QV}value = -p.CalcConservativePower(c)
== applied_wrenches:applied_spatial_force | applied_spatial_force input port
{Q}p.SetVelocities(c, np.zeros(p.num_velocities()))
links
p.get_applied_spatial_force_input_port().FixValue(c, [])
before = p.EvalTimeDerivatives(c).CopyToVector()[-p.num_velocities() :]
{_SPATIAL}p.get_applied_spatial_force_input_port().FixValue(c, applied)
after = p.EvalTimeDerivatives(c).CopyToVector()[-p.num_velocities() :]
value = p.CalcMassMatrix(c) @ (after - before)
""")

# Bodies, and frames on them, are each of a model instance of its own, so that each joint is between two.
_INSTANCES = (
    (".body_frame()", ".beside()"),
    (
        "p = drake",
        """def own(): return p.AddModelInstance(f'one of {p.num_model_instances()}')
frame = drake.FixedOffsetFrame
def beside(b): return p.AddFrame(frame(f'beside {b.name()}', b.body_frame(), drake.RigidTransform(), own()))
def body(name, inertia):
    b = drake.MultibodyPlant.AddRigidBody(p, name, own(), inertia)
    type(b).beside = beside
    return b
def offset(name, on, X): return frame(name, on if isinstance(on, drake.Frame) else on.body_frame(), X, own())
p = drake""",
    ),
    ("p.AddRigidBody(", "body("),
    ("drake.FixedOffsetFrame(", "offset("),
)
_OWN = """x = np.full(len(q) + len(v), np.nan)
for j in js:
    k, n, m = j.model_instance(), j.num_positions(), j.num_velocities()
    at = x[: len(q)][j.position_start() :][:n], x[len(q) :][j.velocity_start() :][:m]
    for own, of in zip(at, OF):
        if len(of) == len(own): own[:] = of
value = x"""
WAYS |= {
    f"coordinates{name}": Way(native, code, built=_INSTANCES)
    for name, native, code in (
        (
            "",
            "GetPositions, GetVelocities of model instances",
            f"{QV}{_OWN.replace('OF', '(p.GetPositions(c, k), p.GetVelocities(c, k))')}",
        ),
        (
            ":from arrays",
            "GetPositionsFromArray, GetVelocitiesFromArray",
            _OWN.replace("OF", "(p.GetPositionsFromArray(k, q), p.GetVelocitiesFromArray(k, v))"),
        ),
        (
            ":set",
            "SetPositions, SetVelocities of model instances",
            """js
for j in js[::-1]:
    k, at, to = j.model_instance(), j.position_start(), j.velocity_start()
    p.SetPositions(c, k, np.resize(q[at : at + j.num_positions()], p.num_positions(k)))
    p.SetVelocities(c, k, np.resize(v[to : to + j.num_velocities()], p.num_velocities(k)))
value = p.GetPositionsAndVelocities(c)""",
        ),
    )
}
