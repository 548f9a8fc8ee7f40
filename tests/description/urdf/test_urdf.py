"""URDF: Pinocchio's reading of it; notes and faults are in urdf.txt and mimic.txt."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import pinocchio
import pytest

import symofros as sf
from symofros.description.closing import closing_remedy
from tests.description import reading
from tests.description.urdf import models as urdf_models
from validation.inputs.cases import robot_case

ROBOT, MIMIC = map(urdf_models.document, (urdf_models.ROBOT, urdf_models.MIMIC))


def robots_folder() -> Path:
    """Where the package example-robot-data keeps its robots."""
    path = robot_case("ur5").path
    assert path is not None
    return next(parent for parent in path.parents if parent.name == "robots")


load = partial(reading.load, name="arm.urdf")


def test_urdf_links_and_joints_are_read(tmp_path: Path) -> None:
    arm = load(tmp_path, ROBOT)
    assert [body.name for body in arm.bodies] == ["base", "upper", "hand"]
    assert arm.body("base").joint is None
    joint = arm.body("upper").joint
    assert joint is not None and (joint.name, joint.kind, joint.actuated) == ("q1", "revolute", True)
    assert joint.limits == sf.Limits(-1.0, 1.0, 2.0, 5.0)
    inertia = arm.body("upper").inertia
    assert inertia is not None and inertia.mass == 2.0 and inertia.rotation == sf.Rotation.rpy(0.0, 0.0, 0.5)
    model = sf.compile(arm, sf.Options(backend="interpreter"))
    assert model.names.q == model.names.v == model.names.u == ("q1",)
    assert set(model.names.frames) == {"base", "upper", "hand"}
    np.testing.assert_allclose(model.frame_pose("hand", [0.0])[0], [0.0, 0.0, 0.5], atol=1e-15)
    joint = load(tmp_path, ROBOT.replace('effort="5" velocity="2"', 'effort="-1" velocity="-1"')).body("upper").joint
    assert joint is not None and joint.limits == sf.Limits(-1.0, 1.0)  # Negative sizes are no limits.


def test_snapping_makes_angles_exact_within_the_tolerance(tmp_path: Path) -> None:
    rough = ROBOT.replace("1.5707963267948966", "1.5708")
    for tolerance, expected in ((1e-14, 1.5708), (1e-4, np.pi / 2)):
        joint = load(tmp_path, rough, snap_tol=tolerance).body("upper").joint
        assert joint is not None and joint.rotation.values[1] == expected
    assert any("exact" in note for note in load(tmp_path, rough, snap_tol=1e-4).notes)
    with pytest.raises(ValueError, match="snap_tol"):
        load(tmp_path, rough, snap_tol=1.0)


# Robots of the package that are no mechanisms as they stand, and why.
REFUSED = {
    "quadrotor_base.urdf": "nothing moves",
    "iris_simple.urdf": "nothing moves",
    "romeo.urdf": "moves no mass",
    "romeo_laas_small.urdf": "moves no mass",
    "ur3.urdf": "lacks the attribute 'name'",
}


@pytest.mark.slow
def test_every_robot_of_the_package_loads_or_is_refused_with_a_reason() -> None:
    files = sorted(robots_folder().rglob("*.urdf"))
    assert len(files) >= 60
    for file in files:
        if file.name in REFUSED:
            with pytest.raises(sf.DescriptionError, match=REFUSED[file.name]):
                sf.load(file)
        else:
            sf.load(file)
    assert sf.load(robots_folder() / "romeo_description/urdf/romeo.urdf", waive=["massless_tip"]).bodies


def test_mimic_joints_move_as_in_pinocchio(tmp_path: Path) -> None:
    arm = load(tmp_path, MIMIC, mimic=True)
    model = sf.compile(arm, sf.Options(backend="interpreter"))
    assert model.names.u == ("q1",)
    theirs = pinocchio.buildModelFromUrdf(str(tmp_path / "arm.urdf"), mimic=True)
    q, v, a = np.array([0.3]), np.array([1.4]), np.array([-0.6])
    T, start = np.array([1.0, -0.5]), np.array([0.0, 0.2])
    np.testing.assert_allclose(model.constraint(T * q + start), 0.0, atol=1e-15)
    force = T @ model.inverse_dynamics(T * q + start, T * v, T * a)
    expected = pinocchio.rnea(theirs, theirs.createData(), q, v, a)
    np.testing.assert_allclose([force], expected, rtol=1e-13)
    acceleration = model.forward_dynamics(T * q + start, T * v, [0.8])
    tau = pinocchio.rnea(theirs, theirs.createData(), q, v, acceleration[:1])
    np.testing.assert_allclose(tau, [0.8], rtol=1e-11)


def test_quaternions_of_urdf_1_2_are_read_as_pinocchio_does(tmp_path: Path) -> None:
    stated = 'quat_xyzw="0.1 -0.2 0.3 0.9"'
    body = urdf_models.ROBOT.replace('rpy="0 1.5707963267948966 0"', stated).replace('rpy="0 0 0.5"', stated)
    text = f'<robot name="arm" version="1.2">{body}</robot>'
    model = sf.compile(load(tmp_path, text), sf.Options(backend="interpreter"))
    theirs = pinocchio.buildModelFromUrdf(str(tmp_path / "arm.urdf"))
    q, v, a = np.array([0.3]), np.array([1.4]), np.array([-0.6])
    expected = pinocchio.rnea(theirs, theirs.createData(), q, v, a)
    np.testing.assert_allclose(model.inverse_dynamics(q, v, a), expected, rtol=1e-13)
    unit = text.replace(stated, 'quat_xyzw="0 0 1 0"')
    assert any("no unit quaternions" in note for note in load(tmp_path, text).notes)
    assert not any("no unit quaternions" in note for note in load(tmp_path, unit).notes)
    for odd in (text.replace(stated, f'{stated} rpy="0 0 1"'), text.replace(stated, 'quat_xyzw="0 0 0 0"')):
        assert "can't have this quat_xyzw" in reading.faults_of(tmp_path, odd, "arm.urdf")


@pytest.mark.parametrize("kind", ["floating", "free", "screw", "", "odd"])
def test_a_joint_that_no_closure_replaces_is_dropped(kind: str) -> None:
    """A hinge in the place of a floating joint binds five directions too many."""
    assert closing_remedy("j", kind, "a", "b").startswith("drop the joint 'j'")
