"""URDF and MJCF: Pinocchio and MuJoCo load them and agree with the original; what was dropped is said."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pinocchio
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.exports.interchange.rigid import _beam_inertia
from symofros.exports.interchange.urdf import _rpy
from symofros.mechanics.topology.numbers import Numbers
from tests.exports.cases import system_of

SAME = 1e-12

WRIST = sf.load(Path(__file__).with_name("wrist.yaml"))


def original(name: str) -> sf.System:
    return WRIST if name == "wrist" else system_of(name)


@pytest.mark.parametrize("name", ["panda", "ur5", "four_bar", "wrist", "puma560", "anymal"])
def test_exported_urdf_agrees_in_pinocchio(tmp_path: Path, name: str, rng: np.random.Generator) -> None:
    system = original(name)
    done = sf.export(system, "urdf", tmp_path)
    engine = pinocchio.buildModelFromUrdf(str(done.files[0]))
    model = sf.compile(system)
    order_q, order_v = _order(engine, model)
    for _ in range(3):
        q, v = model.random_state(rng)
        data = engine.createData()
        theirs = _angles(engine, q[order_q])
        M = pinocchio.crba(engine, data, theirs)
        M = np.triu(M) + np.triu(M, 1).T
        h = pinocchio.nonLinearEffects(engine, data, theirs, v[order_v])
        wanted = model.mass_matrix(q)[np.ix_(order_v, order_v)] - _armature(system, model)[np.ix_(order_v, order_v)]
        assert np.abs(M - wanted).max() < SAME * max(1.0, np.abs(wanted).max())
        assert np.abs(h - model.bias(q, v)[order_v]).max() < SAME * max(1.0, np.abs(h).max())


def _armature(system: sf.System, model: sf.Model) -> np.ndarray:
    """What URDF has no place for."""
    found = {
        b.joint.name: float(b.joint.armature) for b in system.bodies if b.joint and isinstance(b.joint.armature, float)
    }
    return np.diag([found.get(name, 0.0) for name in model.names.v])


def _order(engine: pinocchio.Model, model: sf.Model) -> tuple[list[int], list[int]]:
    """Our indices in the order of Pinocchio, which sorts joints by name."""
    q, v = [], []
    for name, joint in zip(list(engine.names)[1:], list(engine.joints)[1:], strict=True):
        if joint.nv == 6:
            q += range(7)
            v += range(6)
        else:
            at = model.names.v.index(name)
            v.append(at)
            q.append(model.names.q.index(model.names.v[at]))
    return q, v


def _angles(engine: pinocchio.Model, q: np.ndarray) -> np.ndarray:
    """Joints without limits are cosine and sine in Pinocchio."""
    found, at = [], 0
    for joint in list(engine.joints)[1:]:
        if joint.nq == 2:
            found += [np.cos(q[at]), np.sin(q[at])]
            at += 1
        else:
            found += list(q[at : at + joint.nq])
            at += joint.nq
    return np.array(found)


def test_losses_of_an_export_are_listed(tmp_path: Path) -> None:
    urdf = "\n".join(sf.export(system_of("planar_robot"), "urdf", tmp_path / "urdf").notes)
    for words in (
        "beams as rigid bodies, without their elastic coordinates: link1, link2",
        "rotors dropped: q1",
        "springs, stops and friction of joints dropped: q1, e1",
        "parameters as the numbers",
    ):
        assert words in urdf
    mjcf = "\n".join(sf.export(system_of("four_bar"), "mjcf", tmp_path / "mjcf").notes)
    assert "closure 'loop' also holds y" in mjcf
    assert "soft" in mjcf
    assert "loops are open: loop" in "\n".join(sf.export(system_of("four_bar"), "urdf", tmp_path / "open").notes)


@pytest.mark.parametrize(("moment", "said"), [(0.1, False), (0.0, True)])
def test_a_raised_line_inertia_is_noted(tmp_path: Path, moment: float, said: bool) -> None:
    """MuJoCo refuses it as it is, and reads what is written."""
    rod = sf.RigidBody("rod", sf.Joint("q", "revolute"), sf.Inertia(1.0, (0.5, 0, 0), (moment, 0.1, 0.1)))
    done = sf.export(sf.System("rod", (rod,)), "mjcf", tmp_path)
    assert done.notes == ("moments of inertia near zero raised to 1e-12: rod",) * said
    assert mujoco.MjModel.from_xml_path(str(done.files[0])).body_inertia[1].min() >= 1e-12


def test_joints_beyond_a_format_are_named(tmp_path: Path) -> None:
    with pytest.raises(sf.ExportError, match=r"'nut' \(screw\), 'float' \(general\)"):
        sf.export(MODELS["joint_zoo"], "urdf", tmp_path)
    assert not any(tmp_path.iterdir())


def test_mujoco_closes_the_loop(tmp_path: Path) -> None:
    done = sf.export(system_of("four_bar"), "mjcf", tmp_path)
    engine = mujoco.MjModel.from_xml_path(str(done.files[0]))
    assert engine.neq == 1
    data = mujoco.MjData(engine)
    data.qpos[:] = [1.2, -1.2, 1.2]
    mujoco.mj_forward(engine, data)
    assert np.abs(data.efc_pos[: data.ne]).max() < 1e-12


def _pair(*constraints: sf.Coupling) -> sf.System:
    """Three arms on the ground, and a slide."""
    arm = sf.Inertia(1.0, (0.2, 0.0, 0.1), (0.02, 0.05, 0.04))
    joints = [sf.Joint(f"q{k}", "prismatic" if k == 3 else "revolute", axis=(0.0, 1.0, 0.0)) for k in range(4)]
    bodies = tuple(sf.RigidBody(f"arm{k}", joint, arm) for k, joint in enumerate(joints))
    return sf.System("geared", bodies, constraints=constraints, parameters=(sf.Parameter("ratio", -2.5),))


def test_gears_and_cams_are_joint_equalities_of_mujoco(tmp_path: Path, rng: np.random.Generator) -> None:
    gear = sf.Coupling("gear", "q1 - ratio*q0 - 0.3")
    cam = sf.Coupling("cam", "2*(q3 - 0.1*(q2 - 0.2)^4) + q2/ratio")
    still = sf.Coupling("still", "q1 + q1 - 0.6")
    done = sf.export(_pair(gear, cam, still), "mjcf", tmp_path)
    engine = mujoco.MjModel.from_xml_path(str(done.files[0]))
    assert not any("dropped: gear" in note for note in done.notes)
    data = mujoco.MjData(engine)
    for _ in range(5):
        data.qpos[:] = q = rng.uniform(-1.0, 1.0, 4)
        mujoco.mj_forward(engine, data)
        residuals = q[1] + 2.5 * q[0] - 0.3, q[3] - 0.1 * (q[2] - 0.2) ** 4 - q[2] / 5.0, q[1] - 0.3
        assert data.efc_pos[: data.ne] == pytest.approx(residuals, abs=1e-14)
    back = sf.compile(sf.load(done.files[0]))
    assert back.constraint(q) == pytest.approx(residuals, abs=1e-14)


def test_gears_become_urdf_mimics(tmp_path: Path, rng: np.random.Generator) -> None:
    """The mass matrix of what is free is G^T M G, in Pinocchio, which eliminates mimics."""
    done = sf.export(_pair(sf.Coupling("gear", "q1 - ratio*q0 - 0.3")), "urdf", tmp_path)
    engine = pinocchio.buildModelFromUrdf(str(done.files[0]), mimic=True)
    assert engine.nv == 3
    q = rng.uniform(-1.0, 1.0, 4)
    q[1] = -2.5 * q[0] + 0.3
    model = sf.compile(_pair())
    G = np.array([[1.0, 0.0, 0.0], [-2.5, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    free = np.array([np.cos(q[0]), np.sin(q[0]), np.cos(q[2]), np.sin(q[2]), q[3]])
    M = pinocchio.crba(engine, engine.createData(), free)
    M = np.triu(M) + np.triu(M, 1).T
    assert np.abs(M - G.T @ model.mass_matrix(q) @ G).max() < SAME
    assert sf.compile(sf.load(done.files[0], mimic=True)).constraint(q) == pytest.approx([0.0], abs=1e-15)


def test_couplings_that_mimic_cannot_express_are_dropped(tmp_path: Path) -> None:
    """A curve, a joint that is held, a second line of one joint, a leader that follows."""
    lines = ("q1 - q0", "q1 - 2*q2", "q2 - q1", "q3 - q2^2", "q3 - 0.5")
    system = _pair(*(sf.Coupling(f"c{k}", line) for k, line in enumerate(lines)))
    done = sf.export(system, "urdf", tmp_path)
    assert "constraints dropped, loops are open: c1, c2, c3, c4" in done.notes
    assert done.files[0].read_text().count("<mimic") == 1


@pytest.mark.parametrize("noise", [0.0, 1e-16, 1e-12, 1e-9, 1e-8, 1e-7])
def test_angles_near_right_angles_give_the_rotation(noise: float) -> None:
    """Near a pitch of a right angle, roll and yaw are defined by noise, but for their sum."""
    rng, numbers = np.random.default_rng(1), Numbers(sf.System("s"))
    for quarters in product(range(4), repeat=3):
        R = numbers.rotation(sf.Rotation.rpy(*(np.array(quarters) * np.pi / 2 + noise * rng.standard_normal(3))))
        np.testing.assert_allclose(numbers.rotation(sf.Rotation.rpy(*_rpy(R))), R, rtol=0, atol=1e-14)


@pytest.mark.parametrize("rotary", [False, True])
def test_a_rigid_beam_has_the_inertia_of_its_sections(rotary: bool) -> None:
    """Of a taper whose centres leave the axis, by a sum over thin slices."""
    moments = {"rhoJ": 0.05, "rhoI_y": 0.03, "rhoI_z": 0.02, "rhoI_yz": 0.004}
    stiff = dict.fromkeys(("EA", "GA_y", "GA_z", "GJ", "EI_y", "EI_z"), 100.0)
    beam = sf.Beam(
        "taper",
        sf.Joint("q", "revolute"),
        2.0,
        "1 + x",
        theory="strain",
        rotary_inertia=rotary,
        bend_y=1,
        bend_z=1,
        mass_center=("0.1*x", "x^2/8 - 0.2"),
        **moments,
        **stiff,
    )
    x = (np.arange(4000) + 0.5) / 2000.0
    slices = (1.0 + x) / 2000.0
    places = np.column_stack([x, 0.1 * x, x**2 / 8 - 0.2])
    center = slices @ places / slices.sum()
    expected = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(slices, places - center, strict=True))
    J, y, z, yz = (2.0 * moment for moment in moments.values())
    expected = expected + (np.array([[J, 0, 0], [0, y, -yz], [0, -yz, z]]) if rotary else np.diag([J, 0.0, 0.0]))
    mass, found, inertia = _beam_inertia(beam, Numbers(sf.System("taper", (beam,))))
    assert mass == pytest.approx(4.0) and found == pytest.approx(center, abs=1e-6)
    np.testing.assert_allclose(inertia, expected, atol=1e-6)


@pytest.mark.parametrize(
    ("stated", "notes"),
    [
        ({}, []),
        ({"position": (0.0, 0.0, 1e-9)}, ["coordinates of free joints"]),
        ({"rotation": sf.Rotation.axis_angle((1, 2, 3), "0.7")}, ["coordinates of free joints"]),
        ({"armature": 0.3}, ["armature of free joints"]),
        ({"position": (1.0, 0.0, 0.0), "armature": 0.3}, ["coordinates of free joints", "armature of free joints"]),
    ],
)
def test_the_other_meaning_of_a_free_joint_in_mujoco_is_noted(tmp_path: Path, stated: Any, notes: list[str]) -> None:
    """MuJoCo counts it from the world: the same numbers are another pose; without a note pose and motion agree."""
    body = sf.RigidBody("base", sf.Joint("float", "free", **stated), sf.Inertia(2.0, (0.1, 0.0, 0.2), (0.3, 0.4, 0.5)))
    system = sf.System("floating", (body,))
    done = sf.export(system, "mjcf", tmp_path)
    assert [note.partition(",")[0] for note in done.notes] == notes
    assert all(note.endswith(": float") for note in done.notes)
    model, engine = sf.compile(system), mujoco.MjModel.from_xml_path(str(done.files[0]))
    data, q = mujoco.MjData(engine), model.neutral()
    q[:3], q[3:] = (0.3, 0.2, 0.1), (0.5, 0.5, 0.5, 0.5)
    data.qpos[:], data.qvel[:] = np.r_[q[:3], q[6], q[3:6]], (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
    mujoco.mj_forward(engine, data)
    R = data.xmat[1].reshape(3, 3)
    v = np.r_[R.T @ data.qvel[:3], data.qvel[3:]]
    p, turned = model.frame_pose("base", q)
    pose_agrees = bool(max(np.abs(p - data.xpos[1]).max(), np.abs(turned - R).max()) < SAME)
    assert pose_agrees == ("coordinates of free joints" not in notes)
    if pose_agrees:
        a = model.forward_dynamics(q, v, np.zeros(0))
        in_body_axes = np.r_[R.T @ data.qacc[:3] - np.cross(v[3:], v[:3]), data.qacc[3:]]
        assert bool(np.abs(a - in_body_axes).max() < 1e-9) == (not notes)
