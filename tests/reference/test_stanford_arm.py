"""The Stanford arm: the closed form of a pose, and whether its published inertias can exist."""

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
