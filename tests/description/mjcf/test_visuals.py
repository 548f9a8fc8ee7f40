"""How bodies of MJCF files look: meshes lie where MuJoCo draws them, in the colours that it gives them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import symofros as sf
from symofros.base.arrays import Array
from symofros.description.visual import Visual
from symofros.studio.viewer.drawing.visual_meshes import visual_mesh

CORNERS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
FILE = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS) + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
TURNED = 'pos="0.1 0.2 0.3" quat="0.5 0.5 0.1 0.7"'
INERTIAL = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
# The body states its inertia, so that the mesh is drawn alone; or it takes its inertia from the mesh.
INERTIAS = {"drawn alone": INERTIAL, "gives inertia": ""}


def written(folder: Path, mesh: str = "", geom: str = TURNED, inertial: str = INERTIAL, more: str = "") -> Path:
    (folder / "meshes").mkdir()
    (folder / "meshes" / "part.obj").write_text(FILE)
    file = folder / "model.xml"
    file.write_text(
        f"""<mujoco><compiler meshdir="meshes"/>{more}<asset><material name="sky" rgba="0 0.5 1 1"/>
<mesh name="part" file="part.obj" {mesh}/></asset><worldbody><body name="a" pos="1 2 3"><joint axis="1 2 3"/>{inertial}
<frame pos="0.4 0 0" euler="20 30 40"><geom type="mesh" mesh="part" {geom}/></frame></body></worldbody></mujoco>"""
    )
    return file


def seen_by_us(shape: Visual) -> Array:
    """Corners of the file in the frame of the body (4, 3)."""
    R = np.array([float(str(entry)) for entry in shape.rotation]).reshape(3, 3)
    return np.array((CORNERS * shape.size) @ R.T + shape.position)


def seen_by_mujoco(model: Any) -> Array:
    """Corners of its only mesh in the frame of the body, in any order."""
    R = np.zeros(9)
    mujoco.mju_quat2Mat(R, model.geom_quat[0])
    return np.array(model.mesh_vert @ R.reshape(3, 3).T + model.geom_pos[0])


@pytest.mark.parametrize("inertial", INERTIAS.values(), ids=INERTIAS)
@pytest.mark.parametrize(
    ("mesh", "more"),
    [
        ("", ""),
        ('scale="0.5 2 1"', ""),
        ('scale="0.5 2 1" refpos="0.3 0.2 0.1"', ""),
        ('scale="2 2 2" refpos="0.3 0.2 0.1" refquat="0.8 0.1 -0.5 0.3"', ""),
        ("", '<default><mesh scale="0.5 2 1"/></default>'),
        (
            'class="big" refpos="0.3 0.2 0.1"',
            '<default><mesh scale="0.5 2 1"/><default class="big"><mesh scale="3 3 3"/></default></default>',
        ),
    ],
)
def test_meshes_lie_where_mujoco_draws_them(mesh: str, more: str, inertial: str, tmp_path: Path) -> None:
    file = written(tmp_path, mesh, inertial=inertial, more=more)
    (shape,) = sf.load(file).visuals["a"]
    assert shape.kind == "mesh" and shape.file == str((tmp_path / "meshes" / "part.obj").resolve())
    ours, theirs = seen_by_us(shape), seen_by_mujoco(mujoco.MjModel.from_xml_path(str(file)))
    apart = np.abs(ours[:, None] - theirs[None]).max(axis=-1)
    assert apart.min(axis=1).max() < 1e-6 and apart.min(axis=0).max() < 1e-6  # Their corners are floats.


def test_meshes_that_are_drawn_change_no_mechanics(tmp_path: Path) -> None:
    file = written(tmp_path)
    without = file.with_name("without.xml")
    without.write_text(file.read_text().replace(f'<geom type="mesh" mesh="part" {TURNED}/>', ""))
    assert sf.load(file).bodies == sf.load(without).bodies


@pytest.mark.parametrize(
    ("geom", "more", "color"),
    [
        ("", "", None),
        ('rgba="1 0 0 1"', "", (255, 0, 0)),
        ('material="sky"', "", (0, 128, 255)),
        ('material="sky" rgba="1 0 0 1"', "", (255, 0, 0)),
        ('class="look"', '<default><default class="look"><geom material="sky"/></default></default>', (0, 128, 255)),
    ],
)
@pytest.mark.parametrize("inertial", INERTIAS.values(), ids=INERTIAS)
def test_colours_are_those_of_shapes_or_materials(
    geom: str, more: str, color: object, inertial: str, tmp_path: Path
) -> None:
    (shape,) = sf.load(written(tmp_path, geom=geom, more=more, inertial=inertial)).visuals["a"]
    assert shape.color == color


@pytest.mark.parametrize(
    ("texture", "color", "picture", "is_mapped"),
    [
        ('name="skin" builtin="flat" rgb1="0 1 0"', (0, 128, 0), "", False),
        ('name="skin" builtin="checker" type="2d" rgb1="1 1 1" rgb2="0 0 1"', (0, 64, 255), "", False),
        ('name="skin" builtin="gradient" rgb1="0 0 0" rgb2="0 1 1"', (0, 64, 128), "", False),
        ('file="skin.png" type="2d"', (0, 128, 255), "skin.png", True),
        ('name="skin" file="skin.png"', (0, 128, 255), "skin.png", False),  # A cube's.
        ('name="skin" file="../../skin.png" type="2d"', (0, 128, 255), "", False),
        ('name="skin" file="gone.png" type="2d"', (0, 128, 255), "", False),
        ('name="skin" builtin="flat" rgb1="0 1 nan"', (0, 128, 255), "", False),
    ],
)
@pytest.mark.parametrize("form", ['<material name="sky" rgba="0 0.5 1 1" texture="skin"/>', "layer", "class"])
def test_textures_are_those_of_materials(
    form: str, texture: str, color: tuple[int, ...], picture: str, is_mapped: bool, tmp_path: Path
) -> None:
    (tmp_path / "inside" / "textures").mkdir(parents=True)
    file = written(tmp_path / "inside", geom='material="sky"')
    for folder in (tmp_path, file.parent / "textures"):
        (folder / "skin.png").write_bytes(b"")
    plain, defaults = '<material name="sky" rgba="0 0.5 1 1"/>', ""
    if form == "layer":
        form = plain.replace("/>", '><layer role="rgb" texture="skin"/></material>')
    elif form == "class":
        form, defaults = plain, '<default><material texture="skin"/></default>'
    text = file.read_text().replace(plain, f"<texture {texture}/>{form}").replace("<asset>", f"{defaults}<asset>")
    file.write_text(text.replace("<compiler ", '<compiler texturedir="textures" '))
    (shape,) = sf.load(file).visuals["a"]
    assert shape.color == color
    assert shape.picture == (str((file.parent / "textures" / picture).resolve()) if picture else "")
    assert not picture or shape.is_mapped is is_mapped


@pytest.mark.parametrize(
    "change",
    [
        ('mesh="part" ', 'mesh="part" group="3" '),
        ('file="part.obj"', 'file="gone.obj"'),
        ('file="part.obj"', 'file="part.obj" scale="1 2 3" refquat="0.8 0.1 -0.5 0.3"'),
        ('geom type="mesh"', 'geom type="capsule"'),
    ],
    ids=["group", "missing", "turned and stretched", "a capsule about a mesh"],
)
def test_shapes_that_can_not_be_drawn_are_left_out(change: tuple[str, str], tmp_path: Path) -> None:
    file = written(tmp_path)
    file.write_text(file.read_text().replace(*change))
    system = sf.load(file)
    assert not system.visuals and system.bodies


def test_folders_of_files_are_left_out_if_asked_for(tmp_path: Path) -> None:
    file = written(tmp_path)
    file.write_text(
        file.read_text().replace("<compiler ", '<compiler strippath="true" ').replace("part.", "gone/part.")
    )
    (shape,) = sf.load(file).visuals["a"]
    assert shape.file == str((tmp_path / "meshes" / "part.obj").resolve())


def test_no_file_of_other_folders_is_drawn(tmp_path: Path) -> None:
    (tmp_path / "inside").mkdir()
    (tmp_path / "secret.obj").write_text(FILE)
    file = written(tmp_path / "inside")
    for stated in ("../../secret.obj", str(tmp_path / "secret.obj")):
        file.write_text(file.read_text().replace("part.obj", stated))
        assert not sf.load(file).visuals


def test_copies_are_drawn_each(tmp_path: Path) -> None:
    file = written(tmp_path)
    shape = f'<geom type="mesh" mesh="part" {TURNED}/>'
    file.write_text(
        file.read_text().replace(shape, f'<replicate count="3" offset="1 0 0" euler="0 0 30">{shape}</replicate>')
    )
    assert len({one.position for one in sf.load(file).visuals["a"]}) == 3


@pytest.mark.parametrize(("kind", "checker"), [("cube", (0, 0, 255)), ("2d", None)])
def test_a_cubes_checker_keeps_its_two_colors(kind: str, checker: object, tmp_path: Path) -> None:
    file = written(tmp_path, geom='material="skin"')
    ball = '<geom type="sphere" size="1" material="skin"/></body>'
    made = f'<texture name="t" builtin="checker" type="{kind}" rgb1="1 0 0" rgb2="0 0 1" width="8" height="8"/>'
    text = (
        file.read_text()
        .replace("</body>", ball)
        .replace("<asset>", f'<asset>{made}<material name="skin" texture="t"/>')
    )
    file.write_text(text)
    mesh, sphere = sf.load(file).visuals["a"]
    for shape in (mesh, sphere):
        assert shape.checker == checker and shape.color == ((255, 0, 0) if checker else (128, 0, 128))


@pytest.mark.parametrize("inertial", INERTIAS.values(), ids=INERTIAS)
@pytest.mark.parametrize("mesh", ["", 'scale="0.5 -2 1" refpos="0.3 0.2 0.1"'])
def test_a_meshs_checker_lies_along_its_axes_in_mujoco(mesh: str, inertial: str, tmp_path: Path) -> None:
    """MuJoCo lays a cube's checker on the axes of a mesh's own frame (mesh_pos, mesh_quat in the frame of the file)."""
    made = '<texture name="t" builtin="checker" type="cube" rgb1="1 0 0" rgb2="0 0 1" width="8" height="8"/>'
    more = f'<asset>{made}<material name="skin" texture="t"/></asset>'
    file = written(tmp_path, mesh, f'material="skin" {TURNED}', inertial, more)
    (shape,) = sf.load(file).visuals["a"]
    drawn, model = visual_mesh(shape), mujoco.MjModel.from_xml_path(str(file))
    assert drawn is not None and drawn.colors is not None
    R_BM, R_BF = np.zeros(9), np.array([float(str(entry)) for entry in shape.rotation]).reshape(3, 3)
    mujoco.mju_quat2Mat(R_BM, model.geom_quat[0])
    middles_B = drawn.vertices[drawn.faces].mean(axis=1) @ R_BF.T + shape.position
    middles = (middles_B - model.geom_pos[0]) @ R_BM.reshape(3, 3)
    assert (drawn.colors == np.where(middles.prod(axis=1, keepdims=True) > 0.0, (255, 0, 0), (0, 0, 255))).all()
