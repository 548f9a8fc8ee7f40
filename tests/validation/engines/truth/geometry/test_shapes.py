"""Truths of solids: distances by minimising, rays by inside and outside, moments by sums over points."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import minimize

from validation.engines.functions.shapes import SHAPES
from validation.engines.interface import Slot, State
from validation.engines.matrix import cells
from validation.engines.models import single
from validation.engines.plugins import OWN
from validation.engines.plugins.mujoco import rays
from validation.engines.proving.pieces import Layout
from validation.engines.truth.dynamics import Point, Truth, digits, random_state
from validation.engines.truth.geometry.poses import MASS
from validation.engines.truth.geometry.shapes import BEYOND, DISTANCES, HALF, MET, NEAR_FACE, RADIUS, SIDES, WITHIN

Array = NDArray[np.float64]
_TURNS = single.trees()["rotations"]
_LAYOUT = Layout(4, 3, ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),))
_STATES = tuple(random_state(_TURNS, _LAYOUT, seed) for seed in range(2, 6))
_OF_LINE = np.array([0.0, 0.0, HALF])


def _of(name: str, state: State) -> Array:
    return digits(Truth(_TURNS, _LAYOUT).value(SHAPES[name].truth, Point.of(state)))


def _rotation(q: Array) -> Array:
    w, *u = q
    S = np.cross(np.eye(3), u)  # Row k is e_k x u, which is column k of the matrix of -u x: S = [u x].
    return np.asarray(np.eye(3) + 2 * w * S + 2 * S @ S)


def _is_inside(solid: str, x: Array) -> bool:
    level = np.hypot(x[0], x[1])
    along = np.clip(x[2], -HALF, HALF)
    return bool(
        {
            "ball": x @ x <= RADIUS**2,
            "box": np.all(np.abs(x) <= SIDES),
            "capsule": level**2 + (x[2] - along) ** 2 <= RADIUS**2,
            "cylinder": level <= RADIUS and abs(x[2]) <= HALF,
            "ellipsoid": np.sum((x / SIDES) ** 2) <= 1,
        }[solid]
    )


# Point of a solid by parameters in [-1, 1]; of what is rounded, of the ball's middle or the capsule's axis.
_POINTS: dict[str, Callable[[Array], Array]] = {
    "ball": lambda x: 0 * x,
    "capsule": lambda x: x[2] * _OF_LINE,
    "box": lambda x: np.array(SIDES) * x,
}


@pytest.mark.parametrize("pair", [pair for pair in DISTANCES if "cylinder" not in pair])
@pytest.mark.parametrize("state", _STATES[:2])
def test_distances_are_the_least_of_their_points(pair: tuple[str, str], state: State) -> None:
    one, other = (_POINTS[solid] for solid in pair)
    R, Q = _rotation(state.q), _rotation(state.q2)

    def square(x: Array) -> float:
        apart = state.a + R @ one(x[:3]) - state.tau - BEYOND - Q @ other(x[3:])
        return float(apart @ apart)

    rounds = RADIUS * sum(solid != "box" for solid in pair)
    least = minimize(square, np.zeros(6), bounds=[(-1, 1)] * 6, options={"ftol": 1e-15, "gtol": 1e-10})
    assert np.sqrt(least.fun) - rounds == pytest.approx(_of("_".join(("distance", *pair)), state)[0], abs=1e-7)


@pytest.mark.parametrize("state", _STATES)
def test_balls_touch_cylinders_once_they_have_grown_by_the_distance(state: State) -> None:
    R, distance = _rotation(state.q2), _of("distance_ball_cylinder", state)[0]
    x = R.T @ (state.a - state.tau - BEYOND)
    nearest = np.array([*(x[:2] * min(1.0, RADIUS / np.hypot(*x[:2]))), np.clip(x[2], -HALF, HALF)])
    assert np.linalg.norm(x - nearest) == pytest.approx(distance + RADIUS, abs=1e-12)


def test_a_ball_leaves_a_box_by_the_nearest_face() -> None:
    faces = np.array(SIDES) - np.abs(NEAR_FACE)
    assert _of("distance_ball_in_box", _STATES[0])[0] == -(np.min(faces) + RADIUS)


@pytest.mark.parametrize("solid", MET)
@pytest.mark.parametrize("state", _STATES)
def test_rays_enter_and_leave_once(solid: str, state: State) -> None:
    R = _rotation(state.q)
    origin = R.T @ (state.tau + BEYOND - state.a)
    way = np.array(WITHIN) - origin
    length, u = np.linalg.norm(way), way / np.linalg.norm(way)
    entering, leaving = _of(f"ray_to_{solid}", state)[0], length + _of(f"ray_out_of_{solid}", state)[0]
    assert not _is_inside(solid, origin + (entering - 1e-9) * u)
    assert not _is_inside(solid, origin + (leaving + 1e-9) * u)
    inside = np.linspace(entering + 1e-9, leaving - 1e-9, 50)
    assert all(_is_inside(solid, origin + far * u) for far in inside)


@pytest.mark.parametrize("solid", ["ball", "ellipsoid"])
def test_normals_are_of_the_steepest_growth(solid: str) -> None:
    state, step = _STATES[0], 1e-6
    R, weights = _rotation(state.q), 1 / np.array(SIDES) ** 2 if solid == "ellipsoid" else np.ones(3)
    origin = state.tau + BEYOND
    way = state.a + R @ WITHIN - origin
    met = origin + way / np.linalg.norm(way) * _of(f"ray_to_{solid}", state)[0]

    def level(x: Array) -> float:
        return float(weights @ (R.T @ (x - state.a)) ** 2)

    slope = np.array([level(met + step * unit) - level(met - step * unit) for unit in np.eye(3)])
    np.testing.assert_allclose(_of(f"ray_normal_{solid}", state), slope / np.linalg.norm(slope), atol=1e-8)


@pytest.mark.parametrize("solid", ["box", "ellipsoid", "ball", "cylinder", "capsule"])
def test_moments_are_sums_over_points(solid: str) -> None:
    state = _STATES[0]
    sizes = np.abs(state.v) + 0.5
    reach = sizes if solid in ("box", "ellipsoid") else np.array([sizes[0], sizes[0], max(sizes[0], sum(sizes[:2]))])
    line = (np.arange(64) + 0.5) / 32 - 1
    x = np.stack(np.meshgrid(line, line, line), axis=-1).reshape(-1, 3) * reach
    level = np.hypot(x[:, 0], x[:, 1])
    inside = {
        "box": np.all(np.abs(x) <= sizes / 2, axis=1),
        "ellipsoid": np.sum((x / sizes) ** 2, axis=1) <= 1,
        "ball": np.sum(x**2, axis=1) <= sizes[0] ** 2,
        "cylinder": (level <= sizes[0]) & (np.abs(x[:, 2]) <= sizes[1] / 2),
        "capsule": level**2 + np.maximum(np.abs(x[:, 2]) - sizes[1] / 2, 0) ** 2 <= sizes[0] ** 2,
    }[solid]
    squares = np.mean(x[inside] ** 2, axis=0)
    # Surfaces cut through cells of 1/32 of the reach, which is up to four times a size.
    np.testing.assert_allclose(_of(f"moments_{solid}", state), MASS * (sum(squares) - squares), rtol=2e-2)


def test_principal_moments_and_those_of_a_shell() -> None:
    state = _STATES[0]
    np.testing.assert_allclose(_of("principal_moments", state), np.sort(1 + state.v**2 / (1 + state.v**2)), rtol=1e-15)
    np.testing.assert_allclose(_of("moments_shell", state), MASS * 2 / 3 * (abs(state.v[0]) + 0.5) ** 2, rtol=1e-15)


def test_mujocos_rays_meet_boxes_of_triangles_skins_and_heights() -> None:
    pytest.importorskip("mujoco")
    tree = single.trees()["rotations"]
    verdicts = {cell.function: cell.verdict for cell in cells(OWN["mujoco"], tree, tuple(rays.WAYS))}
    assert set(verdicts.values()) == {"right"} and len(verdicts) == 7
