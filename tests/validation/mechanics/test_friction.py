"""Friction that sticks is compared as the smooth friction that functions have, and the subject says so."""

from __future__ import annotations

import symofros as sf
from validation.contract.interface import Subject


def test_friction_that_sticks_is_smooth_to_the_harness() -> None:
    """Other elements stay; systems without it are left alone."""
    elements = (sf.Damper(0.3), sf.Friction(1.0, sticks=True), sf.Friction(0.2))
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=elements)
    system = sf.System("rubbing", (sf.RigidBody("block", joint, sf.Inertia(1.0)),))
    smooth = Subject("rubbing", system).system
    joint_of = smooth.body("block").joint
    assert joint_of is not None and joint_of.elements == (sf.Damper(0.3), sf.Friction(1.0), sf.Friction(0.2))
    assert "friction that sticks is compared" in smooth.notes[-1]
    assert Subject("smooth", smooth).system is smooth
