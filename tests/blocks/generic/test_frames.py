"""Frames and orientations, against SciPy's Rotation and the models' own poses."""

from __future__ import annotations

import warnings
from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import symofros as sf
from reference_models import MODELS
from symofros.blocks import FrameTransform, Orientation, OrientationError, Transform
from symofros.blocks.generic.frames import transformed
from symofros.blocks.rotations import EULER
from symofros.diagrams.tensor import Tensor
from symofros.expr.graph import Graph
from tests.blocks.support import run, run_each

# Angles at which formulas lose digits: none, tiny, a right angle, half a turn and about it.
TURNS = np.array(
    [
        [0, 0, 0],
        [1e-9, 0, 0],
        [0, -1e-5, 1e-7],
        [np.pi / 2, 0, 0],
        [0, np.pi, 0],
        [0, 0, np.pi - 1e-7],
        [1.0, -2.0, 0.5],
        [0.3, 0.4, -2.5],
        [-1.2, 0.1, 0.2],
        [0, np.pi / 2, 0],
        [2.0, 1.0, 1.5],
    ]
)
ROTATIONS = Rotation.from_rotvec(TURNS)
FORMS = {
    "matrix": ROTATIONS.as_matrix(),
    "quaternion": -1.5 * ROTATIONS.as_quat(),  # Of any length and sign.
    "rotation_vector": TURNS,
    "axis_angle": np.hstack(
        [3 * TURNS + [[1.0, 0, 0]] * (TURNS == 0).all(1)[:, None], np.linalg.norm(TURNS, axis=1)[:, None]]
    ),
}

with (
    warnings.catch_warnings()
):  # SciPy tells of attitudes at which angles are not unique; they are among ours on purpose.
    warnings.simplefilter("ignore")
    FORMS |= {f"euler_{axes}": ROTATIONS.as_euler(axes.upper()) for axes in ("zyx", "xzx")}


def back(form: str, value: np.ndarray) -> np.ndarray:
    """Matrices of a form, by SciPy."""
    if form == "matrix":
        return value
    if form == "quaternion":
        return Rotation.from_quat(value).as_matrix()
    if form == "rotation_vector":
        return Rotation.from_rotvec(value).as_matrix()
    if form == "axis_angle":
        assert np.linalg.norm(value[:, :3], axis=1) == pytest.approx(1.0)
        return Rotation.from_rotvec(value[:, :3] * value[:, 3:]).as_matrix()
    return Rotation.from_euler(form[-3:].upper(), value).as_matrix()


# All go by way of the matrix: into it and out of it in every run.
@pytest.mark.parametrize("by_matrix", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_orientations_keep_accuracy_at_every_angle(by_matrix: bool) -> None:
    pairs = [pair for pair in product(FORMS, FORMS) if ("matrix" in pair) == by_matrix]
    blocks = [Orientation(name=f"{source}_to_{target}", source=source, target=target) for source, target in pairs]
    fed = [(block, {"u": FORMS[source]}) for block, (source, _) in zip(blocks, pairs, strict=True)]
    for (block, _), (source, target), outputs in zip(fed, pairs, run_each(fed), strict=True):
        # SciPy's Euler angles lose digits near their singular attitude: what is fed is what they say.
        expected = back(source, FORMS[source]) if "euler" in source else FORMS["matrix"]
        np.testing.assert_allclose(back(target, outputs["y"]), expected, atol=1e-14, err_msg=block.name)


@pytest.mark.parametrize("sequence", ["zyx", "xzx"])
def test_angles_near_a_singular_attitude_give_back_the_rotation(sequence: str) -> None:
    """Two of the angles are defined by rounding alone, and not compared between interpreter and C: the turn is."""
    turns = 10.0 ** np.arange(-16, -5)[:, None] * np.array([[1.0, -2.0, 3.0]])
    singular = Rotation.from_euler("ZYX", [0.3, np.pi / 2, 0]) if sequence == "zyx" else Rotation.from_euler("X", 0.3)
    R = (singular * Rotation.from_rotvec(turns)).as_matrix()
    block = Orientation(name="o", source="matrix", target=f"euler_{sequence}")
    angles = run(block, {"u": R}, compare=0.0)["y"]
    np.testing.assert_allclose(Rotation.from_euler(sequence.upper(), angles).as_matrix(), R, rtol=0, atol=1e-14)


@pytest.mark.slow
def test_all_sequences_of_euler_angles_match_scipy(rng: np.random.Generator) -> None:
    angles = rng.uniform(-3, 3, size=(20, 3))
    R = {sequence: Rotation.from_euler(sequence.upper(), angles) for sequence in EULER}
    to = [(Orientation(name=f"to_{s}", source=f"euler_{s}", target="matrix"), {"u": angles}) for s in EULER]
    out_of = [
        (Orientation(name=f"of_{s}", source="matrix", target=f"euler_{s}"), {"u": R[s].as_matrix()}) for s in EULER
    ]
    outputs = [each["y"] for each in run_each(to + out_of)]
    for sequence, matrix, found in zip(EULER, outputs[: len(to)], outputs[len(to) :], strict=True):
        np.testing.assert_allclose(matrix, R[sequence].as_matrix(), atol=1e-14, err_msg=sequence)
        np.testing.assert_allclose(found, R[sequence].as_euler(sequence.upper()), atol=1e-11, err_msg=sequence)


def test_quaternions_have_nonnegative_w_and_rotations_are_at_most_half_a_turn() -> None:
    found = run(Orientation(name="o", source="rotation_vector", target="quaternion"), {"u": 2.5 * TURNS})["y"]
    assert found[:, 3].min() >= 0.0
    vectors = run(Orientation(name="o", source="rotation_vector", target="rotation_vector"), {"u": 2.5 * TURNS})["y"]
    assert np.linalg.norm(vectors, axis=1).max() <= np.pi + 1e-12


@pytest.mark.parametrize("axes", ["world", "body"])
def test_the_orientation_error_turns_actual_into_desired(axes: str, rng: np.random.Generator) -> None:
    desired, actual = Rotation.random(9, random_state=1), Rotation.random(9, random_state=2)
    block = OrientationError(name="e", kind="quaternion", axes=axes)
    error = run(block, {"desired": desired.as_quat(), "actual": actual.as_quat()})["error"]
    expected = desired * actual.inv() if axes == "world" else actual.inv() * desired
    np.testing.assert_allclose(error, expected.as_rotvec(), atol=1e-13)


@pytest.mark.parametrize("quantity", ["point", "vector", "velocity", "wrench"])
def test_transforms_are_inverted_and_preserve_power(quantity: str, rng: np.random.Generator) -> None:
    p, R = rng.normal(size=(5, 3)), Rotation.random(5, random_state=3).as_matrix()
    u = rng.normal(size=(5, 3 if quantity in ("point", "vector") else 6))
    y = run(Transform(name="x", quantity=quantity), {"p": p, "R": R, "u": u})["y"]
    again = run(Transform(name="x", quantity=quantity, inverse=True), {"p": p, "R": R, "u": y})["y"]
    np.testing.assert_allclose(again, u, atol=1e-13)
    if quantity == "point":
        np.testing.assert_allclose(y, p + np.einsum("nij,nj->ni", R, u), atol=1e-14)
    if quantity == "wrench":
        # A wrench does the same power on a velocity, wherever both are seen from.
        V = rng.normal(size=(5, 6))
        W = run(Transform(name="x", quantity="velocity"), {"p": p, "R": R, "u": V})["y"]
        np.testing.assert_allclose((y * W).sum(1), (u * V).sum(1), atol=1e-13)
        # The moment about A's origin is that of the force at B's origin, and B's moment.
        np.testing.assert_allclose(y[:, 3:], np.einsum("nij,nj->ni", R, u[:, 3:]) + np.cross(p, y[:, :3]), atol=1e-14)


def test_frames_of_a_model_transform_vectors(rng: np.random.Generator) -> None:
    q = rng.normal(size=(4, 6))
    model = sf.compile(MODELS["rx90"])
    block = FrameTransform(name="x", model="m", source="tool", target="link3")
    u = rng.normal(size=(4, 3))
    found = run(block, {"q": q, "u": u}, models={"m": (MODELS["rx90"], {})})
    (p_s, R_s), (p_t, R_t) = model.frame_pose("tool", q), model.frame_pose("link3", q)
    np.testing.assert_allclose(found["R"], np.swapaxes(R_t, 1, 2) @ R_s, atol=1e-13)
    world = p_s + np.einsum("nij,nj->ni", R_s, u)
    np.testing.assert_allclose(p_t + np.einsum("nij,nj->ni", R_t, found["y"]), world, atol=1e-13)


def test_a_wrench_has_the_power_of_its_velocity_in_both_frames(rng: np.random.Generator) -> None:
    g, R, (p, F, M, v, w) = Graph(), Rotation.random(random_state=4).as_matrix(), rng.normal(size=(5, 3))

    def seen(quantity: str, u: np.ndarray) -> np.ndarray:
        found = transformed(quantity, *(Tensor.numbers(g, x) for x in (p, R, u)))
        return np.array([g.number(edge) for edge in found.flat], dtype=float)

    there, moving = seen("wrench", np.concatenate([F, M])), seen("velocity", np.concatenate([v, w]))
    assert there @ moving == pytest.approx(F @ v + M @ w, abs=1e-13)
    np.testing.assert_allclose(there, np.concatenate([R @ F, R @ M + np.cross(p, R @ F)]), atol=1e-14)
    np.testing.assert_allclose(moving, np.concatenate([R @ v + np.cross(p, R @ w), R @ w]), atol=1e-14)
    np.testing.assert_allclose(seen("point", F) - seen("vector", F), p, atol=1e-14)
