"""How bodies look by their files: visual shapes as meshes."""

from __future__ import annotations

import io
import logging
import warnings
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.description import Visual, kind_of
from symofros.studio.viewer.drawing.collada import read_collada
from symofros.studio.viewer.drawing.decimation import clustered
from symofros.studio.viewer.drawing.mesh_colors import FilesBeside, few_colors, leave_out_pictures, picture_at
from symofros.studio.viewer.drawing.meshes import Mesh, box, cylinder, merged, sphere

MAX_BYTES = 64 << 20
MAX_FACES = 500_000
SUFFIXES = (".stl", ".obj", ".dae", ".ply", ".off", ".glb")


def visual_mesh(visual: Visual) -> Mesh | None:
    """A shape in its own frame; None, with a warning, for a mesh that can't be read."""
    mesh = _shape(visual)
    return mesh if mesh is None or not visual.picture else _painted(mesh, visual)


def _painted(mesh: Mesh, visual: Visual) -> Mesh:
    """A shape in the colors of its picture; in its color, with a warning, where that can't be read."""
    color = np.array(visual.color or (255, 255, 255))
    try:
        pixels = np.asarray(picture_at(Path(visual.picture)))
        if visual.is_mapped and mesh.places is not None:
            height, width = pixels.shape[:2]
            across, up = (np.nan_to_num(mesh.places) % 1.0).T
            seen = pixels[((1.0 - up) * (height - 1)).astype(np.int64), (across * (width - 1)).astype(np.int64)]
        else:
            seen = pixels.reshape(-1, 3).mean(axis=0, keepdims=True)
        colors = few_colors(np.round(seen * color / 255.0))
    except (OSError, ImportError) as error:
        warnings.warn(f"view: picture '{Path(visual.picture).name}' is not drawn: {str(error)[:200]}", stacklevel=3)
        colors = color[None].astype(np.int16)
    return mesh._replace(colors=np.broadcast_to(colors, (len(mesh.faces), 3)))


def _shape(visual: Visual) -> Mesh | None:
    """A shape in its own frame, in the colors of its file."""
    size = np.array(visual.size)
    if visual.kind == "box":
        return box(size)
    if visual.kind == "sphere":
        return sphere(float(size[0]))
    if visual.kind == "ellipsoid":
        return _scaled(sphere(1.0), size)
    if visual.kind == "mesh":
        try:
            file = Path(visual.file)
            stated, note = _read(file, file.stat().st_mtime_ns)
            with np.errstate(all="ignore"):  # What overflows is not finite, and refused as such.
                mesh = _scaled(stated, size)
            if not np.all(np.isfinite(mesh.vertices)):
                raise ValueError(f"corners beyond all numbers at a scale of {size}")
            if note:
                warnings.warn(f"view: mesh '{file.name}' is drawn coarser: {note}", stacklevel=3)
            return mesh
        except (OSError, ValueError) as error:
            warnings.warn(f"view: mesh '{Path(visual.file).name}' is not drawn: {str(error)[:200]}", stacklevel=3)
            return None
    radius, half = float(size[0]), np.array([0.0, 0.0, size[1] / 2])
    tube = cylinder(-half, half, radius)
    if visual.kind == "cylinder":
        return tube
    ball = sphere(radius)
    return merged([tube, ball.transformed(half, np.eye(3)), ball.transformed(-half, np.eye(3))])


def _scaled(mesh: Mesh, factors: Array) -> Mesh:
    """Seen from outside also where it is mirrored."""
    faces = mesh.faces if np.prod(factors) > 0.0 else mesh.faces[:, ::-1]
    return mesh._replace(vertices=mesh.vertices * factors, faces=faces)


@lru_cache(maxsize=256)
def _read(file: Path, changed: int) -> tuple[Mesh, str]:  # A file that was changed since is read again.
    """A mesh's file, and in words how it is drawn coarser than it is; "" if it is not.

    Raises:
        OSError: It can't be read.
        ValueError: It is no mesh of SUFFIXES, or too large; or trimesh is not installed.
    """
    if file.suffix.lower() not in SUFFIXES:
        raise ValueError(f"{file.suffix or 'no suffix'} is none of {', '.join(SUFFIXES)}; convert it")
    if not file.is_file():  # A pipe would be waited for, a device has no end.
        raise ValueError(f"{kind_of(file)}; a mesh is a regular file")
    with file.open("rb") as stream:
        data = stream.read(MAX_BYTES + 1)
    if len(data) > MAX_BYTES:
        raise ValueError(f"more than {MAX_BYTES} bytes")
    mesh = read_collada(data, MAX_FACES) if file.suffix.lower() == ".dae" else _loaded(file, data)
    vertices, faces = mesh.vertices, mesh.faces
    if not len(faces) or not np.all(np.isfinite(vertices)):
        raise ValueError(f"{len(faces)} triangles; 1 or more with finite corners")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise ValueError("a triangle without a corner")
    if len(faces) <= MAX_FACES:
        return mesh, ""
    coarse, moved = clustered(mesh, MAX_FACES)
    if not len(coarse.faces):
        raise ValueError(f"{len(faces)} triangles, of which no {MAX_FACES} are left that show its shape")
    share = moved / float(np.ptp(vertices, axis=0).max())
    return coarse, f"{len(faces)} triangles by {len(coarse.faces)}, corners off by up to {share:.1%} of its length"


def _loaded(file: Path, data: bytes) -> Mesh:
    """The mesh in a file of any format but COLLADA, read by trimesh, with the colors that it states.

    Raises:
        ValueError: It is no such mesh, or trimesh is not installed.
    """
    try:
        trimesh = import_module("trimesh")
    except ImportError:
        raise ValueError("trimesh is not installed; pip install 'symofros[view]'") from None
    logging.getLogger("trimesh").addHandler(
        logging.NullHandler()
    )  # It writes tracebacks of what is raised here as well.
    kind = file.suffix.lower()[1:]
    try:
        # Of bytes: what the file refers to is opened by ours alone.
        beside = FilesBeside(file.parent)
        scene = trimesh.load_scene(io.BytesIO(data), file_type=kind, process=False, resolver=beside)
        leave_out_pictures(scene)
        return merged([_with_colors(surface) for surface in scene.dump()])
    except Exception as error:  # noqa: BLE001 - its readers raise whatever a bad file makes them stumble over.
        raise ValueError(f"not a {file.suffix} file: {error}") from None


def _with_colors(surface: Any) -> Mesh:
    """A surface of trimesh's with the color of each face: its own, the mean of its corners', its picture's amid it."""
    vertices = np.array(surface.vertices, dtype=np.float64).reshape(-1, 3)
    faces = np.array(surface.faces, dtype=np.int64).reshape(-1, 3)
    look = surface.visual
    if look.kind is None or not len(faces):
        return Mesh(vertices, faces)
    if look.kind != "texture":
        return Mesh(vertices, faces, few_colors(np.asarray(look.face_colors)[:, :3]))
    places = None if look.uv is None else np.asarray(look.uv, dtype=np.float64)[faces].mean(axis=1)
    if hash(look.material) == hash(import_module("trimesh.visual.material").empty_material()):
        return Mesh(vertices, faces, places=places)  # It has places in a picture, which is not there.
    colors = np.tile(look.material.main_color, (len(faces), 1))
    if places is not None and getattr(look.material, "image", None) is not None:
        colors = look.material.to_color(places)
    elif places is not None and getattr(look.material, "baseColorTexture", None) is not None:
        shares = colors / 255.0 if look.material.baseColorFactor is not None else 1.0  # Both count, as in glTF.
        colors = np.rint(look.material.to_color(places) * shares).astype(np.uint8)
    return Mesh(vertices, faces, few_colors(np.asarray(colors)[:, :3]), places)
