"""What a beam has that is not stated."""

from __future__ import annotations

from dataclasses import fields

import symofros as sf

NAMES = ["EI_z", "EI_y", "GJ", "rhoJ", "rhoI_y", "rhoI_z", "EA", "GA_y", "GA_z", "damping"]
NAMES += ["curvature_y", "curvature_z", "twist_rate"]


def test_stiffnesses_inertias_and_damping_that_are_not_stated_are_zero() -> None:
    beam = sf.Beam("b", sf.Joint("clamp", "fixed"), 1.0, 1.0)
    assert {name: getattr(beam, name) for name in NAMES} == dict.fromkeys(NAMES, 0.0)
    stated = {item.name for item in fields(sf.Beam) if item.type == "Value" and isinstance(item.default, float)}
    assert stated == set(NAMES)
