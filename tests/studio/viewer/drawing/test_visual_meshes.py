"""Visual shapes as they are drawn: their extent, meshes of files, and what can't be read."""

from __future__ import annotations

import logging
import os
import struct
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from trimesh import Trimesh
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

import symofros as sf
from reference_models import MODELS
from symofros.description.visual import Visual
from symofros.studio.viewer.drawing import visual_meshes
from symofros.studio.viewer.drawing.layers import initial_layers
from symofros.studio.viewer.drawing.poses import Mechanism
from symofros.studio.viewer.drawing.visual_meshes import MOST_COLORS, FilesBeside, few_colors, visual_mesh
from tests.late import late
from tests.studio.viewer.drawing.test_meshes import volume

creation = late("trimesh.creation", "view")

CORNERS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def stl(file: Path) -> None:
    rows = (struct.pack("<12fH", 0, 0, 0, *CORNERS[face].ravel(), 0) for face in FACES)
    file.write_bytes(bytes(80) + struct.pack("<I", len(FACES)) + b"".join(rows))


def obj(file: Path) -> None:
    lines = ["mtllib /etc/passwd", *(f"v {x} {y} {z}" for x, y, z in CORNERS)]
    file.write_text("\n".join([*lines, *(f"f {a + 1} {b + 1} {c + 1}" for a, b, c in FACES)]))


def off(file: Path) -> None:
    corners = "\n".join(f"{x} {y} {z}" for x, y, z in CORNERS)
    file.write_text(f"OFF\n4 4 0\n{corners}\n" + "\n".join(f"3 {a} {b} {c}" for a, b, c in FACES))


@pytest.mark.parametrize(
    ("visual", "extent", "least"),
    [
        (Visual("box", (1.0, 2.0, 3.0)), (1, 2, 3), 6.0),
        (Visual("sphere", (0.5,)), (1, 1, 1), 0.8 * np.pi / 6),
        (Visual("ellipsoid", (0.5, 1.0, 1.5)), (1, 2, 3), 0.8 * np.pi),
        (Visual("cylinder", (0.5, 3.0)), (1, 1, 3), 0.9 * 0.75 * np.pi),
        (Visual("capsule", (0.5, 2.0)), (1, 1, 3), 0.8 * (0.5 + 1 / 6) * np.pi),
    ],
)
def test_primitives_have_their_extent(visual: Visual, extent: tuple[float, ...], least: float) -> None:
    mesh = visual_mesh(visual)
    assert mesh is not None
    assert np.ptp(mesh.vertices, axis=0) == pytest.approx(extent) and np.abs(mesh.vertices.mean(axis=0)).max() < 1e-9
    assert least * 0.999 < volume(mesh) <= np.prod(extent) * 1.001


@pytest.mark.parametrize("write", [stl, obj, off])
@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (2.0, -1.0, 1.0)])
def test_meshes_are_read(write: Callable[[Path], None], scale: tuple[float, ...], tmp_path: Path) -> None:
    file = tmp_path / f"m.{write.__name__}"
    write(file)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh = visual_mesh(Visual("mesh", scale, file=str(file)))
    assert mesh is not None and len(mesh.faces) == 4
    assert volume(mesh) == pytest.approx(abs(np.prod(scale)))  # Seen from outside also where it is mirrored.
    assert np.ptp(mesh.vertices, axis=0) == pytest.approx(np.abs(scale) * [1, 2, 3])


def test_a_file_that_was_changed_is_read_again(tmp_path: Path) -> None:
    file = tmp_path / "m.stl"
    stl(file)
    one = visual_mesh(Visual("mesh", (1.0, 1.0, 1.0), file=str(file)))
    file.write_bytes(b"")
    with pytest.warns(UserWarning, match="'m.stl' is not drawn"):
        assert one is not None and visual_mesh(Visual("mesh", (1.0, 1.0, 1.0), file=str(file))) is None


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("m.fbx", b"x", ".fbx is none of"),
        ("m.stl", b"", "not a .stl file|0 triangles"),
        ("m.stl", bytes(80) + b"\xff\xff\xff\x7f", "not a .stl file|0 triangles"),
        ("m.obj", b"v 0 0 0\nv 1 0 0\nf 1 2 9\n", "not a .obj file|0 triangles|without a corner"),
        ("m.obj", b"v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n", "finite corners"),
        ("m.dae", b"<COLLADA><library_geometries><geometry/></library_geometries></COLLADA>", "no triangles"),
        ("m.ply", b"ply\nformat ascii 1.0\nelement vertex 99999999\nend_header\n", "not a .ply file|0 triangles"),
    ],
)
def test_unreadable_meshes_are_reported_and_left_out(name: str, content: bytes, expected: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.warns(UserWarning, match=expected):
        assert visual_mesh(Visual("mesh", (1.0, 1.0, 1.0), file=str(tmp_path / name))) is None


def test_too_large_ones_are_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stl(tmp_path / "m.stl")
    monkeypatch.setattr(visual_meshes, "MAX_BYTES", 100)
    with pytest.warns(UserWarning, match="more than 100 bytes"):
        assert visual_mesh(Visual("mesh", (1.0, 1.0, 1.0), file=str(tmp_path / "m.stl"))) is None


def test_one_of_too_many_triangles_is_drawn_coarser_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "ball.stl"
    ball = creation.icosphere(subdivisions=5)
    file.write_bytes(ball.export(file_type="stl"))
    monkeypatch.setattr(visual_meshes, "MAX_FACES", 5000)
    for _ in range(2):  # Also where it has been read before.
        with pytest.warns(UserWarning, match=r"'ball.stl' is drawn coarser: 20480 triangles by \d+, .* [1-5]\.\d%"):
            mesh = visual_mesh(Visual("mesh", (1.0, 1.0, 1.0), file=str(file)))
    assert mesh is not None and 1000 < len(mesh.faces) <= 5000
    assert volume(mesh) == pytest.approx(4 / 3 * np.pi, rel=0.02)


def test_bodies_look_as_their_file_says() -> None:
    rotation = sf.Rotation.rpy(0.0, 0.0, np.pi / 2)
    box = Visual("box", (0.2, 0.1, 0.1), (0.0, 0.0, 0.5), rotation, (1, 2, 3))
    system = replace(MODELS["double_pendulum"], visuals={"lower": (box,)})
    drawing = Mechanism(system).drawing()
    (part,) = (part for part in drawing.parts if part.kind == "visuals")
    assert part.link == 1 and part.color == (1, 2, 3)
    low, high = part.mesh.vertices.min(axis=0), part.mesh.vertices.max(axis=0)
    assert np.allclose([low, high], [[-0.05, -0.1, 0.45], [0.05, 0.1, 0.55]])
    # Boxes of inertia would hide in them.
    assert "inertias" not in initial_layers(drawing) and "visuals" in initial_layers(drawing)
    assert "inertias" in initial_layers(Mechanism(MODELS["double_pendulum"]).drawing())
    # The skeleton stays until every link has a look of its own.
    assert "bodies" in initial_layers(drawing)
    whole = Mechanism(replace(system, visuals={"upper": (box,), "lower": (box,)})).drawing()
    assert not {"bodies", "joints"} & initial_layers(whole)


def test_a_damaged_collada_file_leaves_its_body_without_a_look_and_all_else_drawn(tmp_path: Path) -> None:
    xyz = '<param name="X"/><param name="Y"/><param name="Z"/>'
    text = f"""<COLLADA><library_geometries><geometry id="g"><mesh>
        <source id="p"><float_array>0 0 0 1 0 0 0 1 0</float_array>
        <technique_common><accessor stride="3">{xyz}</accessor></technique_common></source>
        <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
        <triangles><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
        </mesh></geometry></library_geometries></COLLADA>"""
    (tmp_path / "sound.dae").write_text(text)
    (tmp_path / "damaged.dae").write_text(text.replace('stride="3"', 'stride="0"'))
    sound, damaged = (
        Visual("mesh", (1.0, 1.0, 1.0), file=str(tmp_path / name)) for name in ("sound.dae", "damaged.dae")
    )
    system = replace(MODELS["double_pendulum"], visuals={"upper": (sound,), "lower": (damaged,)})
    with pytest.warns(UserWarning, match="'damaged.dae' is not drawn"):
        picture = sf.record(system, ([0.0, 1.0], np.zeros((2, 2))), tmp_path / "picture.png", size=(64, 48))
    assert Path(picture).stat().st_size > 0
    with pytest.warns(UserWarning):
        shown = [part.name for part in Mechanism(system).drawing().parts if part.kind == "visuals"]
    assert shown == ["visuals/upper.0"]


@pytest.mark.parametrize("place", ["pipe", "device", "loop", "folder"])
def test_pipes_and_devices_are_not_read_as_meshes(place: str, tmp_path: Path) -> None:
    """A pipe would be read until somebody writes, a device without end."""
    file = tmp_path / "m.stl"
    if place == "pipe":
        os.mkfifo(file)
    elif place == "folder":
        file.mkdir()
    else:
        file.symlink_to("/dev/zero" if place == "device" else file.name)
    with pytest.warns(UserWarning, match="'m.stl' is not drawn"):
        assert visual_mesh(Visual("mesh", (1.0, 1.0, 1.0), file=str(file))) is None


def test_an_invalid_mesh_is_reported_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """No traceback of the library's own readers beside the warning, where nobody handles what they log."""
    monkeypatch.setattr(logging.getLogger(), "handlers", [])
    (tmp_path / "m.stl").write_bytes(b"solid\nfacet normal 0 0 x\nendsolid")
    with pytest.warns(UserWarning, match="'m.stl' is not drawn"):
        visual_mesh(Visual("mesh", (1.0, 1.0, 1.0), file=str(tmp_path / "m.stl")))
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("size", [1e300, 1e10])
def test_meshes_that_overflow_when_scaled_are_refused_by_one_warning(tmp_path: Path, size: float) -> None:
    file = tmp_path / "huge.obj"
    lines = [f"v {x * 1e300} {y * 1e300} {z * 1e300}" for x, y, z in CORNERS]
    file.write_text("\n".join([*lines, *(f"f {a + 1} {b + 1} {c + 1}" for a, b, c in FACES)]))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        assert visual_mesh(Visual("mesh", (size,) * 3, file=str(file))) is None
    (warning,) = caught
    assert "is not drawn" in str(warning.message)


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
    monkeypatch.setattr(visual_meshes, "MAX_PIXELS", 15)
    assert RED not in colors_of(written(tmp_path))


def test_files_that_a_mesh_refers_to_are_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.mtl").write_text("x" * 60)
    monkeypatch.setattr(visual_meshes, "MAX_BYTES", 100)
    beside = FilesBeside(tmp_path)
    assert len(beside["a.mtl"]) == 60
    with pytest.raises(OSError, match="too large"):
        beside["a.mtl"]
    monkeypatch.setattr(visual_meshes, "MAX_FILES", 0)
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
        Image.new("1", (visual_meshes.MAX_PIXELS // 1000, 1001)).save(file)
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
    monkeypatch.setattr(visual_meshes, "MAX_PIXELS", 15)
    (tmp_path / "other.glb").write_bytes((tmp_path / "part.glb").read_bytes())
    assert set(colors_of(tmp_path / "other.glb")) == {tuple(factor[:3]) if factor else (102, 102, 102)}


@pytest.mark.parametrize("form", ["glb", "gltf", "embedded"])
def test_gltf_is_turned_from_y_up_to_z_up(form: str, tmp_path: Path) -> None:
    """In one file, in text beside its buffer, in text that holds its buffer."""
    surface = Trimesh(CORNERS, FACES, process=False)
    file = tmp_path / ("part.glb" if form == "glb" else "part.gltf")
    if form == "glb":
        surface.export(file)
    else:
        files = surface.scene().export(file_type="gltf", embed_buffers=form == "embedded")
        assert len(files) == {"gltf": 3, "embedded": 1}[form]
        for name, data in files.items():
            (tmp_path / name.replace("model.gltf", file.name)).write_bytes(data)
    mesh = visual_mesh(Visual("mesh", (1.0, 1.0, 1.0), file=str(file)))
    assert mesh is not None
    assert mesh.vertices.tolist() == [[x, -z, y] for x, y, z in CORNERS.tolist()]
    assert volume(mesh) == pytest.approx(1.0)


@pytest.mark.parametrize(
    "visual", [Visual("box", (1.0, 2.0, 3.0)), Visual("sphere", (0.5,)), Visual("capsule", (0.5, 2.0))]
)
def test_a_checker_has_its_colors_by_octants_and_changes_no_shape(visual: Visual) -> None:
    """MuJoCo draws the first color where x y z > 0, on each side of a cube (its renderer, asked once)."""
    plain, mesh = visual_mesh(visual), visual_mesh(replace(visual, color=RED, checker=BLUE))
    assert plain is not None and mesh is not None and mesh.colors is not None
    middles = mesh.vertices[mesh.faces].mean(axis=1)
    assert (mesh.colors == np.where(middles.prod(axis=1, keepdims=True) > 0.0, RED, BLUE)).all()
    assert volume(mesh) == pytest.approx(volume(plain), rel=1e-9)


def test_a_mesh_without_a_volume_keeps_its_checker(tmp_path: Path) -> None:
    file = tmp_path / "sheet.obj"
    file.write_text("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\n")
    mesh = visual_mesh(Visual("mesh", (1.0, 1.0, 1.0), color=RED, checker=BLUE, file=str(file)))
    assert mesh is not None and mesh.colors is not None and np.isfinite(mesh.vertices).all()
    assert {tuple(color) for color in mesh.colors.tolist()} <= {RED, BLUE}
