"""Beams in the native file: everything that can be stated survives writing and reading."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import symofros as sf

FULL: dict[str, Any] = {
    "EI_z": "E*(1 - x/(2*L))",
    "EI_y": 2.0,
    "GJ": "E",
    "rhoJ": 0.01,
    "rhoI_y": 0.004,
    "rhoI_z": 0.006,
    "bend_y": 2,
    "bend_z": 1,
    "twist": 1,
    "damping": 0.001,
    "rotary_inertia": True,
    "retain": "all",
    "loads": [sf.BeamLoad((0, "u*sin(x)", 0)), sf.BeamLoad(torque=(1, 0, 0), at=0.5, axes="world")],
}


def system(**changed: Any) -> sf.System:
    root = sf.Joint("hub", "revolute")
    beam = sf.Beam("link", root, "L", "2 - x/L", **(FULL | changed))
    hand = sf.RigidBody("hand", sf.Joint("wrist", "revolute", "link", "tip"), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)))
    return sf.System("s", [beam, hand], [sf.Parameter("L", 2.0), sf.Parameter("E", 10.0)], [sf.Input("u")])


@pytest.mark.parametrize(
    "changed",
    [
        {},
        {"family": "legendre", "foreshortening": False},
        {
            "theory": "strain",
            "family": "legendre",
            "sections": 7,
            "curvature_y": 0.3,
            "twist_rate": "0.2*x",
            "frames": (sf.Frame("tip"), sf.Frame("middle", at=0.5)),
            "loads": (),
            "retain": "first_order",
        },
        {
            "family": "user",
            "shapes": {
                "bend_y": ["xi^2", "xi^3*(1 - xi/2)"],
                "bend_z": [sf.Samples((0, 0.2, 0.6, 1), (0, 0.04, 0.3, 1.0))],
                "twist": ["sin(pi*xi/2)"],
            },
        },
    ],
)
def test_beams_survive_writing_and_reading(tmp_path: Path, changed: dict[str, Any]) -> None:
    stated = system(**changed)
    sf.save(stated, tmp_path / "arm.yaml")
    assert sf.load(tmp_path / "arm.yaml") == stated


def test_a_tip_can_have_its_own_name(tmp_path: Path) -> None:
    text = """
symofros: 1
bodies:
  boom:
    joint: {name: q, kind: revolute, axis: [0, 0, 1]}
    beam: {length: 3, rhoA: 1.5, EI_z: 100, bend_y: 2}
    frames: {end: }
"""
    (tmp_path / "boom.yaml").write_text(text)
    model = sf.compile(sf.load(tmp_path / "boom.yaml"), sf.Options(functions=("frame_pose",)))
    p, R = model.frame_pose("end", [0.0, 0.0, 0.0])
    assert p.tolist() == [3.0, 0.0, 0.0] and R[0, 0] == 1.0
