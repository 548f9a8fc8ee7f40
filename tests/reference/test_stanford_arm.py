"""The Stanford arm: closed forms of a pose and of its weight, and whether its published inertias can exist."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.reference.motion import reference

ROUNDING = 1e-12


def test_with_a_straight_wrist_the_hand_lies_on_the_boom(rng: np.random.Generator) -> None:
    """Paul's first three joints: shoulder at height d1, boom d2 beside it along (c1 s2, s1 s2, c2)."""
    arm = reference("stanford_arm")
    d1, d2, d6 = (arm.parameters[name] for name in ("d1", "d2", "d6"))
    for q1, q2, d3 in rng.uniform(-2, 2, (10, 3)):
        c1, s1, c2, s2 = np.cos(q1), np.sin(q1), np.cos(q2), np.sin(q2)
        boom = np.array([c1 * s2, s1 * s2, c2])
        p, R = arm.frame_pose("hand", [q1, q2, d3, 0.0, 0.0, 0.0])
        np.testing.assert_allclose(p, [-d2 * s1, d2 * c1, d1] + (d3 + d6) * boom, atol=ROUNDING)
        np.testing.assert_allclose(R[:, 2], boom, atol=ROUNDING)


def test_weight_with_a_straight_wrist(rng: np.random.Generator) -> None:
    """The boom carries everything beyond it; about the shoulder, its first moment."""
    arm = reference("stanford_arm")
    g, beyond = 9.81, 4.25 + 1.08 + 0.63 + 0.51
    for q1, q2, d3 in rng.uniform(-2, 2, (10, 3)):
        h = arm.bias([q1, q2, d3, 0.0, 0.0, 0.0], np.zeros(6))
        assert h[0] == pytest.approx(0.0, abs=ROUNDING * 100)
        assert h[2] == pytest.approx(beyond * g * np.cos(q2), abs=ROUNDING * 100)
        # Link 4's frame is turned by -90 degrees about x: its y = 0.0092 lies along -z of the boom, its z along y.
        along = beyond * d3 - 4.25 * 0.6447 - 1.08 * 0.0092 + 0.63 * 0.0566 + 0.51 * 0.1554
        # The prismatic frame is turned by -90 degrees about the boom, so that the offset along its y is one along x.
        aside = 1.08 * -0.0054
        expected = -g * (along * np.sin(q2) + aside * np.cos(q2))
        assert h[1] == pytest.approx(expected, abs=ROUNDING * 1000)


@pytest.mark.parametrize("link", ["link2_matter", "link3", "link5_matter", "link6"])
def test_in_metres_the_printed_mass_centres_are_impossible(link: str) -> None:
    """Why the file reads the mass centres of links 2 to 6 in decimetres."""
    stated = MODELS["stanford_arm"]
    body = stated.body(link)
    assert isinstance(body, sf.RigidBody) and body.inertia is not None
    center = tuple(10.0 * float(x) for x in body.inertia.center_of_mass)  # type: ignore[arg-type]
    wrong = replace(body, inertia=replace(body.inertia, center_of_mass=center))
    with pytest.raises(sf.DescriptionError, match=f"body '{link}': non-physical inertia"):
        sf.compile(stated.with_bodies(wrong), sf.Options(backend="interpreter"))
