"""Reports of the camera: nothing until the page has put it to its place, nothing of several pages."""

from __future__ import annotations

import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from symofros.studio.viewer.page import camera_watch
from symofros.studio.viewer.page.camera_watch import CameraWatch

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
    monkeypatch.setattr(camera_watch, "_PLACING", 0.01)
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
