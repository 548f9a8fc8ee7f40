"""Pictures without a browser."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from reference_models import MODELS
from symofros.studio.viewer.drawing.drawing import Drawing, DrawnPart
from symofros.studio.viewer.drawing.layers import initial_layers
from symofros.studio.viewer.drawing.meshes import Mesh, box, sphere
from symofros.studio.viewer.drawing.poses import Mechanism, Posture
from symofros.studio.viewer.render.camera import Camera, picture_height, scale_bar
from symofros.studio.viewer.render.raster import picture

RED, BLUE = (255, 0, 0), (0, 0, 255)
CAMERA = Camera(np.array([0.0, -10.0, 0.0]), np.zeros(3), np.array([0.0, 0.0, 1.0]), float(np.radians(40.0)))
STILL = Posture(np.zeros((1, 3)), np.eye(3)[None], np.zeros(0))


def drawn(*shown: tuple[Mesh, tuple[int, int, int], str]) -> np.ndarray:
    """A picture (300, 400, 3) of meshes in the world."""
    parts = tuple(DrawnPart(f"{i}", kind, -1, mesh, color) for i, (mesh, color, kind) in enumerate(shown))
    drawing = Drawing("d", parts, (), (), (), np.zeros(3), 1.0, np.zeros(3), True)
    return picture(drawing, STILL, frozenset({"bodies", "inertias"}), CAMERA, 400, 300).astype(int)


def at(mesh: Mesh, *position: float) -> Mesh:
    return mesh.transformed(np.array(position), np.eye(3))


def reddish(image: np.ndarray) -> np.ndarray:
    return image[..., 0] - image[..., 2] > 60


def test_a_sphere_covers_its_disc() -> None:
    rows, columns = np.nonzero(reddish(drawn((sphere(1.0), RED, "bodies"))))
    # Half of 300 pixels is tan 20 degrees; the outline of a sphere is that of its tangents.
    radius = 150 / np.tan(np.radians(20)) * np.tan(np.arcsin(0.1))
    assert len(rows) == pytest.approx(np.pi * radius**2, rel=0.06)  # Of twelve sides and six rings.
    assert abs(rows.mean() - 149.5) < 0.6 and abs(columns.mean() - 199.5) < 0.6


@pytest.mark.parametrize("order", [1, -1])
def test_nearer_bodies_hide_farther_ones(order: int) -> None:
    near, far = (at(box(np.full(3, 0.6)), 0, -3, 0), RED, "bodies"), (box(np.full(3, 2.0)), BLUE, "bodies")
    image = drawn(*(near, far)[::order])
    assert reddish(image)[150, 200] and image[110, 160, 2] > image[110, 160, 0] + 60


def test_surfaces_that_cross_hide_each_other_where_they_should() -> None:
    """Two boxes turned through each other: a painter that sorts whole faces can't draw this."""
    turn = np.array([[np.cos(0.5), -np.sin(0.5), 0], [np.sin(0.5), np.cos(0.5), 0], [0, 0, 1.0]])
    flat = box(np.array([3.0, 0.1, 1.0]))
    image = drawn(
        (flat.transformed(np.zeros(3), turn), RED, "bodies"), (flat.transformed(np.zeros(3), turn.T), BLUE, "bodies")
    )
    red = reddish(image)[150]
    left, right = red[150:195], red[205:250]
    assert left.all() and not right.any()


def test_inertia_boxes_are_translucent() -> None:
    image = drawn((box(np.full(3, 0.6)), RED, "bodies"), (at(box(np.full(3, 1.5)), 0, -2, 0), BLUE, "inertias"))
    through, beside = image[150, 200], image[110, 160]
    assert through[0] > through[2] and beside[2] > beside[0] > 100


def test_x_is_right_and_z_is_up_in_pictures_and_bodies_behind_the_camera_are_hidden() -> None:
    rows, columns = np.nonzero(reddish(drawn((at(box(np.full(3, 0.4)), 1.0, 0, 1.5), RED, "bodies"))))
    assert rows.mean() < 130 and columns.mean() > 220
    assert np.all(drawn((at(box(np.full(3, 1.0)), 0, -20, 0), RED, "bodies")) == 255)


@cache
def robot() -> tuple[Mechanism, Drawing]:
    mechanism = Mechanism(MODELS["planar_robot"])
    return mechanism, mechanism.drawing()


def robot_picture(bend: float, exaggeration: float, layers: frozenset[str] | None = None) -> np.ndarray:
    mechanism, drawing = robot()
    q = mechanism.model.neutral()
    q[mechanism.model.names.q.index("link1.bend_y[2]")] = bend
    posture = mechanism.posture(q, exaggeration=exaggeration)
    shown = initial_layers(drawing) if layers is None else layers
    return picture(drawing, posture, shown, Camera.of(drawing), 400, 300).astype(int)


def test_the_picture_changes_where_a_beam_bends_and_nowhere_else() -> None:
    straight, bent = robot_picture(0.0, 10.0), robot_picture(0.02, 10.0)
    changed = np.abs(bent - straight).max(axis=2) > 20
    counterweight = reference(straight)
    assert changed.sum() > 300 and not changed[counterweight].any()


def reference(image: np.ndarray) -> tuple[slice, slice]:
    """The pixels of the robot's counterweight, which stands left of the first axis and does not bend."""
    columns = np.nonzero((image < 240).any(axis=2)[100:200].any(axis=0))[0]
    return slice(0, 300), slice(0, int(columns[0]) + 10)


def test_layers_are_shown_or_not() -> None:
    everything = robot_picture(0.0, 1.0)
    without = robot_picture(0.0, 1.0, frozenset({"bodies"}))
    assert np.all(robot_picture(0.0, 1.0, frozenset()) == 255)
    assert (without < 250).any() and (without < 250).sum() < (everything < 250).sum()
    # Gravity is drawn where there is some.
    mechanism, drawing = robot()
    posture, camera = mechanism.posture(mechanism.model.neutral()), Camera.of(drawing)
    shown = (drawing, replace(drawing, gravity=np.zeros(3)))
    images = [picture(one, posture, frozenset({"ground"}), camera, 200, 150) for one in shown]
    colored = [(image.max(axis=2).astype(int) - image.min(axis=2)).max() for image in images]
    assert colored[0] > 60 and colored[1] < 5


@pytest.mark.parametrize(
    ("height", "length", "text"),
    [
        (1.4, 0.2, "20 cm"),
        (10.0, 2.0, "2 m"),
        (17.0, 5.0, "5 m"),
        (0.0034, 0.001, "1 mm"),
        (0.0033, 0.0005, "500 µm"),
        (0.04, 0.01, "1 cm"),
        (9000.0, 2000.0, "2 km"),
    ],
)
def test_a_bar_has_a_round_length_and_takes_that_much_of_the_picture(height: float, length: float, text: str) -> None:
    bar = scale_bar(height)
    assert bar.text == text and bar.length == pytest.approx(length, rel=1e-12)
    assert bar.share == pytest.approx(length / height, rel=1e-12) and 0.3 / 2.5 < bar.share <= 0.3


def test_the_scale_bar_has_its_length_at_the_distance_of_the_target() -> None:
    """Two points at the target, a bar's length apart across the picture, are that many pixels apart (pinhole)."""
    camera = Camera.of(Mechanism(MODELS["planar_robot"]).drawing())
    height = picture_height(camera.position, camera.target, camera.fov)
    bar, pixels = scale_bar(height), 480
    focus = pixels / 2 / np.tan(camera.fov / 2)
    ends = [camera.target, camera.target + bar.length * camera.axes[0]]
    seen = [camera.axes @ (end - camera.position) for end in ends]
    apart = focus * np.linalg.norm(seen[1][:2] / seen[1][2] - seen[0][:2] / seen[0][2])
    assert apart == pytest.approx(bar.share * pixels, rel=1e-9)
