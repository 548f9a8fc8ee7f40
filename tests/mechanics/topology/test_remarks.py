"""Remarks on sound descriptions, where they must speak and where not."""

from __future__ import annotations

import math
import warnings
from pathlib import Path

import pytest

import symofros as sf
from symofros.mechanics.topology.remarks import force_remarks, rotation_remarks

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


FORCES = {
    "a spring": ([sf.Spring(-5.0)], "stiffness -5 is negative"),
    "by a parameter": ([sf.Spring("k")], "stiffness -2 is negative"),
    "a spring that another outweighs": ([sf.Spring(-5.0), sf.Spring(5.5)], ""),
    "two wells": ([sf.Spring(-5.0, cubic=2.0)], ""),
    "a softening spring": ([sf.Spring(5.0, cubic=-2.0)], ""),
    "a damper": ([sf.Damper(-2.0)], "damping -2 is negative"),
    "a limit cycle": ([sf.Damper(-2.0, quadratic=1.0)], ""),
    "a damper that drives at speed": ([sf.Damper(2.0, quadratic=-1.0)], "quadratic damping -1 is negative"),
    "viscous friction": ([sf.Friction(1.0, viscous=-2.0)], "damping -2 is negative"),
}


@pytest.mark.parametrize("case", FORCES)
def test_forces_that_drive_are_noted_unless_they_are_meant(case: str) -> None:
    elements, said = FORCES[case]
    joint = sf.Joint("q", "revolute", axis=(0, 0, 1), elements=elements)
    body = sf.RigidBody("arm", joint, sf.Inertia(1.0, moments=(1, 1, 1)))
    remarks = list(force_remarks(sf.System("arm", (body,), [sf.Parameter("k", -2.0)])))
    assert len(remarks) == bool(said) and all(f"joint 'q': {said}" in text for text in remarks)


@pytest.mark.parametrize("entry", ["stiffness", "damping"])
def test_connections_that_drive_are_noted_when_read_and_compiled(entry: str, tmp_path: Path) -> None:
    body = sf.RigidBody("arm", sf.Joint("q", "free"), sf.Inertia(1.0, moments=(1, 1, 1)))
    for value in (-1.0, 1.0):
        line = sf.Connection("line", ("world", None), ("arm", None), **{entry: value})
        system = sf.System("arm", [body], connections=[line])
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            sf.compile(system, sf.Options(backend="interpreter"))
        sf.save(system, tmp_path / "arm.yaml")
        for texts in ([str(warning.message) for warning in caught], sf.load(tmp_path / "arm.yaml").notes):
            assert [f"connection 'line': {entry} -1 is negative" in text for text in texts] == [True] * (value < 0.0)
