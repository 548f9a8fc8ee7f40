"""Cameras of pages that go along with a body."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np

from symofros.base.arrays import Array

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
