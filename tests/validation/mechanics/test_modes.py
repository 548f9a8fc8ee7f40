"""What has modes in runs is compared as functions have it, and the subject says so."""

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


def test_rigid_contacts_are_open_to_the_harness() -> None:
    """Compliant ones stay, in their order."""
    body = sf.RigidBody("ball", sf.Joint("free", "free"), sf.Inertia(0.4, moments=(1e-3,) * 3))
    soft, hard = (
        sf.Contact(name, ("ball", None), ("world", None), radius=0.1, **numbers)
        for name, numbers in (("soft", {"stiffness": 1e4}), ("hard", {"restitution": 0.5}))
    )
    system = sf.System("ball", (body,), connections=(hard, soft))
    compared = Subject("ball", system).system
    assert compared.connections == (soft,) and "rigid contacts are compared as open" in compared.notes[-1]
    assert Subject("soft", compared).system is compared
