"""Packed recordings: what the page restores is what was recorded, to the steps that are stated."""

from __future__ import annotations

import base64
from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symofros.studio.viewer.replays.connectivity import walk
from symofros.studio.viewer.replays.packing import TURN_STEP, packed
from tests.late import late
from tests.studio.viewer.replays.unpacking import decoded, unpacked

creation = late("trimesh.creation", "view")
zstandard, msgspec = late("zstandard", "view"), late("msgspec", "view")
STEP = 1e-4
Message = dict[str, Any]


def recording(messages: list[tuple[float, Message]], arrays: list[np.ndarray]) -> bytes:
    """A recording as viser's `StateSerializer.serialize` writes it."""
    data = [array.tobytes() for array in arrays]
    held = {
        "durationSeconds": 1.0,
        "viserVersion": "1.1",
        "messages": messages,
        "binaryBufferLengths": [*map(len, data)],
    }
    text = msgspec.msgpack.encode(held)
    whole = len(text).to_bytes(8, "little") + text
    for one in data:
        whole += bytes(-len(whole) % 8) + one
    frame: bytes = zstandard.ZstdCompressor().compress(whole)
    return len(whole).to_bytes(8, "little") + frame


def restored(messages: list[tuple[float, Message]], arrays: list[np.ndarray]) -> tuple[Message, list[bytes]]:
    return decoded(unpacked(base64.b64encode(packed(recording(messages, arrays), STEP)).decode()))


def mesh(faces: int, vertices: int, name: str = "m") -> Message:
    props = {
        "faces": {"__binary_index": faces, "dtype": "<u4"},
        "vertices": {"__binary_index": vertices, "dtype": "<f4"},
    }
    return {
        "type": "MeshMessage",
        "name": name,
        "props": {**props, "opacity": None, "scale": 1.0, "color": [1, 2, 300]},
    }


def triangles(found: Message, arrays: list[bytes], index: int = 0) -> np.ndarray:
    """Places of the corners of each triangle of a mesh, the triangles sorted, each from its least corner on."""
    props = found["messages"][index][1]["props"]
    faces = np.frombuffer(arrays[props["faces"]["__binary_index"]], "<u4").reshape(-1, 3)
    return placed(faces, np.frombuffer(arrays[props["vertices"]["__binary_index"]], "<f4").reshape(-1, 3))


def placed(faces: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    corners = vertices[faces]
    rows = [
        np.roll(three, -min(range(3), key=lambda k: three[k].tolist()), axis=0).ravel().tolist() for three in corners
    ]
    return np.array(sorted(rows))


def cap() -> Any:
    """The upper part of a ball, with an edge."""
    ball = creation.uv_sphere()
    ball.update_faces(ball.triangles_center[:, 2] > 0.1)
    ball.remove_unreferenced_vertices()
    return ball


@pytest.mark.parametrize(
    "shape",
    [
        pytest.param(lambda: creation.icosphere(subdivisions=2), id="closed"),
        pytest.param(lambda: creation.torus(1.0, 0.3, 12, 8), id="with a hole"),
        pytest.param(lambda: creation.cylinder(0.5, 1.0), id="with sharp edges"),
        pytest.param(cap, id="open"),
    ],
)
def test_a_mesh_keeps_its_triangles(shape: Callable[[], Any]) -> None:
    solid = shape()
    on_grid = np.rint(solid.vertices * 4096).astype("<f4") / np.float32(4096)
    off_grid = on_grid / np.float32(3.0)
    faces = solid.faces.astype("<u4")
    for vertices in (on_grid, off_grid):
        found = restored([(0.0, mesh(0, 1))], [faces, vertices])
        np.testing.assert_array_equal(triangles(*found), placed(faces, vertices))


@settings(deadline=None, max_examples=20)
@given(st.lists(st.lists(st.integers(0, 7), min_size=3, max_size=3, unique=True), min_size=1, max_size=30))
def test_any_triangles_are_restored(corners: list[list[int]]) -> None:
    """Surfaces that meet themselves, edges of many triangles, triangles stated twice, corners of none."""
    faces, vertices = np.array(corners, dtype="<u4"), (np.arange(24, dtype="<f4") ** 2 % 29).reshape(8, 3)
    found = restored([(0.0, mesh(0, 1))], [faces, vertices])
    np.testing.assert_array_equal(triangles(*found), placed(faces, vertices))


def test_a_walk_over_a_closed_surface_meets_each_corner_once() -> None:
    solid = creation.icosphere(subdivisions=3)
    path = walk(solid.faces, len(solid.vertices))
    assert sorted(path.order) == list(range(len(solid.vertices)))
    # All triangles but the first by one step each, and few of these refer to a corner by its number.
    assert len(path.steps) == len(solid.faces) + 2 and len(path.back) < 0.05 * len(solid.faces)
    # A corner lies nearer to what is said of it than the last corner does.
    places = solid.vertices[path.order]
    a, b, c = path.near[3:].T
    from_near = np.linalg.norm(places[3:] - (places[a] + places[b] - places[c]), axis=1)
    assert np.median(from_near) < 0.5 * np.median(np.linalg.norm(np.diff(places, axis=0), axis=1))


def test_sharp_edges_have_a_corner_for_each_side() -> None:
    """A box by eight corners gets 24; a ball stays as it is."""
    for solid, count in ((creation.box(), 24), (creation.icosphere(subdivisions=2), 162)):
        vertices = np.rint(solid.vertices * 4096).astype("<f4") / np.float32(4096)
        found, arrays = restored([(0.0, mesh(0, 1))], [solid.faces.astype("<u4"), vertices])
        assert len(arrays[found["messages"][0][1]["props"]["vertices"]["__binary_index"]]) == 12 * count


def test_poses_and_other_messages_keep_times_and_order(rng: np.random.Generator) -> None:
    messages: list[tuple[float, Message]] = [
        (0.0, {"type": "FrameMessage", "name": "näme", "visible": True, "n": 70000})
    ]
    for k in range(6):
        time, more = k / 30, {"owner": "", "type": "P", "bone_index": 3}
        messages.append((time, {"name": "a", "position": rng.normal(size=3).tolist(), **more}))
        if k != 3:  # A node that stays sends nothing.
            messages.append((time, {"name": "a", "wxyz": [*(0.5, -0.5), *rng.uniform(-1, 1, 2).tolist()], "type": "T"}))
        if k == 4:
            messages.append(
                (time, {"type": "Removed", "name": "b", "long": "x" * 70000, "empty": [], "f": 0.1, "m": -5})
            )
        messages.append((time, {"name": "b", "position": rng.normal(size=3).tolist(), "type": "P"}))
    messages.append((0.2, {"name": "once", "position": [1e-9, 2.0, -3.0], "type": "P"}))
    array = np.arange(5, dtype="|u1")
    for name in ("x", "y"):
        messages.append((0.25, {"type": "ArrowMessage", "name": name, "colors": {"__binary_index": 0, "dtype": "|u1"}}))
    found, arrays = restored(messages, [array])
    assert arrays == [array.tobytes()] and found["durationSeconds"] == 1.0 and found["viserVersion"] == "1.1"
    assert len(found["messages"]) == len(messages)
    for (time, stated), (at, got) in zip(messages, found["messages"], strict=True):
        assert at == pytest.approx(time, abs=1e-9) and list(got) != [] and got.keys() == stated.keys()
        for key, value in stated.items():
            step = 0.0 if stated["name"] == "once" else {"position": STEP, "wxyz": TURN_STEP}.get(key, 0.0)
            assert got[key] == (pytest.approx(value, abs=0.51 * step, rel=0.0) if step else value)
    assert import_module("json").dumps(found)  # Nothing in it but what is plain.
