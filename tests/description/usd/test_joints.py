"""Joints of stages whose frames stand anywhere in their bodies."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.base.rotations import axis_rotation, quaternion_matrix
from tests.description.usd.models import ARM, HALF, LOCKED, body, freedoms, joint, stage
from tests.late import require

require("pxr.Usd", "usd")


def rotation(quaternion: tuple[float, float, float, float]) -> Any:
    """The matrix of a quaternion as stages state it, the real part first."""
    w, *vector = quaternion
    return quaternion_matrix(np.array([*vector, w]))


@pytest.mark.parametrize("normal", "XYZ")
@pytest.mark.parametrize("first", ["", "base"])
def test_a_planar_joint_slides_along_and_turns_about_its_own_axes(normal: str, first: str, tmp_path: Path) -> None:
    """Frames of the joint stand anywhere in both bodies: they meet at zero, and move in one plane, seen from either."""
    own = {"localPos0": (0.5, 0.1, 1.0), "localRot0": (HALF, 0.0, HALF, 0.0)}
    other = {"localPos1": (0.2, -0.3, 0.4), "localRot1": (0.5, 0.5, 0.5, 0.5)}
    names = ("transX", "transY", "transZ", "rotX", "rotY", "rotZ")
    free = {f"rot{normal}", *(f"trans{axis}" for axis in "XYZ" if axis != normal)}
    limits = {name: LOCKED for name in names if name not in free}
    base = [body("base", **ARM), joint("Fixed", "clamp", "", "base")] if first else []
    planar = joint("", "j", first, "arm", **own, **other, **freedoms(limits))
    file = tmp_path / "robot.usda"
    file.write_text(stage(*base, body("arm", **ARM), planar))
    model = sf.compile(sf.load(file), sf.Options(backend="interpreter"))
    stated = [(np.array(each[f"localPos{k}"]), rotation(each[f"localRot{k}"])) for k, each in enumerate((own, other))]
    (p0, R0), (p1, R1) = stated
    k = "XYZ".index(normal)
    for moved in ((0.0, 0.0, 0.0), (0.2, 0.3, 0.5)):
        q = np.array(model.neutral())
        q[[list(model.names.q).index(f"j.{name}") for name in ("x", "y", "angle")]] = moved
        p, R = model.frame_pose("arm", q)
        apart, turn = R0.T @ (p + R @ p1 - p0), R0.T @ R @ R1  # Of the second frame in the first one.
        along = np.zeros(3)
        along[[(k + 1) % 3, (k + 2) % 3]] = moved[:2]
        np.testing.assert_allclose(apart, along, atol=1e-14)
        np.testing.assert_allclose(turn, axis_rotation(np.eye(3)[k], np.cos(moved[2]), np.sin(moved[2])), atol=1e-14)
