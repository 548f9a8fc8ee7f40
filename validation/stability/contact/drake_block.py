"""The block on an incline as Drake holds it, by its discrete contact at a point."""

from __future__ import annotations

import logging
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np

INSTALLED = find_spec("pydrake") is not None
MISSING = "Drake is not installed: pip install 'symofros[engine-drake]'"
# Mass of the slider between the two joints [kg]: Drake asks for some.
_SLIDER = 1e-12
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
    geometry, poses, plants, tree, analysis, framework = map(import_module, _MODULES)  # Drake is an extra.
    logging.getLogger("drake").setLevel(logging.ERROR)  # Half-spaces and bodies that deform: there are none.
    builder: Any = framework.DiagramBuilder()
    plant, _ = plants.AddMultibodyPlantSceneGraph(builder, h)
    plant.set_discrete_contact_approximation(getattr(plants.DiscreteContactApproximation, approximation))
    plant.mutable_gravity_field().set_gravity_vector([gravity[0], 0.0, gravity[1]])
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
