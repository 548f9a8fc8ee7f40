"""Colors of mesh files: of faces, corners, materials and pictures; and files that are not opened for them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from trimesh import Trimesh
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from symofros.description.visual import Visual
from symofros.studio.viewer.drawing import mesh_colors
from symofros.studio.viewer.drawing.mesh_colors import MOST_COLORS, FilesBeside, few_colors
from symofros.studio.viewer.drawing.visual_meshes import visual_mesh

RED, GREEN, BLUE = (255, 0, 0), (0, 255, 0), (0, 0, 255)
# A tetrahedron: two faces in green, two where the picture is red on the left and blue on the right.
OBJ = """mtllib look.mtl
v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0.1 0.5\nvt 0.9 0.5
usemtl plain\nf 1 3 2\nf 2 3 4\nusemtl pictured\nf 1/1 2/1 4/1\nf 1/2 4/2 3/2
"""
# The same with places for all of them, and no picture of its own; one lies beyond, where the picture is repeated.
PLACED = """v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0.1 0.5\nvt 0.8 0.5\nvt -0.2 7.5
f 1/1 3/1 2/1\nf 2/2 3/2 4/2\nf 1/1 2/1 4/1\nf 1/3 4/3 3/3
"""
PLY = """ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z
property uchar red\nproperty uchar green\nproperty uchar blue
element face 1\nproperty list uchar int vertex_indices\nend_header
0 0 0 0 255 0\n1 0 0 0 255 0\n0 1 0 0 255 0\n0 0 1 0 0 0\n3 0 1 2
"""


def written(folder: Path, picture: str = "picture.png", size: int = 4) -> Path:
    (folder / "part.obj").write_text(OBJ)
    (folder / "look.mtl").write_text(f"newmtl plain\nKd 0 1 0\nnewmtl pictured\nmap_Kd {picture}\n")
    pixels = np.zeros((size, size, 3), np.uint8)
    pixels[:, : size // 2], pixels[:, size // 2 :] = RED, BLUE
    (folder / picture).parent.mkdir(exist_ok=True)
    Image.fromarray(pixels).save(folder / picture)
    return folder / "part.obj"


def colors_of(file: Path) -> list[tuple[int, ...]]:
    """Colors of the faces by the alphabet; empty of a mesh that states none."""
    mesh = visual_mesh(Visual("mesh", (1.0, 1.0, 1.0), file=str(file)))
    assert mesh is not None and np.all(np.isfinite(mesh.vertices))
    return [] if mesh.colors is None else sorted(map(tuple, mesh.colors.tolist()))


@pytest.mark.parametrize("picture", ["picture.png", "pictures/a.png", "picture.bmp"])
def test_faces_have_the_colors_of_materials_and_pictures(picture: str, tmp_path: Path) -> None:
    found = colors_of(written(tmp_path, picture))
    if picture.endswith(".bmp"):  # Only PNG and JPEG are unpacked.
        assert found.count(GREEN) == 2 and RED not in found
    else:
        assert found == sorted([GREEN, GREEN, RED, BLUE])


def test_faces_have_the_colors_of_their_corners(tmp_path: Path) -> None:
    (tmp_path / "part.ply").write_text(PLY)
    assert colors_of(tmp_path / "part.ply") == [GREEN]


@pytest.mark.parametrize("stated", ["../look.mtl", "/etc/passwd", "gone.mtl", "link.mtl", "look\0.mtl"])
def test_materials_of_other_folders_leave_a_mesh_without_color(stated: str, tmp_path: Path) -> None:
    folder = tmp_path / "inside"
    folder.mkdir()
    file = written(folder)
    (folder / "look.mtl").rename(tmp_path / "look.mtl")
    (folder / "link.mtl").symlink_to(tmp_path / "look.mtl")
    file.write_text(OBJ.replace("look.mtl", stated))
    assert not colors_of(file)


def test_pictures_that_are_large_when_unpacked_are_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mesh_colors, "MAX_PIXELS", 15)
    assert RED not in colors_of(written(tmp_path))


def test_files_that_a_mesh_refers_to_are_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.mtl").write_text("x" * 60)
    monkeypatch.setattr(mesh_colors, "MAX_BYTES", 100)
    beside = FilesBeside(tmp_path)
    assert len(beside["a.mtl"]) == 60
    with pytest.raises(OSError, match="too large"):
        beside["a.mtl"]
    monkeypatch.setattr(mesh_colors, "MAX_FILES", 0)
    with pytest.raises(OSError, match="not read"):
        FilesBeside(tmp_path)["a.mtl"]


def test_of_many_colors_few_are_left() -> None:
    many = np.random.default_rng(0).integers(0, 256, (5000, 3))
    few = few_colors(many)
    assert len(np.unique(few, axis=0)) == MOST_COLORS and np.abs(few - many).mean() < 40
    assert few_colors(many[:5]).tolist() == many[:5].tolist()


def painted(visual: Visual) -> list[tuple[int, ...]]:
    mesh = visual_mesh(visual)
    assert mesh is not None and mesh.colors is not None and len(mesh.colors) == len(mesh.faces)
    return sorted(set(map(tuple, mesh.colors.tolist())))


def test_the_picture_of_a_description_goes_before_those_of_the_file(tmp_path: Path) -> None:
    part = written(tmp_path)
    part.write_text(PLACED)
    shape = Visual(
        "mesh", (1.0, 1.0, 1.0), color=(255, 255, 128), file=str(part), picture=str(tmp_path / "picture.png")
    )
    mean = (128, 0, 64)
    assert painted(shape) == [mean]
    assert painted(replace(shape, is_mapped=True)) == [(0, 0, 128), RED]
    assert painted(Visual("box", (1.0, 1.0, 1.0), picture=shape.picture, is_mapped=True)) == [(128, 0, 128)]


@pytest.mark.parametrize("content", [b"", b"\x89PNG\r\n\x1a\n" + bytes(40), b"text", None])
def test_invalid_pictures_leave_the_color(content: bytes | None, tmp_path: Path) -> None:
    file = tmp_path / "picture.png"
    if content is None:  # Too many pixels.
        Image.new("1", (mesh_colors.MAX_PIXELS // 1000, 1001)).save(file)
    else:
        file.write_bytes(content)
    with pytest.warns(UserWarning, match=r"picture 'picture\.png' is not drawn"):
        assert painted(Visual("box", (1.0, 1.0, 1.0), color=GREEN, picture=str(file))) == [GREEN]


@pytest.mark.parametrize("factor", [None, [128, 128, 128, 255]])
def test_faces_have_the_colors_of_pictures_within_the_file(
    factor: list[int] | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of .glb, whose pictures lie in it; a picture that is too large leaves the color of its material."""
    pixels = np.zeros((4, 4, 3), np.uint8)
    pixels[:, :2], pixels[:, 2:] = RED, BLUE
    look = PBRMaterial(baseColorTexture=Image.fromarray(pixels), baseColorFactor=factor)
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]], float)
    places = np.repeat([[0.1, 0.5], [0.9, 0.5]], 3, axis=0)
    surface = Trimesh(corners, [[0, 1, 2], [3, 4, 5]], process=False, visual=TextureVisuals(places, material=look))
    (tmp_path / "part.glb").write_bytes(surface.export(file_type="glb"))
    share = 1 if factor is None else 128 / 255
    assert colors_of(tmp_path / "part.glb") == sorted(tuple(round(x * share) for x in color) for color in (RED, BLUE))
    monkeypatch.setattr(mesh_colors, "MAX_PIXELS", 15)
    (tmp_path / "other.glb").write_bytes((tmp_path / "part.glb").read_bytes())
    assert set(colors_of(tmp_path / "other.glb")) == {tuple(factor[:3]) if factor else (102, 102, 102)}
