"""DART's actuators, dry friction and limits, what joints and skeletons are given, free joints, frames and inertias."""

from __future__ import annotations

from ...interface import STEP
from ...truth.features.drives import ACCELERATION, FORCE, FRICTION, LIMIT, MASS, SPEED
from ...truth.features.parameters import GRAVITY, MASSES
from ...truth.geometry.poses import CENTRE, MOMENTS
from ...truth.geometry.poses import MASS as OF_BODY
from ..writing.source import Way, ways_of

_SLIDE = f"""world, s = dart.simulation.World(), dart.dynamics.Skeleton('s')
world.setTimeStep({STEP})
world.setGravity(np.array([PULL, 0.0, 0.0]))
j, b = s.createPrismaticJointAndBodyNodePair(None)
j.setAxis([1.0, 0.0, 0.0])
b.setInertia(dart.dynamics.Inertia({MASS}, np.zeros(3), np.eye(3)))
world.addSkeleton(s)
"""
_FREE = _SLIDE.replace("PULL", "0.0")
_AT = "j.setPosition(0, tau[0] / (1 + abs(tau[0])))\nj.setVelocity(0, a[0])\n"
_ON_LIMIT = f"j.setPositionUpperLimit(0, {LIMIT})\nj.setPositionLowerLimit(0, -9.0)\nj.setLimitEnforcement(True)\n"
_STEP = "world.step()\nvalue = [j.getPosition(0), j.getVelocity(0)]"
_COMMAND = "j.setCommand(0, v[0])\n"


# Part of a speed that constraints leave, by their ConstraintForceMixing.
_MIXED = 1e-8


def _driven(kind: str, more: str = "", command: str = _COMMAND) -> str:
    return f"{_FREE}j.setActuatorType(dart.dynamics.ActuatorType.{kind})\n{more}{_AT}{command}{_STEP}"


def _bound(what: str, size: float) -> str:
    return f"j.set{what}LowerLimit(0, {-size})\nj.set{what}UpperLimit(0, {size})\n"


WAYS = ways_of(f"""
== slide_force | setActuatorType FORCE, setCommand | {_driven("FORCE")}
== slide_force:setForce | Joint.setForce | {_FREE}{_AT}j.setForce(0, v[0])\n{_STEP}
== slide_force:setCommands | Skeleton.setCommands | {_FREE}{_AT}s.setCommands(v[:1])\n{_STEP}
== slide_force:DegreeOfFreedom | DegreeOfFreedom.setCommand | {_FREE}{_AT}s.getDof(0).setCommand(v[0])\n{_STEP}
== slide_force:clone | World.clone
{_FREE}{_AT}world = world.clone()
j = world.getSkeleton(0).getJoint(0)
{_COMMAND}{_STEP}
== slide_force_bounded | setForceUpperLimit | {_driven("FORCE", _bound("Force", FORCE))}
== slide_passive | setActuatorType PASSIVE | {_driven("PASSIVE", command="")}
== slide_velocity | setActuatorType VELOCITY | {_driven("VELOCITY")}
== slide_velocity_bounded | setActuatorType VELOCITY, setVelocityUpperLimit
{_driven("VELOCITY", _bound("Velocity", SPEED))}
== slide_acceleration | setActuatorType ACCELERATION | {_driven("ACCELERATION")}
== slide_acceleration_bounded | setActuatorType ACCELERATION, setAccelerationUpperLimit
{_driven("ACCELERATION", _bound("Acceleration", ACCELERATION))}
== slide_locked | setActuatorType LOCKED | {_driven("LOCKED", command="")}
== slide_servo ~ {_MIXED} | setActuatorType SERVO, step | {_driven("SERVO", _bound("Force", 1000000000.0))}
== slide_servo_bounded ~ {_MIXED} | setActuatorType SERVO, setForceUpperLimit, step
{_driven("SERVO", _bound("Force", FORCE))}
== slide_friction ~ {_MIXED} | setCoulombFriction | {_FREE}j.setCoulombFriction(0, {FRICTION})\n{_AT}{_STEP}
== slide_at_limit ~ {_MIXED} | setLimitEnforcement
{_FREE}{_ON_LIMIT}j.setPosition(0, {LIMIT})
j.setVelocity(0, abs(a[0]))
{_STEP}
== slide_from_limit ~ {_MIXED} | setLimitEnforcement
{_FREE}{_ON_LIMIT}j.setPosition(0, {LIMIT})
j.setVelocity(0, -abs(a[0]))
{_STEP}
== slide_held_at_limit ~ {_MIXED} | setLimitEnforcement, under a force
{_SLIDE.replace("PULL", "9.0")}{_ON_LIMIT}j.setPosition(0, {LIMIT})
j.setForce(0, abs(v[0]))
{_STEP}
== slide_servo_from_limit ~ {_MIXED} | setCommand of a SERVO at a limit, step
{_SLIDE.replace("PULL", "9.0")}j.setActuatorType(dart.dynamics.ActuatorType.SERVO)
{_bound("Force", 1000000000.0)}{_ON_LIMIT}j.setPosition(0, {LIMIT})
for _ in range(8): j.setCommand(0, 1.0); world.step()
j.setCommand(0, -abs(v[0]) - 1)
{_STEP}
""")

_SLIDES = f"""s, slides, bodies = dart.dynamics.Skeleton('s'), [], []
s.setGravity(np.array({list(GRAVITY)}))
for mass, axis, parent in zip({list(MASSES)}, np.eye(3), (None, 0, None)):
    j, b = s.createPrismaticJointAndBodyNodePair(None if parent is None else bodies[parent])
    j.setAxis(axis)
    b.setInertia(dart.dynamics.Inertia(mass, np.zeros(3), np.eye(3)))
    slides.append(j); bodies.append(b)
"""
_READ = "value = [j.getPosition(0) for j in slides]"
_STATE = "for j, x, u in zip(slides, v, a): j.setPosition(0, x); j.setVelocity(0, u)\n"
_SPEEDS = "value = [j.getVelocity(0) for j in slides]"
_FORWARD = "s.setTimeStep(0.0)\ns.computeForwardDynamics()\nvalue = [j.getAcceleration(0) for j in slides]"
_X = "x = np.abs(v) + 0.5\n"
_BACK = "value = [s.getDof(k).getPosition() for k in range(3)]"
WAYS |= ways_of(f"""
== coordinates_set | Joint.setPosition | {_SLIDES}{_STATE}value = s.getPositions()
== coordinates_set:resetPositions | setInitialPosition, resetPositions
{_SLIDES}for j, x in zip(slides, v): j.setInitialPosition(0, x)
s.resetPositions()
{_READ}
== coordinates_set:DegreeOfFreedom | DegreeOfFreedom.setInitialPosition, resetPosition
{_SLIDES}for k in range(3): s.getDof(k).setInitialPosition(v[k]); s.getDof(k).resetPosition()
{_BACK}
== coordinates_set:some | Skeleton.setPositions of some | {_SLIDES}s.setPositions([2, 0, 1], v[[2, 0, 1]])\n{_READ}
== coordinates_set:clone | Skeleton.clone | {_SLIDES}{_STATE}value = s.clone().getPositions()
== speeds_set | Joint.setVelocity | {_SLIDES}{_STATE}value = s.getVelocities()
== speeds_set:resetVelocities | setInitialVelocity, resetVelocities
{_SLIDES}for j, x in zip(slides, a): j.setInitialVelocity(0, x)
s.resetVelocities()
{_SPEEDS}
== speeds_set:integrateVelocities | integrateVelocities
{_SLIDES}s.setAccelerations(4 * a)
s.integrateVelocities(0.25)
{_SPEEDS}
== accelerations_forced | Skeleton.setForces | {_SLIDES}s.setForces(tau)\n{_FORWARD}
== accelerations_forced:setCommands | Skeleton.setCommands | {_SLIDES}s.setCommands(tau)\n{_FORWARD}
== accelerations_forced:DegreeOfFreedom | DegreeOfFreedom.setForce
{_SLIDES}for k in range(3): s.getDof(k).setForce(tau[k])
{_FORWARD}
== accelerations_forced:addExtForce | addExtForce
{_SLIDES}for b, f in zip(bodies, tau[:, None] * np.eye(3)): b.addExtForce(f)
{_FORWARD}
== masses_set | BodyNode.setMass | {_X}{_SLIDES}for b, y in zip(bodies, x): b.setMass(y)\nvalue = s.getMassMatrix()
""") | {
    **{
        f"limits_set{way}": Way(
            name,
            f"{_X}{_SLIDES}kinds = ('Position', 'Velocity', 'Acceleration')\n"
            "names = [of + end for of in kinds for end in ('Lower', 'Upper')]\n"
            "for name, k in zip(names, (-1, 2, -3, 4, -5, 6)):\n"
            f"    {setting}\nvalue = [getattr(s, f'get{{name}}Limits')() for name in names]",
        )
        for way, name, setting in (
            (
                "",
                "Joint.setPositionLowerLimit, setVelocityUpperLimit",
                "for j, y in zip(slides, x): getattr(j, f'set{name}Limit')(0, k * y)",
            ),
            (
                ":DegreeOfFreedom",
                "DegreeOfFreedom.setPositionLowerLimit, setVelocityUpperLimit",
                "for i, y in enumerate(x): getattr(s.getDof(i), f'set{name}Limit')(k * y)",
            ),
            (
                ":Skeleton",
                "Skeleton.setPositionLowerLimits, setVelocityUpperLimits",
                "getattr(s, f'set{name}Limits')(k * x)",
            ),
        )
    },
    "impulsive_speeds": Way(
        "setJointConstraintImpulses, computeImpulseForwardDynamics",
        f"{_SLIDES}{_STATE}s.setJointConstraintImpulses(tau)\ns.computeImpulseForwardDynamics()\n{_SPEEDS}",
    ),
    "impulsive_speeds:addConstraintImpulse": Way(
        "BodyNode.addConstraintImpulse, computeImpulseForwardDynamics",
        f"{_SLIDES}{_STATE}for b, f in zip(bodies, tau[:, "
        "None] * np.eye(3)): b.addConstraintImpulse(np.r_[0, 0, 0, f])\n"
        f"s.computeImpulseForwardDynamics()\n{_SPEEDS}",
    ),
}

_R = "R, Q = (dart.math.Quaternion(*x).to_rotation_matrix() for x in (q, q2))\n"
_XY = f"{_R}X, Y = dart.math.Isometry3(R, a), dart.math.Isometry3(Q, tau)\n"
_FLAT = "\nvalue = [*Z.translation(), *Z.rotation().flat]"
_WORLD = "W = dart.dynamics.Frame.World()\n"
_ONE = f"{_XY}{_WORLD}one = dart.dynamics.SimpleFrame(W, 'one', X)\n"
_TWO = f"{_ONE}two = dart.dynamics.SimpleFrame(one, 'two', Y)\n"
_LOOSE = "s = dart.dynamics.Skeleton('s')\nj, b = s.createFreeJointAndBodyNodePair(None)\n"
_MOVING = (
    f"{_WORLD}f = tau / (1 + np.abs(tau))\none = dart.dynamics.SimpleFrame(W, 'one')\n"
    "two = dart.dynamics.SimpleFrame(one, 'two', dart.math.Isometry3(np.eye(3), f))\n"
)
_LISTED = "I = dart.dynamics.Inertia()\n"
_TENSOR = "value = np.roll(I.getSpatialTensor(), (3, 3), (0, 1))"
_J = f"J = np.array({[*map(list, MOMENTS)]})\n"
WAYS |= ways_of(f"""
== pose_composed:SimpleFrame | SimpleFrame, of frames in frames | {_TWO}Z = two.getTransform(){_FLAT}
== pose_composed:setRelativeTransform | SimpleFrame.setRelativeTransform
{_ONE}two = dart.dynamics.SimpleFrame(one, 'two')
two.setRelativeTransform(Y)
Z = two.getTransform(){_FLAT}
== pose_composed:setTransform | SimpleFrame.setTransform of another frame
{_ONE}two = dart.dynamics.SimpleFrame(W, 'two')
two.setTransform(Y, one)
Z = two.getTransform(){_FLAT}
== pose_composed:spawnChildSimpleFrame | spawnChildSimpleFrame
{_ONE}two = one.spawnChildSimpleFrame('two', Y)
Z = two.getTransform(){_FLAT}
== pose_composed:FreeJoint | FreeJoint.setTransform of a frame
{_ONE}{_LOOSE}j.setTransform(Y, one)
Z = b.getTransform(){_FLAT}
== pose_composed:joint frames | setTransformFromParentBodyNode, setTransformFromChildBodyNode
{_XY}s = dart.dynamics.Skeleton('s')
j, b = s.createWeldJointAndBodyNodePair(None)
j.setTransformFromParentBodyNode(X)
j.setTransformFromChildBodyNode(Y.inverse())
Z = b.getTransform(){_FLAT}
== pose_relative:SimpleFrame | getTransform, withRespectTo
{_ONE}two = dart.dynamics.SimpleFrame(W, 'two', Y)
Z = two.getTransform(one){_FLAT}
== pose_relative:setTransform | SimpleFrame.getRelativeTransform
{_ONE}two = dart.dynamics.SimpleFrame(one, 'two')
two.setTransform(Y)
Z = two.getRelativeTransform(){_FLAT}
== pose_inverse:FreeJoint | FreeJoint.convertToPositions, convertToTransform
{_XY}of = dart.dynamics.FreeJoint
Z = of.convertToTransform(of.convertToPositions(X)).inverse(){_FLAT}
== pose_inverse:setTransformOf | FreeJoint.setTransformOf
{_XY}{_LOOSE}dart.dynamics.FreeJoint.setTransformOf(b, X)
Z = b.getTransform().inverse(){_FLAT}
== rotation_matrix:BallJoint | BallJoint.convertToPositions, convertToRotation
{_R}value = dart.dynamics.BallJoint.convertToRotation(dart.dynamics.BallJoint.convertToPositions(R)).ravel()
== velocity_composed | SimpleFrame.setClassicDerivatives, getLinearVelocity
{_MOVING}one.setClassicDerivatives(v, a)
two.setClassicDerivatives(v2, tau)
value = [*two.getLinearVelocity(), *two.getAngularVelocity()]
== velocity_composed:setRelativeSpatialVelocity | SimpleFrame.setRelativeSpatialVelocity
{_MOVING}one.setRelativeSpatialVelocity(np.r_[a, v])
two.setRelativeSpatialVelocity(np.r_[tau, v2])
value = np.roll(two.getSpatialVelocity(), 3)
== velocity_composed:FreeJoint | FreeJoint.setSpatialVelocity relative to a frame
{_MOVING}{_LOOSE}j.setTransform(dart.math.Isometry3(np.eye(3), f))
one.setClassicDerivatives(v, a)
j.setSpatialVelocity(np.r_[tau, v2], one, one)
value = [*b.getLinearVelocity(), *b.getAngularVelocity()]
== velocity_composed:FreeJoint in parts | FreeJoint.setLinearVelocity, setAngularVelocity relative to a frame
{_MOVING}{_LOOSE}j.setTransform(dart.math.Isometry3(np.eye(3), f))
one.setClassicDerivatives(v, a)
j.setLinearVelocity(v2, one, one)
j.setAngularVelocity(tau, one, one)
value = [*b.getLinearVelocity(), *b.getAngularVelocity()]
== acceleration_composed | SimpleFrame.setClassicDerivatives, getLinearAcceleration
{_MOVING}one.setClassicDerivatives(np.zeros(3), a, v2, tau)
two.setClassicDerivatives(v2, tau, v, a)
value = [*two.getLinearAcceleration(), *two.getAngularAcceleration()]
== spatial_inertia:setMoment | Inertia.setMass, setLocalCOM, setMoment
{_LISTED}{_J}I.setMass({OF_BODY}); I.setLocalCOM({list(CENTRE)}); I.setMoment(J)
{_TENSOR}
== spatial_inertia:setSpatialTensor | Inertia.setSpatialTensor
{_J}K = dart.dynamics.Inertia({OF_BODY}, {list(CENTRE)}, J)
{_LISTED}I.setSpatialTensor(K.getSpatialTensor())
I = dart.dynamics.Inertia(I.getMass(), I.getLocalCOM(), I.getMoment())
{_TENSOR}
== spatial_inertia:BodyNode | BodyNode.setMass, setLocalCOM, setMomentOfInertia
{_LOOSE}{_J}b.setMass({OF_BODY}); b.setLocalCOM(np.array({list(CENTRE)}))
b.setMomentOfInertia(J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2])
I = b.getInertia()
{_TENSOR}
""")
