"""Bodies of balls that touch the ground, as PyBullet moves them: steps of velocities, with restitution."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from ...mechanics.touching_body import GRAVITY, Pose, TouchingBody

INSTALLED = find_spec("pybullet") is not None
MISSING = "PyBullet is not installed: pip install 'symofros[engine-pybullet]'"


def moved(body: TouchingBody, h: float) -> Pose:
    """Pose of a body of balls at the end, by steps of h; all that leaks or smooths is off."""
    bullet: Any = import_module("pybullet")  # An extra.
    world = bullet.connect(bullet.DIRECT)
    try:
        at = {"physicsClientId": world}
        bullet.setGravity(0.0, 0.0, -GRAVITY, **at)
        exact = {"numSolverIterations": 1000, "solverResidualThreshold": 0.0, "contactSlop": 0.0}
        cones = {"restitutionVelocityThreshold": 0.0, "enableConeFriction": 1, "numSubSteps": 0}
        bullet.setPhysicsEngineParameter(fixedTimeStep=h, **exact, **cones, **at)
        ground = bullet.createMultiBody(0, bullet.createCollisionShape(bullet.GEOM_PLANE, **at), **at)
        balls = len(body.points)
        sizes = {"radii": [body.radius] * balls, "collisionFramePositions": [list(point) for point in body.points]}
        shape = bullet.createCollisionShapeArray([bullet.GEOM_SPHERE] * balls, **sizes, **at)
        number = bullet.createMultiBody(body.mass, shape, basePosition=body.p, baseOrientation=body.xyzw, **at)
        # Coefficients of the two bodies are multiplied.
        no_other = {"rollingFriction": 0.0, "spinningFriction": 0.0, "linearDamping": 0.0, "angularDamping": 0.0}
        law = {"lateralFriction": body.friction, "restitution": body.restitution, "localInertiaDiagonal": body.moments}
        bullet.changeDynamics(ground, -1, lateralFriction=1.0, restitution=1.0, **no_other, **at)
        bullet.changeDynamics(number, -1, **law, **no_other, **at)
        bullet.resetBaseVelocity(number, body.v, body.w, **at)
        for _ in range(round(body.end / h)):
            bullet.stepSimulation(**at)
        p, xyzw = bullet.getBasePositionAndOrientation(number, **at)
    finally:
        bullet.disconnect(world)
    return Pose(np.array(p), np.asarray(Rotation.from_quat(xyzw).as_matrix()))
