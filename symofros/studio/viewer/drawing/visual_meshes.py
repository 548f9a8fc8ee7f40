"""How bodies look by their files: visual shapes as meshes, with colors of materials and pictures in their folder."""

from __future__ import annotations

import io
import logging
import warnings
from functools import lru_cache
from importlib import import_module
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.description import Visual, kind_of
from symofros.studio.viewer.drawing.collada import read_collada
from symofros.studio.viewer.drawing.decimation import clustered
from symofros.studio.viewer.drawing.meshes import Colors, Mesh, box, cylinder, merged, sphere

MOST_COLORS = 32  # Of one mesh: each is drawn as a mesh of its own.
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
        is_buffer = path.suffix == ".bin"  # Numbers of glTF.
        if len(data) > self.bytes_left or not (is_buffer or _is_harmless(data)):
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


MAX_BYTES = 64 << 20
MAX_FACES = 500_000
GLTF = (".glb", ".gltf")
SUFFIXES = (".stl", ".obj", ".dae", ".ply", ".off", *GLTF)
# From the axes of glTF, y up (section 3.4 of its specification), to those of descriptions, z up, as RViz and Drake do.
_R_DESCRIBED_GLTF = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


def visual_mesh(visual: Visual) -> Mesh | None:
    """A shape in its own frame; None, with a warning, for a mesh that can't be read."""
    mesh = _shape(visual)
    if mesh is not None and visual.checker is not None:
        center, axes = _principal_frame(mesh) if visual.kind == "mesh" else (np.zeros(3), np.eye(3))
        return _checkered(mesh, center, axes, (visual.color or visual.checker, visual.checker))
    return mesh if mesh is None or not visual.picture else _painted(mesh, visual)


def _principal_frame(mesh: Mesh) -> tuple[Array, Array]:
    """Center of mass (3) and principal axes, rows (3, 3), right-handed, of the largest moment first: MuJoCo's for it.

    The frame of the file where the mesh has no volume.
    """
    with np.errstate(all="ignore"):
        matter = import_module("trimesh.triangles").mass_properties(mesh.vertices[mesh.faces])
    if not np.all(np.isfinite([*matter["center_mass"], *np.ravel(matter["inertia"])])):
        return np.zeros(3), np.eye(3)
    _, columns = np.linalg.eigh(-np.sign(matter["volume"]) * np.asarray(matter["inertia"]))
    axes: Array = columns.T * np.linalg.det(columns)
    return np.asarray(matter["center_mass"]), axes


def _checkered(
    mesh: Mesh, center: Array, axes: Array, colors: tuple[tuple[int, int, int], tuple[int, int, int]]
) -> Mesh:
    """A shape cut at the planes of axes: the first color where x y z > 0 along them, as MuJoCo lays its checker."""
    cut = import_module("trimesh.intersections").slice_faces_plane
    octants = []
    for signs in product((1.0, -1.0), repeat=3):
        vertices, faces = mesh.vertices, mesh.faces
        for normal in np.array(signs)[:, None] * axes:
            vertices, faces, _ = cut(vertices, faces, normal, center)
        color = np.array(colors[0 if np.prod(signs) > 0.0 else 1], dtype=np.int16)
        octants.append(Mesh(vertices, faces.astype(np.int64), np.tile(color, (len(faces), 1))))
    return merged(octants)


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
        mesh = merged([_with_colors(surface) for surface in scene.dump()])
    except Exception as error:  # noqa: BLE001 - its readers raise whatever a bad file makes them stumble over.
        raise ValueError(f"not a {file.suffix} file: {error}") from None
    return mesh.transformed(np.zeros(3), _R_DESCRIBED_GLTF) if file.suffix.lower() in GLTF else mesh


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
