"""URDF: planar joints in any plane, and loops that a tree has no place for."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import symofros as sf
from symofros.description.urdf.planar import planar_frames
from tests.description import reading
from tests.models import interpreted

INERTIAL = (
    '<inertial><origin xyz="0.1 -0.05 0.2" rpy="0.3 0.1 -0.2"/><mass value="2"/>'
    '<inertia ixx="0.2" iyy="0.3" izz="0.25" ixy="0.01" ixz="-0.02" iyz="0.03"/></inertial>'
)


def robot(inside: str, links: str = "ab") -> str:
    return (
        '<robot name="r"><link name="base"/>' + "".join(f'<link name="{x}">{INERTIAL}</link>' for x in links) + inside
    )


def joint(name: str, kind: str, parent: str, child: str, inside: str = "") -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}{inside}</joint>'


def load(folder: Path, text: str) -> sf.System:
    return reading.load(folder, f"{text}</robot>", "r.urdf")


ORIGIN = '<origin xyz="0.3 -0.2 0.5" rpy="0.4 -0.3 0.7"/>'


def test_planar_joints_match_pinocchio(tmp_path: Path) -> None:
    """Pinocchio's plane is across z; its speeds are those of the body along its own axes."""
    hinge = joint("q", "continuous", "a", "b", '<origin xyz="0.5 0 0.1"/><axis xyz="0 1 0"/>')
    text = robot(joint("p", "planar", "base", "a", f'{ORIGIN}<axis xyz="0 0 1"/>') + hinge)
    ours = interpreted(load(tmp_path, text))
    assert ours.names.q == ("p.x", "p.y", "p.angle", "q") and ours.nu == 1
    theirs = pinocchio.buildModelFromXML(f"{text}</robot>")
    data = theirs.createData()
    q = np.array([0.3, -0.8, 0.6, 1.1])
    v = np.array([0.2, 0.5, -0.7, 0.9])
    c, s = np.cos(q[2]), np.sin(q[2])
    to_theirs = np.eye(4)
    to_theirs[:2, :2] = [[c, s], [-s, c]]
    q_theirs = np.array([q[0], q[1], c, s, np.cos(q[3]), np.sin(q[3])])
    M = np.asarray(pinocchio.crba(theirs, data, q_theirs))
    M = np.triu(M) + np.triu(M, 1).T
    np.testing.assert_allclose(ours.mass_matrix(q), to_theirs.T @ M @ to_theirs, atol=1e-13)
    pinocchio.forwardKinematics(theirs, data, q_theirs, to_theirs @ v)
    pinocchio.updateFramePlacements(theirs, data)
    for name in "ab":
        placed = data.oMf[theirs.getFrameId(name)]
        p, R = ours.frame_pose(name, q)
        np.testing.assert_allclose(p, placed.translation, atol=1e-14)
        np.testing.assert_allclose(R, placed.rotation, atol=1e-14)
    assert ours.kinetic_energy(q, v) == pytest.approx(pinocchio.computeKineticEnergy(theirs, data), rel=1e-13)


@pytest.mark.parametrize("axis", [(0, 0, 1), (0, 0, -1), (1, 0, 0), (0, -2, 0), (0.3, -0.5, 0.8), (1e-9, 0, -1)])
def test_planar_joints_move_in_the_plane_across_their_axis(tmp_path: Path, axis: tuple[float, ...]) -> None:
    """Two slides along the plane and a hinge about the axis; at zero the link is where a fixed joint holds it."""
    text = robot(joint("p", "planar", "base", "a", f'{ORIGIN}<axis xyz="{" ".join(map(str, axis))}"/>'), "a")
    model = interpreted(load(tmp_path, text))
    assert model.nv == 3
    still = interpreted(
        load(tmp_path, robot(joint("p", "fixed", "base", "a", ORIGIN) + joint("f", "floating", "a", "b")))
    )
    p0, R0 = still.frame_pose("a", still.neutral())
    at_rest = model.frame_pose("a", np.zeros(3))
    np.testing.assert_allclose(at_rest[0], p0, atol=1e-15)
    np.testing.assert_allclose(at_rest[1], R0, atol=1e-15)
    n = R0 @ np.array(axis, dtype=float) / np.linalg.norm(axis)
    e1, e2 = (model.frame_pose("a", q)[0] - p0 for q in np.eye(3)[:2])
    np.testing.assert_allclose([e1 @ n, e2 @ n, e1 @ e2], 0.0, atol=1e-15)
    np.testing.assert_allclose([np.cross(e1, e2)], [n], atol=1e-15)
    p, R = model.frame_pose("a", [0.3, -0.8, 0.6])
    np.testing.assert_allclose(p, p0 + 0.3 * e1 - 0.8 * e2, atol=1e-15)
    turn = pinocchio.exp3(0.6 * n)
    np.testing.assert_allclose(R, turn @ R0, atol=1e-14)


@given(st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda n: 1e-3 < float(np.linalg.norm(n))))
@settings(max_examples=200, deadline=None)
def test_frames_of_planar_joints_are_rotations(axis: tuple[float, float, float]) -> None:
    rotation, back = planar_frames(sf.Rotation(), axis)
    R = np.eye(3) if back is None else np.array(rotation.values, dtype=float).reshape(3, 3)
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(R[:, 2], np.array(axis) / np.linalg.norm(axis), atol=1e-14)
    assert np.linalg.det(R) == pytest.approx(1.0)


def four_bar() -> str:
    """Crank a, coupler b, rocker c, in the x-z plane: the coupler's end at the top of the rocker."""
    hinge = '<axis xyz="0 1 0"/>'
    return robot(
        joint("q1", "continuous", "base", "a", hinge)
        + joint("q2", "continuous", "a", "b", f'<origin xyz="0 0 1"/>{hinge}')
        + joint("q3", "continuous", "base", "c", f'<origin xyz="2 0 0"/>{hinge}'),
        "abc",
    )


def test_the_remedy_for_two_parents_yields_a_closed_loop(tmp_path: Path) -> None:
    """What it says, done: the call as it stands, and the two frames."""
    last = joint("q4", "continuous", "c", "b", '<origin xyz="0 0 1"/><axis xyz="0 1 0"/>')
    with pytest.raises(sf.DescriptionError, match="two parents") as caught:
        load(tmp_path, four_bar() + last)
    remedy = caught.value.problem.remedy
    call = remedy[remedy.index("sf.Closure(") : remedy.index(") among") + 1]
    closure = eval(call, {"sf": sf})  # noqa: S307 - our own message
    assert closure == sf.Closure("q4", ("c", "q4_first"), ("b", "q4_second"), rotations=("x", "y"))
    system = load(tmp_path, four_bar())
    along = sf.Rotation.axis_angle((1, 0, 0), -np.pi / 2)  # z onto the axis y
    frames = {"c": sf.Frame("q4_first", (0, 0, 1), along), "b": sf.Frame("q4_second", (2, 0, 0), along)}
    bodies = [replace(system.body(name), frames=[frame]) for name, frame in frames.items()]
    closed = replace(system.with_bodies(*bodies), constraints=[closure])
    model = interpreted(closed)
    np.testing.assert_allclose(model.constraint(np.zeros(3)), 0.0, atol=1e-15)
    assert np.linalg.matrix_rank(model.constraint_jacobian(np.zeros(3)), tol=1e-9) == 2
