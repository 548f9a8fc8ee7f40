"""Cameras of pages: what one shows while one page looks, and those that go along with a body."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from contextlib import suppress
from threading import Timer
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.studio.viewer.render.camera import picture_height

_STEP = 1e-3  # Of the mechanism's size, by which a body moves before cameras do: viser passes over smaller moves.


class CameraFollow:
    """Carries the cameras of all pages by as much as a body moves; how they are turned and how near they are stays.

    Args:
        server: Server of viser.
        body: Body that they follow.
        link: Index of its link.
        start: Where the body is (3) [m].
    """

    def __init__(self, server: Any, body: str, link: int, start: Array) -> None:
        self.body, self.link = body, link
        self._server, self._at = server, start

    def move(self, position: Array, size: float) -> None:
        """Go along with the body, which is now at a position (3) [m] of a mechanism of this size [m]."""
        shift = position - self._at
        if np.linalg.norm(shift) < _STEP * size:
            return
        self._at = position
        for page in self._server.get_clients().values():
            with suppress(AssertionError), page.atomic():  # Viser asserts that a page has reported its camera.
                page.camera.position = page.camera.position + shift


_CHANGE = 1e-3  # Of the height, that is worth saying.
_PLACED = 1e-2  # Of the height that a page begins with: its camera stands where it was put.
_PLACING = 2.0  # Seconds after which the camera of a page that began elsewhere counts as placed.


class CameraWatch:
    """Tells how large a picture is at the depth of its camera's target, when that changes.

    Each page has a camera of its own: while several look, or none, there is no one answer. A page's first messages are
    of a camera that it has not put to its place yet: nothing is said of that one.

    Args:
        server: Server of viser.
        on_zoom: Called with the height [m], or None; in a thread of the server.
    """

    def __init__(self, server: Any, on_zoom: Callable[[float | None], None]) -> None:
        self._server, self._on_zoom = server, on_zoom
        self._reported: float | None = None
        self._placed: set[int] = set()
        server.on_client_connect(self._attend)
        server.on_client_disconnect(self._leave)

    @property
    def height(self) -> float | None:
        """Height of the picture at the depth of its target [m]; None while there is not one page, its camera placed."""
        pages = self._server.get_clients()
        if len(pages) != 1 or not self._placed.issuperset(pages):
            return None
        return _height(next(iter(pages.values())).camera)

    def _attend(self, client: Any) -> None:
        client.camera.on_update(lambda _: self._follow(client))
        last = Timer(_PLACING, self._place, (client,))
        last.daemon = True
        last.start()
        self._follow(client)

    def _leave(self, client: Any) -> None:
        """Let the next page begin where the camera of the one that closes was: a page that is loaded again keeps it."""
        if client.client_id in self._placed:
            self._placed.discard(client.client_id)
            left, initial = client.camera, self._server.initial_camera
            with warnings.catch_warnings():  # Viser tells the page that closes as well, and warns that it is closed.
                warnings.filterwarnings("ignore", "Queued a", UserWarning)
                initial.position, initial.look_at, initial.up = left.position, left.look_at, left.up_direction
        self._report()

    def _follow(self, client: Any) -> None:
        if client.client_id not in self._placed:
            first = _height(self._server.initial_camera)
            if abs(_height(client.camera) - first) > _PLACED * first:
                return
        self._place(client)

    def _place(self, client: Any) -> None:
        self._placed.add(client.client_id)
        self._report()

    def _report(self) -> None:
        height, known = self.height, self._reported
        if height is None or known is None:
            isnt_news = height is known
        else:
            isnt_news = abs(height - known) <= _CHANGE * known
        if not isnt_news:
            self._reported = height
            self._on_zoom(height)


def _height(camera: Any) -> float:
    return picture_height(camera.position, camera.look_at, camera.fov)
