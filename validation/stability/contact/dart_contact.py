"""Bodies of balls that touch the ground, as DART moves them: by steps of velocities, with restitution."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np

from ...mechanics.touching_body import GRAVITY, Pose, TouchingBody

INSTALLED = find_spec("dartpy") is not None
MISSING = "DART is not installed: pip install 'symofros[engine-dart]'"
# Edges of the block whose top is the ground [m].
_BLOCK = (100.0, 100.0, 2.0)


def moved(body: TouchingBody, h: float) -> Pose:
    """Pose of a body of balls at the end, by steps of h."""
    dart: Any = import_module("dartpy")  # An extra.
    world = dart.simulation.World("touching")
    world.setTimeStep(h)
    world.setGravity([0.0, 0.0, -GRAVITY])
    world.getConstraintSolver().setCollisionDetector(dart.collision.DARTCollisionDetector())
    block, solid = dart.dynamics.Skeleton("ground"), dart.dynamics.Skeleton("body")
    _, ground = block.createWeldJointAndBodyNodePair()
    joint, moves = solid.createFreeJointAndBodyNodePair()
    inertia = dart.dynamics.Inertia()
    inertia.setMass(body.mass)
    inertia.setMoment(np.diag(body.moments))
    moves.setInertia(inertia)
    # Of two coefficients of friction the lesser holds; those of restitution are multiplied.
    _touches(dart, ground, dart.dynamics.BoxShape(_BLOCK), (0.0, 0.0, -_BLOCK[2] / 2), body.friction, 1.0)
    for point in body.points:
        _touches(dart, moves, dart.dynamics.SphereShape(body.radius), point, body.friction, body.restitution)
    for skeleton in (block, solid):
        world.addSkeleton(skeleton)
    pose = dart.math.Isometry3()
    pose.set_rotation(body.R)
    pose.set_translation(body.p)
    joint.setTransform(pose)
    joint.setLinearVelocity(body.v)
    joint.setAngularVelocity(body.w)
    for _ in range(round(body.end / h)):
        world.step()
    end = moves.getWorldTransform()
    return Pose(np.array(end.translation()), np.array(end.rotation()))


def _touches(
    dart: Any, body: Any, shape: Any, place: tuple[float, float, float], friction: float, restitution: float
) -> None:
    node = body.createShapeNode(shape)
    pose = dart.math.Isometry3()
    pose.set_translation(list(place))
    node.setRelativeTransform(pose)
    node.createCollisionAspect()
    node.createDynamicsAspect()
    law = node.getDynamicsAspect()
    law.setFrictionCoeff(friction)
    law.setRestitutionCoeff(restitution)
