"""Mechanisms with prescribed motions, which are signals in a diagram, bear the notes that a single run bears."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from symofros import blocks
from symofros.simulation.analysis.kinematics.postures import NEAR
from tests.diagrams.parts import moving

WAYS = pytest.mark.parametrize("way", ["run", "interpret"])


@WAYS
@pytest.mark.parametrize(("load", "creeps"), [(0.5, True), (3.0, False)])
def test_creeping_joints_beside_prescribed_ones_are_noted(load: float, creeps: bool, way: str) -> None:
    lift = sf.RigidBody("lift", sf.Joint("z", "prismatic", axis=(0, 0, 1), prescribed=True), sf.Inertia(1.0))
    rubs = sf.Friction(1.0, minimum_velocity=1e-2)
    block = sf.Joint("y", "prismatic", "lift", axis=(0, 1, 0), elements=(rubs,))
    system = sf.System("rubbing", (lift, sf.RigidBody("block", block, sf.Inertia(1.0))), gravity=(0, -load, 0))
    of = moving(system, u="at")
    of.add(blocks.Constant(name="at", value=[0.0, 0.0, 0.0]))
    notes = getattr(sf.Simulation(of), way)(0.5, method="rk4", dt=1e-3).outcome.notes
    assert ["so that the joint creeps" in note for note in notes] == [True] * creeps, notes


@WAYS
@pytest.mark.parametrize("rod", [1.0, 0.3 / np.sqrt(1.0 - (NEAR / 2.0) ** 2)])
def test_singular_postures_reached_by_prescribed_joints_are_noted(rod: float, way: str) -> None:
    """A crank of 0.3 m turns past the upright, where det G = rod cos(its angle) is least."""
    a, rate = 0.3, 2.0
    turn = sf.Joint("q1", "revolute", axis=(0, -1, 0), prescribed=True)
    link = sf.Joint("q2", "revolute", "crank", "e", axis=(0, -1, 0))
    bodies = (
        sf.RigidBody("crank", turn, sf.Inertia(1, (a / 2, 0, 0), (0, 0.01, 0.01)), (sf.Frame("e", (a, 0, 0)),)),
        sf.RigidBody("rod", link, sf.Inertia(1, (rod / 2, 0, 0), (0, 0.08, 0.08)), (sf.Frame("e", (rod, 0, 0)),)),
        sf.RigidBody("slide", sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Inertia(2, (0, 0, 0), (1, 1, 1))),
    )
    pin = sf.Closure("pin", ("slide", None), ("rod", "e"), ("x", "z"))
    of = moving(sf.System("crank_slider", bodies, constraints=(pin,)), {"q2": 0.0, "x": a + rod}, u="at")
    of.add(blocks.Formula(name="at", formulas=[f"{rate}*t", f"{rate}", "0*t"]))
    outcome = getattr(sf.Simulation(of), way)(0.9, method="rk4", dt=1e-3).outcome
    assert outcome.ok, outcome
    assert any("singular posture" in note for note in outcome.notes) == (rod < 1.0), outcome.notes
