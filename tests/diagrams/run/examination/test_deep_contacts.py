"""Contacts beyond their geometry: said where an event made them soft, or a prescribed motion brought them there."""

from __future__ import annotations

from typing import Any

import pytest

import symofros as sf
from symofros import blocks
from tests.diagrams.parts import moving
from tests.simulation.mechanisms import slide

DEEP = "times its radius deep"


def floor(body: str, stiffness: Any) -> sf.Contact:
    return sf.Contact("floor", (body, None), ("world", None), stiffness, radius=0.05, dissipation=2.0)


@pytest.mark.parametrize(("later", "deep"), [(1.0, True), (2e4, False)])
def test_contacts_have_the_parameters_that_events_left(later: float, deep: bool) -> None:
    ball = slide(axis=(0, 0, 1), connections=(floor("body", "k"),), parameters=(sf.Parameter("k", 1e4),))
    of = sf.Diagram("softened")
    of.add_model("m", ball, start={"x": 0.2, "dx": -1.0})
    event = sf.Event("t - 0.05", "rising", action={"k": later})
    of.add(blocks.ForwardDynamics(name="plant", model="m", events={"softens": event}))
    notes = sf.Simulation(of).run(0.5, method="rk4", dt=1e-3).outcome.notes
    assert any(DEEP in note for note in notes) == deep, notes


@pytest.mark.parametrize("way", ["run", "interpret"])
@pytest.mark.parametrize(("height", "deep"), [(0.2, False), (-0.3, True)])
def test_contacts_are_where_a_prescribed_motion_brings_them(height: float, deep: bool, way: str) -> None:
    lift = sf.RigidBody("lift", sf.Joint("z", "prismatic", axis=(0, 0, 1), prescribed=True), sf.Inertia(1.0))
    ball = sf.RigidBody("ball", sf.Joint("y", "prismatic", "lift", axis=(0, 1, 0)), sf.Inertia(1.0))
    of = moving(sf.System("lowered", (lift, ball), connections=(floor("ball", 1e4),)), {"dy": 0.1}, u="at")
    of.add(blocks.Constant(name="at", value=[height, 0.0, 0.0]))
    notes = getattr(sf.Simulation(of), way)(0.02, method="rk4", dt=1e-3).outcome.notes
    assert [DEEP in note for note in notes] == [True] * deep, notes
