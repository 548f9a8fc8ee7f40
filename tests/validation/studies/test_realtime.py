"""Diagrams in real time, briefly: the robot follows its path, and the report says what was measured."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from validation.studies import realtime


@pytest.mark.parametrize("python", [False, True])
def test_the_robot_follows_its_path(python: bool) -> None:
    run = sf.Simulation(realtime.robot(1e-3, python=python)).run(1.5, dt=1e-3, record=1e-2)
    path = realtime.SWING * np.sin(realtime.RATE * run.t)[:, np.newaxis]
    assert np.abs(run["plant.q"] - path)[run.t > 0.5].max() < 0.01
    if python:
        # What is received at a sample was sent at the one before, so nobody takes the last packet.
        assert run.kept["tx"]["sent"] == 1501 and run.kept["rx"]["received"] == 1500
        assert run.kept["log"]["q"].shape == (1501, 6)
