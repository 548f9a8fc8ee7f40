"""The table of joint kinds against what the mechanics makes of each kind."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from symofros.description.joints.joint_kinds import KINDS, JointKind

BODY = sf.Inertia(1.0, (0.1, 0.2, 0.3), (0.02, 0.03, 0.04))
DEFINED = [kind for kind in KINDS.values() if not kind.user_defined]


def model_of(kind: str) -> sf.Model:
    joint = sf.Joint("j", kind, axis=(1.0, 2.0, 2.0), axis2=(0.0, 1.0, 0.0), pitch=0.3)  # type: ignore[arg-type]
    return sf.compile(sf.System("one", (sf.RigidBody("body", joint, BODY),)), sf.Options(backend="interpreter"))


@pytest.mark.parametrize("kind", [kind for kind in DEFINED if kind.coordinates], ids=lambda kind: kind.name)
class TestKind:
    def test_every_kind_has_the_coordinates_and_speeds_of_the_table(self, kind: JointKind) -> None:
        model = model_of(kind.name)
        assert (model.nq, model.nv) == (len(kind.coordinates), kind.nv)
        assert all(name == "j" or name.startswith("j.") for name in model.names.q + model.names.v)

    def test_angular_coordinates_are_periodic(self, kind: JointKind) -> None:
        model = model_of(kind.name)
        for i, coordinate in enumerate(kind.coordinates):
            if coordinate.measure == "component":
                continue
            q = model.neutral()
            q[i] += 2 * np.pi
            _, R = model.frame_pose("body", q)
            returned = np.allclose(R, model.frame_pose("body", model.neutral())[1], atol=1e-12)
            assert returned, "neither a shift nor a whole turn changes the orientation"

    def test_joints_turn_only_about_the_axis_of_the_table(self, kind: JointKind) -> None:
        model = model_of(kind.name)
        q, _ = model.random_state(np.random.default_rng(1))
        spins = model.frame_jacobian("body", q)[3:]
        axis = {"axis": np.array([1.0, 2.0, 2.0]) / 3, "z": np.array([0.0, 0.0, 1.0])}.get(kind.turns_about or "")
        rank = np.linalg.matrix_rank(spins, tol=1e-9)
        if axis is None:
            assert rank != 1
        else:
            assert rank == 1
            assert np.allclose(np.cross(spins.T, axis), 0.0, atol=1e-12)

    def test_each_speed_of_a_series_joint_turns_or_slides_along_its_own_axis(self, kind: JointKind) -> None:
        """Each speed of a series turns or slides about or along its own axis: one part of its partial velocity is 0."""
        model = model_of(kind.name)
        J = model.frame_jacobian("body", model.neutral())
        for k, coordinate in enumerate(kind.coordinates if kind.series else ()):
            still, moving = (J[:3, k], J[3:, k]) if coordinate.measure == "angle" else (J[3:, k], J[:3, k])
            assert np.allclose(still, 0.0, atol=1e-12)
            assert np.isclose(np.linalg.norm(moving), 1.0)
