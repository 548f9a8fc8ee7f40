"""Which joint of which mechanism of a diagram left its limits."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import ForwardDynamics
from symofros.diagrams.run.examination.joint_limits import joint_limit_notes


@pytest.mark.parametrize("block", ["left", "right"])
@pytest.mark.parametrize(("kind", "word"), [("q", "leaves"), ("v", "speed")])
def test_the_joint_is_the_one_that_left(block: str, kind: str, word: str) -> None:
    """The last of three in one of two mechanisms; the ball before it has more coordinates than speeds."""
    bodies = (
        sf.RigidBody("a", sf.Joint("ball", "ball"), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1))),
        sf.RigidBody("b", sf.Joint("x", "prismatic", "a", axis=(1, 0, 0)), sf.Inertia(1.0)),
        sf.RigidBody(
            "c", sf.Joint("y", "prismatic", "b", axis=(0, 1, 0), limits=sf.Limits(-0.1, 0.1, 2.0)), sf.Inertia(1.0)
        ),
    )
    diagram = sf.Diagram("pair")
    diagram.add_model("plant", sf.System("plant", bodies))
    for name in ("left", "right"):
        diagram.add(ForwardDynamics(name=name, model="plant"))
    resolved = sf.Simulation(diagram).resolved
    layout = resolved.layout
    values = {"q": np.zeros((2, len(layout.q_names))), "v": np.zeros((2, len(layout.v_names)))}
    places = getattr(layout, kind)[block]
    values[kind][1, places.start + (5 if kind == "q" else 4)] = 3.0
    (note,) = joint_limit_notes(resolved, np.array([0.0, 1.0]), values["q"], values["v"])
    assert word in note and f"'{block}.y'" in note
