"""Cameras that go along with a body."""

from __future__ import annotations

from contextlib import nullcontext
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.errors import UnknownNameError
from symofros.studio.viewer.page.camera_follow import CameraFollow


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
