"""Kinematics of links on their parents: what partial velocities depend on, link frames, paths to the base."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import symofros as sf
from symofros.mechanics.kinematics.links import speeds_by_path
from tests.mechanics.kinematics.trees import SEEDS, case

CASES = [(seed, prescribed) for seed in SEEDS for prescribed in (False, True)]


@pytest.mark.parametrize(("seed", "prescribed"), CASES)
def test_partial_velocities_depend_on_the_configuration_alone(seed: int, prescribed: bool) -> None:
    at = case(seed, prescribed)
    for link in at.kinematics.links:
        edges = [edge for partial in link.partial_velocities for edge in (*partial.w, *partial.v)]
        assert at.groups(edges) <= ({"q"} if link.rates is None else {"u"})


@pytest.mark.parametrize(("seed", "prescribed"), CASES)
def test_rates_of_partial_velocities_are_free_of_accelerations(seed: int, prescribed: bool) -> None:
    at = case(seed, prescribed)
    for link in at.kinematics.links:
        edges = [edge for partial in link.partial_velocities for edge in (*partial.w_rate, *partial.v_rate)]
        assert at.groups(edges) <= ({"q", "v"} if link.rates is None else {"u"})


@pytest.mark.parametrize(("seed", "prescribed"), CASES)
def test_every_link_has_one_partial_velocity_a_speed(seed: int, prescribed: bool) -> None:
    at = case(seed, prescribed)
    for link, stated in zip(at.kinematics.links, at.tree.links, strict=True):
        assert len(link.partial_velocities) == len(link.speeds)
        assert len(link.free_partial_velocities) == stated.v[1]
        assert (link.rates is not None) == stated.joint.prescribed


@pytest.mark.parametrize("seed", SEEDS)
def test_a_link_that_turns_about_an_axis_has_it_along_a_coordinate_axis_of_its_frame(seed: int) -> None:
    at = case(seed)
    for link, stated in zip(at.kinematics.links, at.tree.links, strict=True):
        if stated.joint.kind in ("revolute", "continuous", "screw", "cylindrical"):
            R_LB = at.values(link.R_LB.entries)[0].reshape(3, 3)
            n_B = np.array(stated.joint.axis, float)
            n_L = R_LB @ n_B / np.linalg.norm(n_B)
            assert link.axis is not None
            np.testing.assert_allclose(np.abs(n_L), np.eye(3)[link.axis], atol=1e-15)


@pytest.mark.parametrize("seed", SEEDS)
def test_link_frames_are_orthonormal_and_right_handed(seed: int) -> None:
    at = case(seed)
    for link in at.kinematics.links:
        R_AL = at.values(link.R_AL.matrix().entries).reshape(-1, 3, 3)
        np.testing.assert_allclose(R_AL @ R_AL.transpose(0, 2, 1), np.broadcast_to(np.eye(3), R_AL.shape), atol=1e-14)
        np.testing.assert_allclose(np.linalg.det(R_AL), 1.0, atol=1e-14)


@pytest.mark.parametrize(("seed", "prescribed"), CASES)
def test_paths_to_the_base_share_out_the_speeds(seed: int, prescribed: bool) -> None:
    at = case(seed, prescribed)
    paths = speeds_by_path(at.kinematics)
    assert sorted(k for path in paths for k in path) == list(range(at.kinematics.nv))
    link_of = {k: i for i, link in enumerate(at.tree.links) for k in range(link.v[0], sum(link.v))}
    for path in paths:
        assert path == sorted(path, reverse=True)
        for outer, inner in zip(path, path[1:], strict=False):
            assert link_of[inner] in at.tree.ancestors(link_of[outer])


@pytest.mark.parametrize("seed", SEEDS)
def test_the_first_path_is_the_longest_way_to_the_base(seed: int) -> None:
    at = case(seed)
    links = at.kinematics.links

    def depth(i: int) -> int:
        return 0 if i < 0 else len(links[i].own_speeds) + depth(links[i].parent)

    paths = speeds_by_path(at.kinematics)
    assert len(paths[0]) == max(depth(i) for i in range(len(links)))


@pytest.mark.parametrize("seed", range(4))
def test_a_stated_matrix_turns_at_its_own_rate(seed: int) -> None:
    """A joint by a quaternion, or an axis, of its coordinates: w of differences of R, and of SciPy's composition."""
    rng = np.random.default_rng(seed)
    turns = (
        sf.Rotation.quaternion("sin(a)", "0.5*b", "cos(b - a)", "1 + a*a"),
        sf.Rotation.axis_angle(("1", "a", "b"), "a - 2*b"),
    )
    joint = sf.Joint("g", "general", coordinates=("a", "b"), moving_rotation=turns[seed % 2])
    system = sf.System("s", (sf.RigidBody("b", joint, sf.Inertia(1.0)),))
    model = sf.compile(system, sf.Options(("frame_pose", "frame_velocity"), ("b",), backend="interpreter"))
    q, v, h = rng.uniform(-1.0, 1.0, 2), rng.uniform(-1.0, 1.0, 2), 1e-5
    ahead, behind = (Rotation.from_matrix(model.frame_pose("b", q + s * h * v)[1]) for s in (1, -1))
    w = (ahead * behind.inv()).as_rotvec() / (2 * h)
    np.testing.assert_allclose(model.frame_velocity("b", q, v)[3:], w, atol=1e-8)
