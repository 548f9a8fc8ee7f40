"""URDF: Pinocchio's reading of it, notes on what is left out, and every fault with its line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio
import pytest

import symofros as sf
from symofros.description.closing import closing_remedy
from validation.inputs.cases import robot_case

INERTIAL = (
    '<inertial><origin xyz="0.1 0 0" rpy="0 0 0.5"/><mass value="2"/>'
    '<inertia ixx="1" iyy="2" izz="2.5" ixy="0" ixz="0" iyz="0"/></inertial>'
)
ROBOT = f"""<robot name="arm">
<link name="base"/>
<link name="upper">{INERTIAL}</link>
<link name="hand">{INERTIAL}</link>
<joint name="q1" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 2"/>
  <origin xyz="0 0 1" rpy="0 1.5707963267948966 0"/><limit lower="-1" upper="1" effort="5" velocity="2"/></joint>
<joint name="weld" type="fixed"><parent link="upper"/><child link="hand"/><origin xyz="0.5 0 0"/></joint>
</robot>
"""


def robots_folder() -> Path:
    """Where the package example-robot-data keeps its robots."""
    path = robot_case("ur5").path
    assert path is not None
    return next(parent for parent in path.parents if parent.name == "robots")


def load(folder: Path, text: str, **options: object) -> sf.System:
    path = folder / "arm.urdf"
    path.write_text(text)
    return sf.load(path, **options)  # type: ignore[arg-type]


def faults(folder: Path, text: str, **options: object) -> str:
    with pytest.raises(sf.DescriptionError) as caught:
        load(folder, text, **options)
    return str(caught.value)


def test_links_and_joints(tmp_path: Path) -> None:
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


def test_floating_base_adds_a_free_joint(tmp_path: Path) -> None:
    heavy = ROBOT.replace('<link name="base"/>', f'<link name="base">{INERTIAL}</link>')
    floating = load(tmp_path, heavy, floating_base=True)
    joint = floating.body("base").joint
    assert joint is not None and (joint.name, joint.kind, joint.actuated) == ("root_joint", "free", False)
    model = sf.compile(floating, sf.Options(backend="interpreter"))
    assert (model.nq, model.nv, model.nu) == (8, 7, 1)
    assert any("never moves" in note for note in load(tmp_path, heavy).notes)


def test_what_is_ignored_is_said(tmp_path: Path) -> None:
    text = ROBOT.replace('<axis xyz="0 0 2"/>', '<axis xyz="0 0 2"/><dynamics damping="3"/><mimic joint="weld"/>')
    text = text.replace("</robot>", '<transmission name="t"/><gazebo/></robot>')
    text = text.replace('<link name="upper">', '<link name="upper"><visual/><collision/>')
    notes = "\n".join(load(tmp_path, text).notes)
    for part in ("damping", "mimic", "transmission", "gazebo", "visual"):
        assert part in notes, notes


def test_snapping_is_by_default_below_rounding(tmp_path: Path) -> None:
    rough = ROBOT.replace("1.5707963267948966", "1.5708")
    for tolerance, expected in ((1e-14, 1.5708), (1e-4, np.pi / 2)):
        joint = load(tmp_path, rough, snap_tol=tolerance).body("upper").joint
        assert joint is not None and joint.rotation.values[1] == expected
    assert any("exact" in note for note in load(tmp_path, rough, snap_tol=1e-4).notes)
    with pytest.raises(ValueError, match="snap_tol"):
        load(tmp_path, rough, snap_tol=1.0)


def test_impossible_inertias_load_with_a_note(tmp_path: Path) -> None:
    odd = load(tmp_path, ROBOT.replace('izz="2.5"', 'izz="9"'))
    assert "nonphysical_inertia" in odd.body("upper").waive
    assert any("non-physical" in note for note in odd.notes)


@pytest.mark.parametrize(
    ("change", "line", "part"),
    [
        (("</robot>", ""), 0, "<robot> of line 1 is not closed"),
        (('<robot name="arm">', '<!DOCTYPE r [<!ENTITY a "b">]><robot name="arm">'), 1, ""),
        (("robot", "model"), 1, "<model>"),
        (('type="revolute"', 'type="revolut"'), 5, "did you mean 'revolute'?"),
        (('type="revolute"', 'type="planer"'), 5, "did you mean 'planar'?"),
        (('<parent link="base"/>', '<parent link="bse"/>'), 5, "did you mean 'base'?"),
        (('<child link="upper"/>', '<child link="uper"/>'), 5, "did you mean 'upper'?"),
        (('<child link="upper"/>', ""), 5, "<child> is missing"),
        (('value="2"', 'value="heavy"'), 3, "heavy"),
        (('value="2"', 'value="nan"'), 3, "finite"),
        (('xyz="0 0 2"', 'xyz="0 0 0"'), 5, "axis"),
        (('xyz="0 0 2"', 'xyz="0 0"'), 5, "axis"),
        (('<link name="hand">', '<link name="upper">'), 4, "twice"),
        (('<parent link="base"/><child link="upper"/>', '<parent link="hand"/><child link="upper"/>'), 0, "cycle"),
        (('<child link="hand"/>', '<child link="upper"/>'), 7, "sf.Closure('weld', ('upper', 'weld_first')"),
        (("</robot>", '<link name="island"/></robot>'), 8, "two bases"),
        ((INERTIAL, ""), 0, "moves no mass"),
    ],
)
def test_each_fault_names_its_line(change: tuple[str, str], line: int, part: str, tmp_path: Path) -> None:
    message = faults(tmp_path, ROBOT.replace(*change))
    assert part in message, message
    assert f"arm.urdf:{line}" in message or line == 0, message


# Robots of the package that are no mechanisms as they stand, and why.
REFUSED = {
    "quadrotor_base.urdf": "nothing moves",
    "iris_simple.urdf": "nothing moves",
    "romeo.urdf": "moves no mass",
    "romeo_laas_small.urdf": "moves no mass",
    "ur3.urdf": "lacks the attribute 'name'",
}


@pytest.mark.slow
def test_every_robot_of_the_package_loads_or_says_why() -> None:
    files = sorted(robots_folder().rglob("*.urdf"))
    assert len(files) >= 60
    for file in files:
        if file.name in REFUSED:
            with pytest.raises(sf.DescriptionError, match=REFUSED[file.name]):
                sf.load(file)
        else:
            sf.load(file)
    assert sf.load(robots_folder() / "romeo_description/urdf/romeo.urdf", waive=["massless_tip"]).bodies


FOLLOWER = (
    '<link name="finger">' + INERTIAL + '</link><joint name="q2" type="prismatic"><parent link="hand"/>'
    '<child link="finger"/><axis xyz="0 1 0"/><limit lower="-9" upper="9" effort="9" velocity="9"/>'
    '<mimic joint="q1" multiplier="-0.5" offset="0.2"/></joint></robot>'
)
MIMIC = ROBOT.replace("</robot>", FOLLOWER)


def test_mimic_joints_move_as_pinocchio_s(tmp_path: Path) -> None:
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


@pytest.mark.parametrize(
    ("change", "part"),
    [
        (('mimic joint="q1"', 'mimic joint="q7"'), "can't mimic joint 'q7'"),
        (('mimic joint="q1"', 'mimic joint="weld"'), "type 'fixed'"),
        (('mimic joint="q1"', 'mimic joint="q2"'), "can't mimic joint 'q2'"),
        (('mimic joint="q1"', "mimic"), "lacks the attribute 'joint'"),
        (('multiplier="-0.5"', 'multiplier="half"'), "bad numbers"),
    ],
)
def test_what_can_t_be_mimicked_is_refused(tmp_path: Path, change: tuple[str, str], part: str) -> None:
    assert part in faults(tmp_path, MIMIC.replace(*change), mimic=True)
    assert any("mimic ignored" in note for note in load(tmp_path, MIMIC.replace(*change)).notes)


@pytest.mark.parametrize("kind", ["floating", "free", "screw", "", "odd"])
def test_a_joint_that_no_closure_replaces_is_dropped(kind: str) -> None:
    """A hinge in the place of a floating joint binds five directions too many."""
    assert closing_remedy("j", kind, "a", "b").startswith("drop the joint 'j'")
