"""Colors of meshes whose files refer to others: materials and pictures in the folder of a file, few of many colors."""

from __future__ import annotations

import io
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from symofros.studio.viewer.drawing.meshes import Colors

MOST_COLORS = 32  # Of one mesh: each is drawn as a mesh of its own.
MAX_BYTES = 64 << 20  # Of all files that one mesh refers to.
MAX_FILES = 64
MAX_PIXELS = 1 << 24
_NOT_DRAWN = ("emissiveTexture", "metallicRoughnessTexture", "normalTexture", "occlusionTexture")
_PICTURES = (b"\x89PNG\r\n", b"\xff\xd8\xff")  # What PNG and JPEG files begin with.


class FilesBeside:
    """The files that a mesh may refer to, as trimesh's loaders ask for them: its folder's, and those below.

    Args:
        folder: Folder of the mesh.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder.resolve()
        self.bytes_left, self.files_left = MAX_BYTES, MAX_FILES

    def get(self, name: str) -> bytes:
        """The content of a file.

        Raises:
            OSError: There is none, it lies elsewhere, or it is too large.
        """
        path = (self.folder / name.replace("\\", "/")).resolve()
        if not path.is_relative_to(self.folder) or not path.is_file() or self.files_left == 0:
            raise OSError(f"{name:.80} is not read")
        self.files_left -= 1
        with path.open("rb") as stream:
            data = stream.read(self.bytes_left + 1)
        if len(data) > self.bytes_left or not _is_harmless(data):
            raise OSError(f"{name:.80} is too large, or a picture that is neither PNG nor JPEG")
        self.bytes_left -= len(data)
        return data

    __getitem__ = get


def leave_out_pictures(scene: Any) -> None:
    """Leave out the pictures within a file (glTF) that are not drawn, or too large to be unpacked, before they are."""
    for surface in scene.geometry.values():
        look = getattr(surface.visual, "material", None)
        for name in ("baseColorTexture", *_NOT_DRAWN):
            picture = getattr(look, name, None)
            if picture is not None and (name in _NOT_DRAWN or not _is_small(picture)):
                setattr(look, name, None)


def _is_small(picture: Any) -> bool:
    """Whether a picture that is not unpacked yet is PNG or JPEG, of no more than MAX_PIXELS."""
    return picture.format in ("PNG", "JPEG") and picture.width * picture.height <= MAX_PIXELS


def picture_at(file: Path) -> Any:
    """A picture (PNG, JPEG), unpacked.

    Raises:
        OSError: It can't be read, or it is too large.
    """
    data = FilesBeside(file.parent).get(file.name)
    if not data.startswith(_PICTURES):
        raise OSError(f"{file.name:.80} is neither PNG nor JPEG")
    try:
        return _image_module().open(io.BytesIO(data), formats=("PNG", "JPEG")).convert("RGB")
    except Exception as error:  # noqa: BLE001 - its readers raise whatever a bad file makes them stumble over.
        raise OSError(f"{file.name:.80} is no picture: {error}") from None


def _is_harmless(data: bytes) -> bool:
    """Whether it is text, or a picture that is not too large when it is unpacked."""
    if not data.startswith(_PICTURES):
        return b"\0" not in data
    with _image_module().open(io.BytesIO(data), formats=("PNG", "JPEG")) as picture:
        width, height = picture.size
    return bool(width * height <= MAX_PIXELS)


def few_colors(colors: Any) -> Colors:
    """Colors (F, 3), 0 to 255, of which at most MOST_COLORS differ: those in the middle of many."""
    stated = np.ascontiguousarray(colors, dtype=np.uint8)
    if len(np.unique(stated, axis=0)) > MOST_COLORS:
        image = _image_module().fromarray(stated[None]).quantize(MOST_COLORS).convert("RGB")
        stated = np.asarray(image)[0]
    return stated.astype(np.int16)


def _image_module() -> Any:
    return import_module("PIL.Image")
