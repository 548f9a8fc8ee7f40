"""Reports of the camera: nothing until the page has put it to its place, nothing of several pages."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import nullcontext
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.errors import UnknownNameError
from symofros.studio.viewer.page import cameras
from symofros.studio.viewer.page.cameras import CameraFollow, CameraWatch

FOV = np.pi / 2


def camera(distance: float) -> SimpleNamespace:
    """A camera that shows twice its distance from the origin."""
    callbacks: list[Callable[[Any], None]] = []
    return SimpleNamespace(
        position=np.array([distance, 0, 0]),
        look_at=np.zeros(3),
        up_direction=np.array([0.0, 0.0, 1.0]),
        up=None,
        fov=FOV,
        callbacks=callbacks,
        on_update=callbacks.append,
    )


class Pages:
    """What the watch asks of a server."""

    def __init__(self) -> None:
        self.initial_camera = camera(2.0)
        self.clients: dict[int, Any] = {}
        self.heights: list[float | None] = []

    def on_client_connect(self, act: Callable[[Any], None]) -> None:
        self.connect = act

    def on_client_disconnect(self, act: Callable[[Any], None]) -> None:
        self.disconnect = act

    def get_clients(self) -> dict[int, Any]:
        return dict(self.clients)

    def open(self, number: int, distance: float) -> Any:
        self.clients[number] = SimpleNamespace(client_id=number, camera=camera(distance))
        self.connect(self.clients[number])
        return self.clients[number]

    def move(self, page: Any, distance: float) -> None:
        page.camera.position = np.array([distance, 0, 0])
        for act in page.camera.callbacks:
            act(None)


@pytest.fixture
def pages() -> Pages:
    return Pages()


def test_a_camera_before_its_placement_is_not_reported(pages: Pages) -> None:
    watch = CameraWatch(pages, pages.heights.append)
    page = pages.open(1, 5.0)
    assert watch.height is None and pages.heights == []
    pages.move(page, 2.0)
    pages.move(page, 3.0)
    assert pages.heights == pytest.approx([4.0, 6.0]) and watch.height == pytest.approx(6.0)


def test_a_page_that_starts_elsewhere_is_reported_after_a_delay(pages: Pages, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cameras, "_PLACING", 0.01)
    CameraWatch(pages, pages.heights.append)
    pages.open(1, 5.0)
    end = time.monotonic() + 10
    while not pages.heights and time.monotonic() < end:
        time.sleep(0.01)
    assert pages.heights == pytest.approx([10.0])


def test_two_pages_have_no_common_view_height(pages: Pages) -> None:
    watch = CameraWatch(pages, pages.heights.append)
    pages.open(1, 2.0)
    pages.open(2, 2.0)
    assert watch.height is None and pages.heights == [pytest.approx(4.0), None]
    pages.disconnect(pages.clients.pop(1))
    assert watch.height == pytest.approx(4.0) and pages.heights[2:] == pytest.approx([4.0])


def test_a_page_begins_where_the_camera_of_the_last_one_was(pages: Pages) -> None:
    CameraWatch(pages, pages.heights.append)
    page = pages.open(1, 2.0)
    pages.move(page, 7.0)
    pages.disconnect(pages.clients.pop(1))
    np.testing.assert_array_equal(pages.initial_camera.position, [7.0, 0.0, 0.0])
    np.testing.assert_array_equal(pages.initial_camera.up, [0.0, 0.0, 1.0])
    pages.disconnect(pages.clients.setdefault(2, SimpleNamespace(client_id=2, camera=camera(3.0))))
    np.testing.assert_array_equal(pages.initial_camera.position, [7.0, 0.0, 0.0])  # That one was never placed.


class Camera:
    """A page that has reported its camera, or has not."""

    def __init__(self, position: np.ndarray | None) -> None:
        self._position = position

    @property
    def position(self) -> Any:
        assert self._position is not None
        return self._position

    @position.setter
    def position(self, position: np.ndarray) -> None:
        self._position = position


def test_cameras_go_along_by_what_the_body_moves() -> None:
    cameras = [Camera(np.array([1.0, 2.0, 3.0])), Camera(None), Camera(np.zeros(3))]
    pages = {i: SimpleNamespace(camera=camera, atomic=nullcontext) for i, camera in enumerate(cameras)}
    follow = CameraFollow(SimpleNamespace(get_clients=lambda: pages), "arm", 0, np.ones(3))
    for k in range(1, 101):  # Steps that viser would pass over add up.
        follow.move(np.array([1.0 + 1e-4 * k, 1.0, 1.0]), 1.0)
    np.testing.assert_allclose(cameras[0].position, [1.01, 2.0, 3.0], atol=1.1e-3)
    cameras[2].position = np.array([5.0, 0.0, 0.0])  # A reader turns the picture meanwhile.
    follow.move(np.array([2.01, 1.0, 1.0]), 1.0)
    np.testing.assert_allclose(cameras[2].position, [6.0, 0.0, 0.0], atol=1.1e-3)


def test_a_body_is_chosen_by_its_name() -> None:
    t = np.linspace(0.0, 1.0, 5)
    with sf.Viewer(MODELS["planar_robot"], port=0) as viewer:
        viewer.play((t, t[:, None] * np.ones(10)))
        viewer.toggle()
        with pytest.raises(UnknownNameError, match=r"no body 'arm3' to follow(.*\n)*  remedy: use one of: motor1"):
            viewer.follow("arm3")
        viewer.seek(0.0)
        body = viewer.mechanism.tree.links[-1].name
        viewer.follow(body)
        page = SimpleNamespace(camera=Camera(np.zeros(3)), atomic=nullcontext)
        viewer._server.get_clients = lambda: {0: page}
        before = viewer._scene_state.posture.p[-2]
        viewer.seek(1.0)
        np.testing.assert_allclose(page.camera.position, viewer._scene_state.posture.p[-2] - before)
        assert np.linalg.norm(page.camera.position) > 0.1 and viewer._panel._followed.value == body
        viewer.follow(None)
        viewer.seek(0.0)
        assert np.linalg.norm(page.camera.position) > 0.1
        viewer.follow(body)
        viewer.set_system(MODELS["four_bar"])
        assert viewer._panel._followed.value == "no body"
