"""What the camera of the page shows, while one page looks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from symofros.studio.viewer.render.scale_bar import picture_height

_CHANGE = 1e-3  # Of the height, that is worth saying.


class CameraWatch:
    """Tells how large a picture is at the depth of its camera's target, when that changes.

    Each page has a camera of its own: while several look, or none, there is no one answer.

    Args:
        server: Server of viser.
        on_zoom: Called with the height [m], or None; in a thread of the server.
    """

    def __init__(self, server: Any, on_zoom: Callable[[float | None], None]) -> None:
        self._server, self._on_zoom = server, on_zoom
        self._reported: float | None = None
        server.on_client_connect(self._attend)
        server.on_client_disconnect(lambda _: self._report())

    @property
    def height(self) -> float | None:
        """Height of the picture at the depth of its target [m]; None while there is not one page."""
        cameras = [client.camera for client in self._server.get_clients().values()]
        if len(cameras) != 1:
            return None
        return picture_height(cameras[0].position, cameras[0].look_at, cameras[0].fov)

    def _attend(self, client: Any) -> None:
        client.camera.on_update(lambda _: self._report())
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
