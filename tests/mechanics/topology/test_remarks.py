"""Remarks on sound descriptions, where they must speak and where not."""

from __future__ import annotations

import math

import pytest

import symofros as sf
from symofros.mechanics.topology.remarks import rotation_remarks

TURNS = {
    "degrees": (sf.Rotation.rpy(0, 0, 90), True),
    "degrees about an axis": (sf.Rotation.axis_angle((1, 1, 0), -45), True),
    "one turn": (sf.Rotation.rpy(-6.283186, 2 * math.pi, "2*pi"), False),
    "a long axis": (sf.Rotation.axis_angle((100, 0, 0), 1), False),
    "a long quaternion": (sf.Rotation.quaternion(0, 0, 90, 90), False),
}


@pytest.mark.parametrize("case", TURNS)
def test_angles_of_more_than_a_turn_are_noted(case: str) -> None:
    rotation, speaks = TURNS[case]
    joint = sf.Joint("q", "revolute", axis=(0, 0, 1), rotation=rotation)
    system = sf.System("arm", (sf.RigidBody("arm", joint, sf.Inertia(1.0, moments=(1, 1, 1))),))
    remarks = list(rotation_remarks(system))
    assert [("more than a turn" in text and "*pi/180" in text) for text in remarks] == [True] * speaks
