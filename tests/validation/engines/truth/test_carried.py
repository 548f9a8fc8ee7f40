"""Wholes and subtrees follow from single links; what a link sees, from its axes; powers, from energies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from validation.engines.functions import FUNCTIONS
from validation.engines.functions.carried import CARRIED
from validation.engines.interface import Slot, State, vector
from validation.engines.models import hostile
from validation.engines.models.files import urdf
from validation.engines.models.files.readers import BODY
from validation.engines.proving.pieces import Layout
from validation.engines.truth.dynamics import Point, Truth, digits, random_state

Array = NDArray[np.float64]
_TREE = hostile.trees()["branches, numbered across"]
_N = len(_TREE.links)
_LAYOUT = Layout(_N, _N, tuple((Slot("angle", (k,), (k,)),) for k in range(_N)))
_STATE = random_state(_TREE, _LAYOUT, 5)
_SIZE = 1e-6


def _of(name: str, state: State = _STATE) -> Array:
    return digits(Truth(_TREE, _LAYOUT).value(FUNCTIONS[name].truth, Point.of(state)))


def _slope(name: str) -> Array:
    """The rate of a function of q as the tree moves."""
    before, after = (_of(name, replace(_STATE, q=_STATE.q + sign * _SIZE * _STATE.v)) for sign in (-1, 1))
    return np.asarray((after - before) / (2 * _SIZE))


@pytest.mark.parametrize(
    ("name", "axis"),
    [
        ("planar about x", (1.0, 0.0, 0.0)),
        ("planar about y", (0.0, 1.0, 0.0)),
        ("planar against z", (0.0, 0.0, -1.0)),
        ("planar, oblique", (0.6, 0.0, 0.8)),
    ],
)
def test_a_plane_turns_about_its_axis(name: str, axis: tuple[float, float, float]) -> None:
    tree = urdf.files()[f"urdf: {name}"].tree
    layout = Layout(4, 4, ((Slot("planar angle", (0, 1, 2), (0, 1, 2)),), (Slot("angle", (3,), (3,)),)))
    state = random_state(tree, layout, 6)
    turning, _ = digits(Truth(tree, layout).value(FUNCTIONS["link_turning"].truth, Point.of(state)))
    np.testing.assert_allclose(turning, state.v[2] * np.array(BODY.joints[0].R) @ axis, atol=1e-14)
    at_rest = digits(Truth(tree, layout).value(FUNCTIONS["link_poses"].truth, Point.of(replace(state, q=0 * state.q))))
    np.testing.assert_allclose(at_rest[0], [*BODY.joints[0].p, *np.ravel(BODY.joints[0].R)], atol=1e-14)


def test_a_link_has_the_state_that_it_is_in() -> None:
    np.testing.assert_array_equal(_of("coordinates_of_links"), _STATE.q)
    np.testing.assert_array_equal(_of("speeds_of_links"), _STATE.v)
    np.testing.assert_allclose(_of("link_turning"), _of("link_velocities")[:, 3:], atol=1e-15)


def test_centres_move_as_they_say() -> None:
    np.testing.assert_allclose(_of("mass_centre_velocity"), _slope("mass_centre"), atol=1e-8)
    np.testing.assert_allclose(_of("subtree_centre_jacobians") @ _STATE.v, _slope("subtree_centres"), atol=1e-8)
    still = replace(_STATE, v=0 * _STATE.v)
    np.testing.assert_allclose(
        _of("mass_centre_acceleration", still), _of("mass_centre_jacobian") @ _STATE.a, atol=1e-12
    )
    turning = _of("mass_centre_acceleration") - _of("mass_centre_jacobian") @ _STATE.a
    np.testing.assert_allclose(turning, _slope("mass_centre_jacobian") @ _STATE.v, atol=1e-8)


def test_a_whole_is_the_sum_of_its_branches() -> None:
    roots = [k for k, link in enumerate(_TREE.links) if link.parent < 0]
    masses, centres = _of("subtree_masses")[roots], _of("subtree_centres")[roots]
    assert len(roots) == 2 and masses.sum() == pytest.approx(sum(link.mass for link in _TREE.links))
    np.testing.assert_allclose(masses @ centres / masses.sum(), _of("mass_centre"), atol=1e-13)
    regressor = _of("static_regressor").reshape(3, _N, 4)
    stated = np.array([[link.mass, *(link.mass * np.array(link.com))] for link in _TREE.links])
    np.testing.assert_allclose(np.einsum("ikj,kj->i", regressor, stated), _of("mass_centre"), atol=1e-13)


def test_a_link_that_turns_alone_carries_the_inertia_that_its_force_takes() -> None:
    """The diagonal of the mass matrix is the energy of each link with all it carries, as one body."""
    J, M = _of("jacobian_local"), _of("mass_matrix")
    for k, whole in enumerate(_of("carried_inertias")):
        assert J[k][:, k] @ whole @ J[k][:, k] == pytest.approx(M[k, k])


def test_holding_wrenches_contain_the_force_that_drives_the_joint() -> None:
    """Along the axis of a joint without armature, at any speed; at rest it is what it is without speeds."""
    J, held = _of("jacobian_local"), _of("joint_wrenches_driven")
    axial = [J[k][3:, k] @ held[k][3:] for k in range(_N)]
    np.testing.assert_allclose(axial, _STATE.tau, atol=1e-11)
    still = replace(_STATE, v=0 * _STATE.v)
    np.testing.assert_allclose(_of("joint_wrenches_from_rest"), _of("joint_wrenches_driven", still), atol=1e-12)
    assert np.abs(_of("joint_wrenches_from_rest") - held).max() > 0.1


@pytest.mark.parametrize("name", ["mass_matrix", "link_poses"])
def test_derivatives_by_coordinates_are_slopes(name: str) -> None:
    np.testing.assert_allclose(_of(f"{name}_dq") @ _STATE.v, _slope(name), atol=1e-8)


def test_links_have_what_moves_them() -> None:
    """Of a link that carries none, what holds it is what moves it; of roots, what the world exerts."""
    held = _of("joint_wrenches")
    leaves = [k for k in range(_N) if all(link.parent != k for link in _TREE.links)]
    for k in leaves:
        link = _TREE.links[k]
        c = np.array(link.com)
        about = np.array(link.inertia) + link.mass * (c @ c * np.eye(3) - np.outer(c, c))
        moments = [about[place] for place in ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))]
        np.testing.assert_allclose(
            _of("link_regressors")[k] @ [link.mass, *(link.mass * c), *moments], held[k], atol=1e-12
        )
    poses, total = _of("link_poses"), np.zeros(6)
    for k, link in enumerate(_TREE.links):
        if link.parent < 0:
            force, moment = (poses[k, 3:].reshape(3, 3) @ part for part in (held[k, :3], held[k, 3:]))
            total += [*force, *(moment + np.cross(poses[k, :3], force))]
    np.testing.assert_allclose(_of("base_wrench"), total, atol=1e-12)
    whole, weight = sum(link.mass for link in _TREE.links), np.array(_TREE.gravity)
    np.testing.assert_allclose(_of("base_wrench")[:3], whole * (_of("mass_centre_acceleration") - weight), atol=1e-12)


def test_energies_and_rates() -> None:
    assert _of("mechanical_energy") == pytest.approx(_of("kinetic_energy") + _of("potential_energy"))
    np.testing.assert_array_equal(_of("speeds_of_rates"), _STATE.v)
    driven = replace(_STATE, a=_of("forward_dynamics"))
    np.testing.assert_allclose(_of("link_accelerations_driven"), _of("link_accelerations", driven), atol=1e-11)
    np.testing.assert_array_equal(_of("coordinate_rates"), _STATE.v)
    assert _of("squared_distance")[0] == pytest.approx(_STATE.v2 @ _STATE.v2)


def test_poses_and_velocities_are_relative_to_the_first_link() -> None:
    poses = _of("link_poses")
    A, x = poses[0, 3:].reshape(3, 3), poses[0, :3]
    for pose, seen in zip(poses, _of("relative_poses"), strict=True):
        np.testing.assert_allclose(seen[:3], A.T @ (pose[:3] - x), atol=1e-13)
        np.testing.assert_allclose(seen[3:].reshape(3, 3), A.T @ pose[3:].reshape(3, 3), atol=1e-13)
    moved, velocities = _slope("relative_poses"), _of("relative_velocities")
    for k, seen in enumerate(_of("relative_poses")):
        spin = moved[k, 3:].reshape(3, 3) @ seen[3:].reshape(3, 3).T
        np.testing.assert_allclose(velocities[k], [*moved[k, :3], spin[2, 1], spin[0, 2], spin[1, 0]], atol=1e-8)
    np.testing.assert_allclose(_of("relative_jacobians") @ _STATE.v, velocities, atol=1e-12)
    gained = _of("relative_accelerations") - _of("relative_jacobians") @ _STATE.a
    np.testing.assert_allclose(gained, _slope("relative_jacobians") @ _STATE.v, atol=1e-8)


def test_all_of_them_are_asked_of_any_tree() -> None:
    assert not any(function.needs for function in CARRIED.values())


@pytest.mark.parametrize("frame", ["local", "aligned", "world"])
def test_a_placement_moves_what_it_carries(frame: str) -> None:
    """Along each axis of the frame before a joint: the difference that a small displacement of it makes."""
    regressor, poses = _of(f"placement_regressor_{frame}"), _of("link_poses")
    own = 1
    for axis, unit in enumerate(np.eye(3)):
        link = _TREE.links[own]
        first = link.joints[0]
        moved = np.array(first.p) + _SIZE * np.array(first.R) @ unit
        links = list(_TREE.links)
        links[own] = replace(link, joints=(replace(first, p=vector(moved)), *link.joints[1:]))
        tree = replace(_TREE, links=tuple(links))
        after = digits(Truth(tree, _LAYOUT).value(FUNCTIONS["link_poses"].truth, Point.of(_STATE)))
        shift = (after - poses)[:, :3] / _SIZE
        if frame == "local":
            shift = np.einsum("kji,kj->ki", poses[:, 3:].reshape(-1, 3, 3), shift)
        np.testing.assert_allclose(regressor[:, :3, 6 * own + axis], shift, atol=1e-8)
    carried = [bool(np.any(rows[:, 6 * own : 6 * own + 6])) for rows in regressor]
    assert carried[own] and not all(carried)


def test_weights_take_the_power_that_their_energy_gains() -> None:
    np.testing.assert_allclose(_of("stored_energy_rate"), [_of("gravity") @ _STATE.v], rtol=1e-12)
