"""Beams in segments: the same beam as several in series, and all that is fixed to it where it was."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf


def arm(segments: int, functions: int = 0, **changed: Any) -> sf.System:
    """A tapered beam on a hinge, with a load and what is fixed to its tip and to its root."""
    stated = {
        "rhoA": "2 - x/L",
        "EI_z": "E*(1 - x/(2*L))",
        "rhoJ": "0.01*x",
        "loads": (
            sf.BeamLoad((0, "1 + x", 0), axes="world"),
            sf.BeamLoad((0, 2, 0), (0, 0, 0.3), at=0.5, axes="world"),
            sf.BeamLoad((1, 0, 0), at=0.0, axes="world"),
        ),
    } | changed
    beam = sf.Beam("link", sf.Joint("hub", "revolute"), "L", bend_y=functions, segments=segments, **stated)
    hand = sf.RigidBody("hand", sf.Joint("wrist", "revolute", "link", "tip"), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)))
    spring = sf.Connection("spring", ("world", None), ("link", "tip"), stiffness=10.0)
    return sf.System("arm", (beam, hand), (sf.Parameter("L", 2.0), sf.Parameter("E", 10.0)), connections=(spring,))


@pytest.mark.parametrize("segments", [2, 3, 7])
def test_a_rigid_beam_does_not_depend_on_its_segments(segments: int) -> None:
    whole, divided = (sf.compile(arm(n), sf.Options(backend="interpreter")) for n in (1, segments))
    q, v = np.array([0.3, -0.8]), np.array([1.1, 0.4])
    for par in (None, np.array([3.0, 10.0])):
        ours, theirs = (list(m.dynamics(q, v, (), par=par)) for m in (divided, whole))
        for a, b in zip(ours, theirs, strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(divided.frame_pose("tip", q)[0], whole.frame_pose("tip", q)[0], atol=1e-15)


def test_joints_connections_and_loads_of_a_divided_beam_go_to_its_segments() -> None:
    divided = arm(3)
    assert [body.name for body in divided.bodies] == ["link", "link.2", "link.3", "hand"]
    assert [body.joint.name for body in divided.bodies if body.joint] == [
        "hub",
        "link.2.clamp",
        "link.3.clamp",
        "wrist",
    ]
    assert divided.bodies[3].joint == replace(sf.Joint("wrist", "revolute"), parent="link.3", frame="tip")
    assert divided.connections[0].second == ("link.3", "tip")
    loads = [[load.at for load in body.loads] for body in divided.bodies if isinstance(body, sf.Beam)]
    assert loads == [[None, 0.0], [None, 0.5], [None]]


def test_a_divided_system_survives_writing_and_reading(tmp_path: Path) -> None:
    divided = arm(3, 2)
    sf.save(divided, tmp_path / "arm.yaml")
    assert sf.load(tmp_path / "arm.yaml") == divided


def test_segments_from_yaml_equal_those_from_python(tmp_path: Path) -> None:
    whole = arm(1, 2)
    sf.save(whole, tmp_path / "arm.yaml")
    text = (tmp_path / "arm.yaml").read_text()
    (tmp_path / "arm.yaml").write_text(text.replace("      bend_y: 2\n", "      bend_y: 2\n      segments: 3\n"))
    assert sf.load(tmp_path / "arm.yaml") == arm(3, 2)


def test_a_fault_of_a_segment_names_the_line_of_the_beam(tmp_path: Path) -> None:
    sf.save(arm(1, 2), tmp_path / "arm.yaml")
    text = (tmp_path / "arm.yaml").read_text().replace("      bend_y: 2\n", "      bend_y: 2\n      segments: 2\n")
    (tmp_path / "arm.yaml").write_text(text.replace("2 - x/L", "0.9 - x/L"))
    with pytest.raises(sf.DescriptionError, match=r"arm.yaml:\d+: beam 'link\.2': rhoA = -0\.1 at x = 1"):
        sf.compile(sf.load(tmp_path / "arm.yaml"))


@pytest.mark.parametrize("segments", [0, -1, 2.0, True])
def test_a_number_of_segments_is_a_whole_number(segments: Any) -> None:
    with pytest.raises(sf.DescriptionError, match="not a number of segments"):
        sf.Beam("b", sf.Joint("j"), 1.0, 1.0, segments=segments)


def test_a_load_along_axes_that_turn_with_the_segments_is_refused() -> None:
    with pytest.raises(sf.DescriptionError, match="axes of the undeformed beam"):
        arm(2, loads=(sf.BeamLoad((0, 1, 0)),))


def test_a_frame_may_have_the_name_of_a_segment_joint() -> None:
    beam = sf.Beam("link", sf.Joint("hub", "revolute"), 2.0, 1.0, segments=3, frames=(sf.Frame("end"),))
    m = sf.compile(sf.System("s", (beam,)), sf.Options(("frame_pose",), ("end",), backend="interpreter"))
    p, _ = m.frame_pose("end", m.neutral())
    np.testing.assert_allclose(p, (2.0, 0.0, 0.0), atol=1e-15)
