"""Bodies that touch, as Drake moves them, by its contact at a point: discrete, or compliant and continuous."""

from __future__ import annotations

import logging
import math
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np

from ...mechanics.touching_body import GRAVITY, Pose, TouchingBody

INSTALLED = find_spec("pydrake") is not None
MISSING = "Drake is not installed: pip install 'symofros[engine-drake]'"
# Mass of the slider between the two joints [kg]: Drake asks for some.
_SLIDER = 1e-12
# Stiffness of what is rigid [N/m]: discrete steps take as much of it as they can.
_STIFF = 1e12
# Of strikes: the lagged approximation has the friction of the last step's force, so that a strike takes several: its
# stiffness times h^2/m, and its dissipation, whose inverse bounds the speed of a rebound [s/m]. SAP relaxes in steps.
_SOFT, _LOSSY, _RELAXED = 1e-3, 200.0, 4.0
_MODULES = tuple(
    f"pydrake.{name}"
    for name in ("geometry", "math", "multibody.plant", "multibody.tree", "systems.analysis", "systems.framework")
)


def slid(
    approximation: str, friction: float, radius: float, gravity: tuple[float, float], h: float, times: tuple[float, ...]
) -> list[tuple[float, float]]:
    """Place and speed along x at some times [m, m/s], of 1 kg let go from rest on a half-space, which can't turn.

    Args:
        approximation: Name of a DiscreteContactApproximation.
        friction: Coefficient.
        radius: Radius of the sphere that touches [m].
        gravity: Its parts along x and z [m/s^2].
        h: Step [s].
        times: Times, ascending [s].
    """
    geometry, poses, plants, tree, analysis, _ = map(import_module, _MODULES)
    builder, plant = _plant(approximation, (gravity[0], 0.0, gravity[1]), h)
    slider = plant.AddRigidBody("slider", tree.SpatialInertia(_SLIDER, np.zeros(3), tree.UnitInertia(1.0, 1.0, 1.0)))
    block = plant.AddRigidBody("block", tree.SpatialInertia(1.0, np.zeros(3), tree.UnitInertia.SolidSphere(radius)))
    plant.AddJoint(tree.PrismaticJoint("x", plant.world_frame(), slider.body_frame(), [1, 0, 0]))
    plant.AddJoint(tree.PrismaticJoint("z", slider.body_frame(), block.body_frame(), [0, 0, 1]))
    dry, here = plants.CoulombFriction(friction, friction), poses.RigidTransform()
    plant.RegisterCollisionGeometry(plant.world_body(), here, geometry.HalfSpace(), "floor", dry)
    plant.RegisterCollisionGeometry(block, here, geometry.Sphere(radius), "ball", dry)
    plant.Finalize()
    simulator = analysis.Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.SetPositions(context, [0.0, radius])
    simulator.Initialize()
    found = []
    for time in times:
        simulator.AdvanceTo(time)
        found.append((float(plant.GetPositions(context)[0]), float(plant.GetVelocities(context)[0])))
    return found


def moved(approximation: str, body: TouchingBody, h: float) -> Pose:
    """Pose of a body at the end, by steps of h: rigid as stiff as they allow, compliant by fixed steps of RK3."""
    geometry, poses, plants, tree, analysis, _ = map(import_module, _MODULES)
    rigid, soft = not body.stiffness, body.strikes and approximation == "kLagged"
    builder, plant = _plant(approximation, (0.0, 0.0, -GRAVITY), h if rigid else 0.0)
    unit = tree.UnitInertia(*(moment / body.mass for moment in body.moments))
    moves = plant.AddRigidBody("body", tree.SpatialInertia(body.mass, np.zeros(3), unit))
    dry = plants.CoulombFriction(body.friction, body.friction)
    ground, touches = geometry.ProximityProperties(), geometry.ProximityProperties()
    # All of the compliance is the body's, so that forces act on the surface of the ground.
    own = _SOFT * body.mass / h**2 if soft else body.stiffness or _STIFF
    for properties, stiffness in ((ground, _STIFF), (touches, own)):
        geometry.AddContactMaterial(_LOSSY if soft else body.dissipation, stiffness, dry, properties)
        if rigid:
            properties.AddProperty("material", "relaxation_time", _RELAXED * h if body.strikes else 0.0)
    lies = poses.RigidTransform(poses.RotationMatrix.MakeXRotation(math.pi / 2), np.zeros(3))
    here, capsule = poses.RigidTransform(), body.shape == "capsule"
    floor = (lies, geometry.Capsule(*body.log)) if capsule else (here, geometry.HalfSpace())
    plant.RegisterCollisionGeometry(plant.world_body(), *floor, "ground", ground)
    solids = {"capsule": geometry.Capsule, "cylinder": geometry.Cylinder}
    shapes = (
        [(poses.RigidTransform(np.array(point)), geometry.Sphere(body.radius)) for point in body.points]
        if body.shape == "balls"
        else [(here, solids[body.shape](body.radius, 2 * body.half))]
    )
    for number, shape in enumerate(shapes):
        plant.RegisterCollisionGeometry(moves, *shape, f"shape {number}", touches)
    plant.Finalize()
    simulator = analysis.Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.SetFreeBodyPose(context, moves, poses.RigidTransform(poses.RotationMatrix(body.R), np.array(body.p)))
    twist = import_module("pydrake.multibody.math").SpatialVelocity(np.array(body.w), np.array(body.v))
    plant.SetFreeBodySpatialVelocity(context, moves, twist)
    if not rigid:
        analysis.ResetIntegratorFromFlags(simulator, "runge_kutta3", h)
        simulator.get_mutable_integrator().set_fixed_step_mode(True)
    simulator.Initialize()
    simulator.AdvanceTo(body.end)
    pose = plant.EvalBodyPoseInWorld(context, moves)
    return Pose(np.array(pose.translation()), np.array(pose.rotation().matrix()))


def _plant(approximation: str, gravity: tuple[float, float, float], h: float) -> tuple[Any, Any]:
    """A builder and an empty plant of contact at points; of steps of 0 it is continuous."""
    _, _, plants, _, _, framework = map(import_module, _MODULES)  # Drake is an extra.
    logging.getLogger("drake").setLevel(logging.ERROR)  # Half-spaces and bodies that deform: there are none.
    builder: Any = framework.DiagramBuilder()
    plant, _ = plants.AddMultibodyPlantSceneGraph(builder, h)
    if h:
        plant.set_discrete_contact_approximation(getattr(plants.DiscreteContactApproximation, approximation))
    plant.set_contact_model(plants.ContactModel.kPoint)
    plant.mutable_gravity_field().set_gravity_vector(gravity)
    return builder, plant
