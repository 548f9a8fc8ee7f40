"""Sliders: one a speed, and back to coordinates."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.mechanics.topology.tree import build_tree
from symofros.studio.viewer.playing.coordinate_units import coordinate_units
from symofros.studio.viewer.playing.sliders import coordinates_of, sliders_of, values_of


def model(name: str) -> sf.Model:
    return sf.compile(MODELS[name], sf.Options(backend="interpreter"))


@pytest.mark.parametrize("name", ["joint_zoo", "torque_free_body", "free_boom", "planar_robot"])
def test_there_and_back(name: str, rng: np.random.Generator) -> None:
    m = model(name)
    for _ in range(5):
        q, _ = m.random_state(rng)
        again = coordinates_of(m, values_of(m, q))
        assert np.allclose(m.difference(q, again), 0.0, atol=1e-12)


def test_they_are_named_and_bounded_and_units_are_those_of_coordinates_and_of_turns() -> None:
    m = model("joint_zoo")
    sliders = sliders_of(m, (False,) * m.nq)
    assert tuple(slider.speed for slider in sliders) == m.names.v
    assert all(slider.low < slider.high for slider in sliders) and len({slider.label for slider in sliders}) == m.nv
    m = model("torque_free_body")
    assert [slider.unit for slider in sliders_of(m, (False,) * m.nq)] == ["", "", "", "rad", "rad", "rad"]
    system = MODELS["planar_robot"]
    units = coordinate_units(build_tree(system))
    sliders = sliders_of(model("planar_robot"), (False,) * 10, units)
    assert {slider.unit for slider in sliders if "bend" in slider.label} == {"m"}
    assert {slider.unit for slider in sliders if "bend" not in slider.label} == {"rad"}


def test_a_free_body_moves_along_the_axes_it_stands_in() -> None:
    m = model("torque_free_body")
    labels = [slider.label.rpartition(".")[2] for slider in sliders_of(m, (False,) * m.nq)]
    assert labels == ["px", "py", "pz", "turn_x", "turn_y", "turn_z"]
    q = coordinates_of(m, np.array([1.0, 2.0, 3.0, 0.0, 0.0, np.pi / 2]))
    assert np.allclose(q, [1, 2, 3, 0, 0, np.sqrt(0.5), np.sqrt(0.5)])
