"""Figures of a rigid body as one types it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

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
def test_what_is_not_complete_has_none(stated: dict[str, Any]) -> None:
    with pytest.raises(EditError, match="the inertia is not complete"):
        inertia_figures(stated, {"p": 0.0})
