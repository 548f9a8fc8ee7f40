"""Figures of a rigid body, and of a beam, as one types it."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from symofros.studio.editor.document.figures.beam_figures import beam_figures
from symofros.studio.editor.document.figures.inertia_figures import inertia_figures
from symofros.studio.editor.editing.data_edits import EditError


def test_a_box_has_the_moments_of_textbooks() -> None:
    solid = {"shape": "box", "density": "rho", "x": 1.0, "y": "L/2", "z": 0.1, "center": ["L", 0, 0]}
    figures = inertia_figures({"solid": solid}, {"rho": 1000.0, "L": 0.4})
    mass = 1000.0 * 1.0 * 0.2 * 0.1
    assert figures["mass"] == pytest.approx(mass) and figures["center_of_mass"] == [0.4, 0.0, 0.0]
    moments = mass / 12 * np.array([0.2**2 + 0.1**2, 1.0 + 0.1**2, 1.0 + 0.2**2])
    np.testing.assert_allclose(figures["moments"], moments, rtol=1e-12)
    np.testing.assert_allclose(figures["products"], 0.0, atol=1e-15)


def test_moments_about_the_body_frame_are_moved_to_the_mass_centre_and_turned_to_the_body_s() -> None:
    stated: dict[str, Any] = {"mass": 2.0, "center_of_mass": [0.5, 0, 0], "about": "body", "moments": [0.1, 1.0, 1.0]}
    figures = inertia_figures({"inertia": stated}, {})
    np.testing.assert_allclose(figures["moments"], [0.1, 0.5, 0.5], rtol=1e-12)
    stated = {"mass": 1.0, "moments": [0.1, 0.2, 0.2], "rotation": {"rpy": [0, 0, np.pi / 4]}}
    figures = inertia_figures({"inertia": stated}, {})
    np.testing.assert_allclose(figures["moments"], [0.15, 0.15, 0.2], rtol=1e-12)
    np.testing.assert_allclose(figures["products"], [-0.05, 0.0, 0.0], atol=1e-12)


@pytest.mark.parametrize(
    "stated",
    [
        *({}, {"solid": None}, {"solid": {"shape": "box", "density": 1.0}}),
        {"solid": {"shape": "sphere", "density": "nobody", "radius": 1.0}},
        {"solid": {"shape": "sphere", "density": "1/p", "radius": 1.0}},
        {"inertia": {"mass": "1 +"}},
    ],
)
def test_incomplete_inertias_have_no_figures(stated: dict[str, Any]) -> None:
    with pytest.raises(EditError, match="the inertia is not complete"):
        inertia_figures(stated, {"p": 0.0})


BEAM = {"length": 1.0, "rhoA": 1.0, "EI_y": 1.0, "EI_z": 4.0, "GJ": 1.0}


def test_a_cantilever_has_the_frequencies_of_its_two_bending_stiffnesses() -> None:
    frequencies = beam_figures(BEAM, {})["frequencies"]
    np.testing.assert_allclose(frequencies["bend_z"][0], 1.8751040687**2 / (2.0 * np.pi), rtol=1e-9)
    np.testing.assert_allclose(frequencies["bend_y"], 2.0 * np.array(frequencies["bend_z"]), rtol=1e-12)


@pytest.mark.parametrize("stated", [{"length": 1e-300}, {"rhoA": 1e-300, "EI_y": 1e300}, {"rhoA": "1/p"}])
def test_frequencies_beyond_all_numbers_are_left_out(stated: dict[str, float | str]) -> None:
    figures = beam_figures({**BEAM, **stated}, {"p": 0.0})
    json.dumps(figures, allow_nan=False)
    assert "bend_z" not in figures["frequencies"]


def test_how_far_its_theory_reaches_follows_from_the_length_alone() -> None:
    validity = beam_figures({**BEAM, "length": "2*L"}, {"L": 0.5})["validity"]
    assert [line["error"] for line in validity] == [0.01, 0.1, 0.5]
    # A force at the tip deflects it by 2/3 of slope times length; small slopes err by 16/35 of their square.
    assert validity[0]["slope"] == pytest.approx(np.sqrt(0.01 / 0.457), rel=0.01)
    assert validity[0]["deflection"] == pytest.approx(2.0 / 3.0 * validity[0]["slope"], rel=1e-12)
    assert beam_figures({**BEAM, "theory": "strain"}, {})["validity"] == []
