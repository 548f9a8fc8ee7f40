"""The functions of a diagram's blocks on memory that they share."""

from __future__ import annotations

import numpy as np

import symofros as sf
from symofros import blocks
from symofros.diagrams.run.block_functions import Blocks
from symofros.runtime.build.toolchain import find_toolchain


def test_compiled_functions_keep_their_arguments_alive() -> None:
    """C has addresses only: Baumgarte's gains were let go of, and read from what took their place."""
    swing = sf.RigidBody("bob", sf.Joint("slide", "planar"), sf.Inertia(1.0, moments=(1, 1, 1)))
    rod = sf.Rod("rod", ("world", None), ("bob", None), 1.0)
    diagram = sf.Diagram("pendulum")
    diagram.add_model("plant", sf.System("pendulum", (swing,), constraints=(rod,)), start={"slide.x": 1.01})
    diagram.add(blocks.ForwardDynamics(name="swing", model="plant"))
    resolved = sf.Simulation(diagram).resolved
    made = Blocks(resolved, np.array(resolved.layout.par), (20.0, 10.0), find_toolchain())
    taken = [np.full(size, 1e300) for size in range(1, 9) for _ in range(200)]
    made.signals()
    made.accelerate()
    assert np.all(np.abs(made.a) < 1e3) and len(taken) == 1600
