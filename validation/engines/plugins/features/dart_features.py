"""DART's actuators, dry friction and limits, what joints and skeletons are given, free joints, frames and inertias."""

from __future__ import annotations

from ...interface import STEP
from ...truth.features.drives import ACCELERATION, FORCE, FRICTION, LIMIT, MASS, SPEED
from ...truth.features.parameters import GRAVITY, MASSES
from ...truth.geometry.poses import CENTRE, MOMENTS
from ...truth.geometry.poses import MASS as OF_BODY
from ..writing.source import Way

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


WAYS = {
    "slide_force": Way("setActuatorType FORCE, setCommand", _driven("FORCE")),
    "slide_force:setForce": Way("Joint.setForce", f"{_FREE}{_AT}j.setForce(0, v[0])\n{_STEP}"),
    "slide_force:setCommands": Way("Skeleton.setCommands", f"{_FREE}{_AT}s.setCommands(v[:1])\n{_STEP}"),
    "slide_force:DegreeOfFreedom": Way(
        "DegreeOfFreedom.setCommand", f"{_FREE}{_AT}s.getDof(0).setCommand(v[0])\n{_STEP}"
    ),
    "slide_force:clone": Way(
        "World.clone",
        f"{_FREE}{_AT}world = world.clone()\nj = world.getSkeleton(0).getJoint(0)\n{_COMMAND}{_STEP}",
    ),
    "slide_force_bounded": Way("setForceUpperLimit", _driven("FORCE", _bound("Force", FORCE))),
    "slide_passive": Way("setActuatorType PASSIVE", _driven("PASSIVE", command="")),
    "slide_velocity": Way("setActuatorType VELOCITY", _driven("VELOCITY")),
    "slide_velocity_bounded": Way(
        "setActuatorType VELOCITY, setVelocityUpperLimit", _driven("VELOCITY", _bound("Velocity", SPEED))
    ),
    "slide_acceleration": Way("setActuatorType ACCELERATION", _driven("ACCELERATION")),
    "slide_acceleration_bounded": Way(
        "setActuatorType ACCELERATION, setAccelerationUpperLimit",
        _driven("ACCELERATION", _bound("Acceleration", ACCELERATION)),
    ),
    "slide_locked": Way("setActuatorType LOCKED", _driven("LOCKED", command="")),
    "slide_servo": Way("setActuatorType SERVO, step", _driven("SERVO", _bound("Force", 1e9)), _MIXED),
    "slide_servo_bounded": Way(
        "setActuatorType SERVO, setForceUpperLimit, step", _driven("SERVO", _bound("Force", FORCE)), _MIXED
    ),
    "slide_friction": Way("setCoulombFriction", f"{_FREE}j.setCoulombFriction(0, {FRICTION})\n{_AT}{_STEP}", _MIXED),
    "slide_at_limit": Way(
        "setLimitEnforcement",
        f"{_FREE}{_ON_LIMIT}j.setPosition(0, {LIMIT})\nj.setVelocity(0, abs(a[0]))\n{_STEP}",
        _MIXED,
    ),
    "slide_from_limit": Way(
        "setLimitEnforcement",
        f"{_FREE}{_ON_LIMIT}j.setPosition(0, {LIMIT})\nj.setVelocity(0, -abs(a[0]))\n{_STEP}",
        _MIXED,
    ),
    "slide_held_at_limit": Way(
        "setLimitEnforcement, under a force",
        f"{_SLIDE.replace('PULL', '9.0')}{_ON_LIMIT}j.setPosition(0, {LIMIT})\nj.setForce(0, abs(v[0]))\n{_STEP}",
        _MIXED,
    ),
    "slide_servo_from_limit": Way(
        "setCommand of a SERVO at a limit, step",
        f"{_SLIDE.replace('PULL', '9.0')}j.setActuatorType(dart.dynamics.ActuatorType.SERVO)\n{_bound('Force', 1e9)}"
        f"{_ON_LIMIT}j.setPosition(0, {LIMIT})\nfor _ in range(8): j.setCommand(0, 1.0); world.step()\n"
        f"j.setCommand(0, -abs(v[0]) - 1)\n{_STEP}",
        _MIXED,
    ),
}

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
WAYS |= {
    "coordinates_set": Way("Joint.setPosition", f"{_SLIDES}{_STATE}value = s.getPositions()"),
    "coordinates_set:resetPositions": Way(
        "setInitialPosition, resetPositions",
        f"{_SLIDES}for j, x in zip(slides, v): j.setInitialPosition(0, x)\ns.resetPositions()\n{_READ}",
    ),
    "coordinates_set:DegreeOfFreedom": Way(
        "DegreeOfFreedom.setInitialPosition, resetPosition",
        f"{_SLIDES}for k in range(3): s.getDof(k).setInitialPosition(v[k]); s.getDof(k).resetPosition()\n{_BACK}",
    ),
    "coordinates_set:some": Way(
        "Skeleton.setPositions of some", f"{_SLIDES}s.setPositions([2, 0, 1], v[[2, 0, 1]])\n{_READ}"
    ),
    "coordinates_set:clone": Way("Skeleton.clone", f"{_SLIDES}{_STATE}value = s.clone().getPositions()"),
    "speeds_set": Way("Joint.setVelocity", f"{_SLIDES}{_STATE}value = s.getVelocities()"),
    "speeds_set:resetVelocities": Way(
        "setInitialVelocity, resetVelocities",
        f"{_SLIDES}for j, x in zip(slides, a): j.setInitialVelocity(0, x)\ns.resetVelocities()\n{_SPEEDS}",
    ),
    "speeds_set:integrateVelocities": Way(
        "integrateVelocities", f"{_SLIDES}s.setAccelerations(4 * a)\ns.integrateVelocities(0.25)\n{_SPEEDS}"
    ),
    "accelerations_forced": Way("Skeleton.setForces", f"{_SLIDES}s.setForces(tau)\n{_FORWARD}"),
    "accelerations_forced:setCommands": Way("Skeleton.setCommands", f"{_SLIDES}s.setCommands(tau)\n{_FORWARD}"),
    "accelerations_forced:DegreeOfFreedom": Way(
        "DegreeOfFreedom.setForce", f"{_SLIDES}for k in range(3): s.getDof(k).setForce(tau[k])\n{_FORWARD}"
    ),
    "accelerations_forced:addExtForce": Way(
        "addExtForce",
        f"{_SLIDES}for b, f in zip(bodies, tau[:, None] * np.eye(3)): b.addExtForce(f)\n{_FORWARD}",
    ),
    "masses_set": Way(
        "BodyNode.setMass", f"{_X}{_SLIDES}for b, y in zip(bodies, x): b.setMass(y)\nvalue = s.getMassMatrix()"
    ),
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
WAYS |= {
    "pose_composed:SimpleFrame": Way("SimpleFrame, of frames in frames", f"{_TWO}Z = two.getTransform(){_FLAT}"),
    "pose_composed:setRelativeTransform": Way(
        "SimpleFrame.setRelativeTransform",
        f"{_ONE}two = dart.dynamics.SimpleFrame(one, 'two')\n"
        f"two.setRelativeTransform(Y)\nZ = two.getTransform(){_FLAT}",
    ),
    "pose_composed:setTransform": Way(
        "SimpleFrame.setTransform of another frame",
        f"{_ONE}two = dart.dynamics.SimpleFrame(W, 'two')\ntwo.setTransform(Y, one)\nZ = two.getTransform(){_FLAT}",
    ),
    "pose_composed:spawnChildSimpleFrame": Way(
        "spawnChildSimpleFrame", f"{_ONE}two = one.spawnChildSimpleFrame('two', Y)\nZ = two.getTransform(){_FLAT}"
    ),
    "pose_composed:FreeJoint": Way(
        "FreeJoint.setTransform of a frame", f"{_ONE}{_LOOSE}j.setTransform(Y, one)\nZ = b.getTransform(){_FLAT}"
    ),
    "pose_composed:joint frames": Way(
        "setTransformFromParentBodyNode, setTransformFromChildBodyNode",
        f"{_XY}s = dart.dynamics.Skeleton('s')\nj, b = s.createWeldJointAndBodyNodePair(None)\n"
        "j.setTransformFromParentBodyNode(X)\n"
        f"j.setTransformFromChildBodyNode(Y.inverse())\nZ = b.getTransform(){_FLAT}",
    ),
    "pose_relative:SimpleFrame": Way(
        "getTransform, withRespectTo",
        f"{_ONE}two = dart.dynamics.SimpleFrame(W, 'two', Y)\nZ = two.getTransform(one){_FLAT}",
    ),
    "pose_relative:setTransform": Way(
        "SimpleFrame.getRelativeTransform",
        f"{_ONE}two = dart.dynamics.SimpleFrame(one, 'two')\n"
        f"two.setTransform(Y)\nZ = two.getRelativeTransform(){_FLAT}",
    ),
    "pose_inverse:FreeJoint": Way(
        "FreeJoint.convertToPositions, convertToTransform",
        f"{_XY}of = dart.dynamics.FreeJoint\nZ = of.convertToTransform(of.convertToPositions(X)).inverse(){_FLAT}",
    ),
    "pose_inverse:setTransformOf": Way(
        "FreeJoint.setTransformOf",
        f"{_XY}{_LOOSE}dart.dynamics.FreeJoint.setTransformOf(b, X)\nZ = b.getTransform().inverse(){_FLAT}",
    ),
    "rotation_matrix:BallJoint": Way(
        "BallJoint.convertToPositions, convertToRotation",
        f"{_R}value = dart.dynamics.BallJoint.convertToRotation(dart.dynamics.BallJoint.convertToPositions(R)).ravel()",
    ),
    "velocity_composed": Way(
        "SimpleFrame.setClassicDerivatives, getLinearVelocity",
        f"{_MOVING}one.setClassicDerivatives(v, a)\ntwo.setClassicDerivatives(v2, tau)\n"
        "value = [*two.getLinearVelocity(), *two.getAngularVelocity()]",
    ),
    "velocity_composed:setRelativeSpatialVelocity": Way(
        "SimpleFrame.setRelativeSpatialVelocity",
        f"{_MOVING}one.setRelativeSpatialVelocity(np.r_[a, v])\ntwo.setRelativeSpatialVelocity(np.r_[tau, v2])\n"
        "value = np.roll(two.getSpatialVelocity(), 3)",
    ),
    "velocity_composed:FreeJoint": Way(
        "FreeJoint.setSpatialVelocity relative to a frame",
        f"{_MOVING}{_LOOSE}j.setTransform(dart.math.Isometry3(np.eye(3), f))\none.setClassicDerivatives(v, a)\n"
        "j.setSpatialVelocity(np.r_[tau, v2], one, one)\nvalue = [*b.getLinearVelocity(), *b.getAngularVelocity()]",
    ),
    "velocity_composed:FreeJoint in parts": Way(
        "FreeJoint.setLinearVelocity, setAngularVelocity relative to a frame",
        f"{_MOVING}{_LOOSE}j.setTransform(dart.math.Isometry3(np.eye(3), f))\none.setClassicDerivatives(v, a)\n"
        "j.setLinearVelocity(v2, one, one)\nj.setAngularVelocity(tau, one, one)\n"
        "value = [*b.getLinearVelocity(), *b.getAngularVelocity()]",
    ),
    "acceleration_composed": Way(
        "SimpleFrame.setClassicDerivatives, getLinearAcceleration",
        f"{_MOVING}one.setClassicDerivatives(np.zeros(3), a, v2, tau)\ntwo.setClassicDerivatives(v2, tau, v, a)\n"
        "value = [*two.getLinearAcceleration(), *two.getAngularAcceleration()]",
    ),
    "spatial_inertia:setMoment": Way(
        "Inertia.setMass, setLocalCOM, setMoment",
        f"{_LISTED}{_J}I.setMass({OF_BODY}); I.setLocalCOM({list(CENTRE)}); I.setMoment(J)\n{_TENSOR}",
    ),
    "spatial_inertia:setSpatialTensor": Way(
        "Inertia.setSpatialTensor",
        f"{_J}K = dart.dynamics.Inertia({OF_BODY}, {list(CENTRE)}, "
        f"J)\n{_LISTED}I.setSpatialTensor(K.getSpatialTensor())\n"
        "I = dart.dynamics.Inertia(I.getMass(), I.getLocalCOM(), I.getMoment())\n" + _TENSOR,
    ),
    "spatial_inertia:BodyNode": Way(
        "BodyNode.setMass, setLocalCOM, setMomentOfInertia",
        f"{_LOOSE}{_J}b.setMass({OF_BODY}); b.setLocalCOM(np.array({list(CENTRE)}))\n"
        f"b.setMomentOfInertia(J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2])\nI = b.getInertia()\n{_TENSOR}",
    ),
}
