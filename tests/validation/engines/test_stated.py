"""Chains by parameters stand where these have them; what is asked of arms follows from their parts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.late import needs_extra
from validation.engines.functions.arms import ARMS
from validation.engines.interface import Slot, State
from validation.engines.matrix import SEED, Truths, asked, judged
from validation.engines.models import stated
from validation.engines.plugins import OWN
from validation.engines.plugins.roboticstoolbox import denavit
from validation.engines.plugins.writing.source import Source
from validation.engines.proving.pieces import Layout
from validation.engines.tree import BASE, DENAVIT, MODIFIED
from validation.engines.truth.dynamics import Point, Truth, digits, random_state
from validation.engines.truth.kinematics import Kinematics
from validation.engines.truth.points import POINT
from validation.engines.verdicts import RED, judge
from validation.engines.workers import Job

Array = NDArray[np.float64]
_TREES = stated.trees()
_ARM = _TREES["arm with a tool"]
_LAYOUT = Layout(6, 6, (*((Slot("angle", (k,), (k,)),) for k in range(6)), ()))
_STATE = random_state(_ARM, _LAYOUT, 3)


def _of(name: str, state: State = _STATE) -> Array:
    return digits(Truth(_ARM, _LAYOUT).value(ARMS[name].truth, Point.of(state)))


def _placed(axis: int, angle: float, p: tuple[float, float, float]) -> Array:
    T, c, s = np.eye(4), np.cos(angle), np.sin(angle)
    j, k = (axis + 1) % 3, (axis + 2) % 3
    T[j, j], T[j, k], T[k, j], T[k, k] = c, -s, s, c
    T[:3, 3] = p
    return T


@pytest.mark.parametrize("kind", [DENAVIT, MODIFIED])
def test_a_chain_is_the_product_of_its_parameters(kind: str) -> None:
    tree = _TREES[f"chain by {kind}"]
    layout = Layout(3, 3, tuple((Slot("length" if k == 1 else "angle", (k,), (k,)),) for k in range(3)))
    state = random_state(tree, layout, 4)
    T, found = np.eye(4), digits(Truth(tree, layout).value(lambda t, s: t.kinematics.flat_poses(s.q), Point.of(state)))
    for k, (joint, along, a, alpha, offset) in enumerate(stated._SHORT):
        own = state.q[k] + offset
        turn, d = (along, own) if joint == "prismatic" else (own, along)
        about_z = _placed(2, turn, (0.0, 0.0, d))
        about_x = _placed(0, alpha, (a, 0.0, 0.0))
        T = T @ (about_z @ about_x if kind == DENAVIT else about_x @ about_z)
        np.testing.assert_allclose(found[k], [*T[:3, 3], *T[:3, :3].flat], atol=1e-14)


def test_the_end_of_an_arm_moves_as_its_jacobian_says() -> None:
    size, J = 1e-6, _of("end_jacobian")
    poses = [_of("end_pose", replace(_STATE, q=_STATE.q + sign * size * _STATE.v)) for sign in (-1, 1)]
    R, moved = _of("end_pose")[3:].reshape(3, 3), (poses[1] - poses[0]) / (2 * size)
    spin = moved[3:].reshape(3, 3) @ R.T
    twist = np.array([*moved[:3], spin[2, 1], spin[0, 2], spin[1, 0]])
    np.testing.assert_allclose(J @ _STATE.v, twist, atol=1e-8)
    np.testing.assert_allclose(_of("end_jacobian_local"), np.kron(np.eye(2), R.T) @ J, atol=1e-13)
    before, after = (_of("end_jacobian", replace(_STATE, q=_STATE.q + sign * size * _STATE.v)) for sign in (-1, 1))
    np.testing.assert_allclose(_of("end_jacobian_rate"), (after - before) / (2 * size), atol=1e-8)
    np.testing.assert_allclose(_of("end_jacobian_dq") @ _STATE.v, _of("end_jacobian_rate"), atol=1e-12)


@pytest.mark.parametrize("engine", ["dart", "drake", "roboticstoolbox"])
def test_solutions_reach_their_goals_and_a_start_is_none(engine: str) -> None:
    plugin, tree = OWN[engine], _TREES["goals of seven hinges"]
    if not plugin.version():
        pytest.skip(needs_extra(f"engine-{engine}", engine))
    names = [name for name in asked(plugin, tree) if name.partition(":")[0] == "goal_pose"]
    found = {one.cell.function: one for one in judged(plugin, Job(engine, tree, tuple(names), SEED), Truths())}
    assert len(names) == len(found) and {one.cell.verdict for one in found.values()} == {"right"}
    one = found[names[-1]]
    assert one.want is not None and one.answer.state is not None and one.answer.layout is not None
    near = replace(one.answer.state, q2=one.answer.state.q2 + np.tanh(one.answer.state.v) / 4)
    start = digits(Truth(tree, one.answer.layout).value(ARMS["goal_pose"].truth, Point.of(near)))
    assert judge("planted", tree, "goal_pose", start, one.want).verdict in RED


def test_goals_are_parts_of_one_pose() -> None:
    pose = _of("end_pose", replace(_STATE, q=_STATE.q2))
    np.testing.assert_array_equal(_of("goal_pose"), pose)
    far = _of("end_pose", replace(_STATE, q=8 * _STATE.q2))
    np.testing.assert_array_equal(_of("goal_pose_far"), far)
    np.testing.assert_array_equal([*_of("goal_place"), *_of("goal_turn")], pose)
    np.testing.assert_allclose(_of("goal_point"), pose[:3] + pose[3:].reshape(3, 3) @ POINT, atol=1e-15)


def test_manipulability_is_a_determinant_and_has_its_slopes() -> None:
    J, size = _of("end_jacobian"), 1e-6
    assert _of("manipulability")[0] == pytest.approx(np.sqrt(np.linalg.det(J @ J.T)))
    before, after = (_of("manipulability", replace(_STATE, q=_STATE.q + sign * size * _STATE.v))[0] for sign in (-1, 1))
    assert _of("manipulability_dq") @ _STATE.v == pytest.approx((after - before) / (2 * size), abs=1e-9)


def test_rates_of_angles_make_the_angular_velocity() -> None:
    """Turned by small angles at each rate, the end's angles are those of its rotation."""
    size, K = 1e-6, _of("end_jacobian_of_rpy")

    def angles(q: Array) -> Array:
        R = _of("end_pose", replace(_STATE, q=q))[3:].reshape(3, 3)
        return np.array([np.arctan2(R[2, 1], R[2, 2]), -np.arcsin(R[2, 0]), np.arctan2(R[1, 0], R[0, 0])])

    rates = (angles(_STATE.q + size * _STATE.v) - angles(_STATE.q - size * _STATE.v)) / (2 * size)
    np.testing.assert_allclose(K[3:] @ _STATE.v, rates, atol=1e-8)
    M = digits(Truth(_ARM, _LAYOUT).value(lambda t, s: t.M(s.q), Point.of(_STATE)))
    np.testing.assert_allclose(K.T @ _of("end_mass_matrix") @ K, M, rtol=1e-9, atol=1e-9)
    g = digits(Truth(_ARM, _LAYOUT).value(lambda t, s: t.g(s.q), Point.of(_STATE)))
    np.testing.assert_allclose(K.T @ _of("end_gravity"), g, atol=1e-10)
    np.testing.assert_allclose(_of("inertia_forces"), M @ _STATE.a, atol=1e-13)


def test_held_forces_of_the_last_link_are_slopes_of_its_potential_energy() -> None:
    """Held forces are slopes of the potential energy of what is carried."""
    size, at = 1e-6, np.array([0.25, -0.5, 0.125])
    g = digits(Truth(_ARM, _LAYOUT).value(lambda t, s: t.g(s.q), Point.of(_STATE)))

    def stored(q: Array) -> float:
        R, p = _last(q)
        return float(2.0 * 9.81 * (p + R @ at)[2])

    steps = size * np.eye(6)
    slopes = [(stored(_STATE.q + step) - stored(_STATE.q - step)) / (2 * size) for step in steps]
    np.testing.assert_allclose(_of("end_point_mass") - g, slopes, atol=1e-7)


def test_forces_of_a_load_have_its_power() -> None:
    size = 1e-6
    R, p = _last(_STATE.q)
    force, moment = R @ _STATE.tau[:3], R @ _STATE.tau[3:]
    powers = []
    for k in range(6):
        (R1, p1), (R2, p2) = (_last(_STATE.q + sign * size * np.eye(6)[k]) for sign in (-1, 1))
        spin = (R2 - R1) @ R.T / (2 * size)
        powers.append(force @ (p2 - p1) / (2 * size) + moment @ np.array([spin[2, 1], spin[0, 2], spin[1, 0]]))
    np.testing.assert_allclose(_of("end_loads_local"), powers, atol=1e-8)


def _last(q: Array) -> tuple[Array, Array]:
    """Rotation and position of the last link before the tool."""
    poses = digits(
        Truth(_ARM, _LAYOUT).value(lambda t, s: t.kinematics.flat_poses(s.q), Point.of(replace(_STATE, q=q)))
    )
    return poses[5, 3:].reshape(3, 3), poses[5, :3]


def test_parameters_are_read_from_the_tree_that_is_judged() -> None:
    """A tree that has been shrunk is stated by its own parameters, or not at all."""
    tree = _TREES[f"chain by {MODIFIED}"]
    made = denavit.write(replace(tree, links=tree.links[:1]))
    assert isinstance(made, Source) and "PrismaticMDH" not in made.closing[0] and "alpha=1.25" in made.closing[0]
    first = tree.links[0]
    off = replace(first, joints=(replace(first.joints[0], axis=(1.0, 0.0, 0.0)),))
    assert not isinstance(denavit.write(replace(tree, links=(off,))), Source)


def test_engines_are_asked_about_a_base_only_if_they_have_one() -> None:
    tree = _TREES["hinges on a turned base"]
    assert tree.demands == {BASE}
    assert Kinematics(tree, Layout(3, 3, tuple((Slot("angle", (k,), (k,)),) for k in range(3)))).nv == 3
